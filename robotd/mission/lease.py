"""Permission to move that runs out by itself."""

import asyncio
from collections.abc import Callable


class Lease:
    """Calls ``expired`` unless it is renewed in time; a client that dies takes its robot's motion with it."""

    def __init__(self, lasts_s: float, expired: Callable[[], None]) -> None:
        self._lasts_s = lasts_s
        self._expired = expired
        self._timer = asyncio.get_running_loop().call_later(lasts_s, expired)

    def renew(self) -> None:
        """Start the time anew."""
        self._timer.cancel()
        self._timer = asyncio.get_running_loop().call_later(self._lasts_s, self._expired)

    def end(self) -> None:
        """Give it back."""
        self._timer.cancel()


class EndlessLease(Lease):
    """Does not run out by itself: a recording says when it did."""

    def __init__(self, lasts_s: float, expired: Callable[[], None]) -> None:
        """Take no time."""

    def renew(self) -> None:
        """Do nothing: there is no time to start anew."""

    def end(self) -> None:
        """Do nothing: there is nothing to give back."""
