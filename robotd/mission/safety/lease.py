"""Permission to move that runs out by itself."""

from collections.abc import Callable

from robotd.core.silence import Silence


class Lease(Silence):
    """Calls ``expired`` unless it is renewed in time; a client that dies takes its robot's motion with it.

    What a client said while our loop stood still is read first.
    """


class EndlessLease(Lease):
    """Does not run out by itself: a recording says when it did."""

    def __init__(self, lasts_s: float, expired: Callable[[], None]) -> None:
        """Take no time."""

    def renew(self) -> None:
        """Do nothing: there is no time to start again."""

    def end(self) -> None:
        """Do nothing: there is nothing to give back."""
