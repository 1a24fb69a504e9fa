"""Who drives: the session that started the mission, until it ends or somebody takes over. Pure.

Others watch and may stop. Who wants to take over asks; given, or unanswered for ``ASKED_S``, the mission is theirs
without a stop, and their page is the one that has to answer from then on.
"""

from collections.abc import Callable

import msgspec

from robotd.core.errors import ServerError

ASKED_S = 5.0


class Driver(msgspec.Struct, frozen=True):
    """A browser that drives, or wants to."""

    browser: str
    """One connection of one page."""
    who: str
    """Name of its token."""


class ConsoleCommander(msgspec.Struct, frozen=True):
    """Who drives what."""

    driver: Driver
    mission_id: int
    kind: str
    attended: bool
    """Whether the mission ends when the driver's page is silent."""
    since_ns: int


class Wish(msgspec.Struct, frozen=True):
    """Somebody asks to take over."""

    driver: Driver
    until_s: float


class Arbiter:
    """At most one commander, and at most one who wants to be."""

    def __init__(self) -> None:
        self.commander: ConsoleCommander | None = None
        self.wish: Wish | None = None
        self._starting: Driver | None = None
        self._stopping: int | None = None

    def start(self, driver: Driver) -> None:
        """Let somebody ask the daemon for a mission.

        Raises:
            ServerError: another one drives, or is about to.
        """
        other = self._starting or (None if self.commander is None else self.commander.driver)
        if other is not None:
            raise ServerError("refused", f"{other.who} drives already: wait, stop it, or take over")
        self._starting = driver

    def began(self, mission_id: int, kind: str, now_ns: int, *, attended: bool) -> None:
        """Note that the daemon began what was asked."""
        if self._starting is None:
            raise RuntimeError("nobody asked for a mission")
        self.commander = ConsoleCommander(self._starting, mission_id, kind, attended, now_ns)
        self._starting = None

    def refused(self) -> None:
        """Note that it did not."""
        self._starting = None

    def ended(self, mission_id: int) -> None:
        """Note that a mission is over."""
        # By its number: the word of an older mission may come late, and must not take the next one from its
        # driver.
        if self.commander is not None and self.commander.mission_id == mission_id:
            self.commander = self.wish = self._stopping = None

    def ask_for(self, driver: Driver, now_s: float) -> None:
        """Ask to take over.

        Raises:
            ServerError: there is nothing to take over, or somebody else asks already.
        """
        if self.commander is None:
            raise ServerError("refused", "nobody of this console drives: there is nothing to take over")
        if self.commander.driver.browser == driver.browser:
            raise ServerError("refused", "you drive already")
        if self.wish is not None and self.wish.driver.browser != driver.browser:
            raise ServerError("refused", f"{self.wish.driver.who} asks to take over already")
        # Asked twice is asked once: pressing again must not put off when it passes.
        self.wish = self.wish or Wish(driver, now_s + ASKED_S)

    def give(self, browser: str, *, give: bool) -> None:
        """Let the commander give the mission to who asks, or keep it.

        Raises:
            ServerError: this is not the commander, or nobody asks.
        """
        if self.commander is None or self.wish is None or self.commander.driver.browser != browser:
            raise ServerError("refused", "nobody asks you to hand over")
        if give:
            self._pass_on(self.wish)
        self.wish = None

    def tick(self, now_s: float) -> bool:
        """Let the mission pass to who asked, if nobody answered in time; return whether it did."""
        if self.wish is None or now_s < self.wish.until_s:
            return False
        self._pass_on(self.wish)
        self.wish = None
        return True

    def gone(self, browser: str) -> str | None:
        """Note that a browser is gone; return why the robot has to be stopped for that, or None."""
        if self.wish is not None and self.wish.driver.browser == browser:
            self.wish = None
        commander = self.commander
        if commander is None or commander.driver.browser != browser:
            return None
        if self.wish is not None:  # somebody is there who wants it, and a stop would not be what anybody wants
            self._pass_on(self.wish)
            self.wish = None
            return None
        return self._stop(f"{commander.driver.who}, who drove, has left the console") if commander.attended else None

    def to_stop(self, silent_s: Callable[[str], float], patience_s: float) -> str | None:
        """Return why the robot has to be stopped now, once for each mission; None if it need not.

        Args:
            silent_s: tells for how long the page of a browser has answered nothing.
            patience_s: how long that may be.
        """
        commander = self.commander
        if commander is None or not commander.attended:
            return None
        silence_s = silent_s(commander.driver.browser)
        if silence_s <= patience_s:
            return None
        return self._stop(f"the page of {commander.driver.who}, who drove, has not answered for {silence_s:.1f} s")

    @property
    def is_stopping(self) -> bool:
        """Whether the mission under way is being stopped: then its lease need not be kept."""
        return self.commander is not None and self._stopping == self.commander.mission_id

    def _stop(self, reason: str) -> str | None:
        if self.commander is None or self.is_stopping:
            return None
        # Once for each mission: a page that is silent is silent at the next look, too.
        self._stopping = self.commander.mission_id
        return reason

    def _pass_on(self, wish: Wish) -> None:
        if self.commander is not None:
            self.commander = msgspec.structs.replace(self.commander, driver=wish.driver)
