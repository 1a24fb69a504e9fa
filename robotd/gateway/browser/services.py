"""What a browser's connection reaches: the feed, the commands, who drives, and the notes of who did what."""

import contextlib
from collections.abc import Iterator
from typing import Protocol

from robotd.contract.events import MissionProgress
from robotd.core.clock import NS_PER_S, now_ns, wall_offset_ns
from robotd.core.errors import RobotdError
from robotd.gateway.access.audit import Audit
from robotd.gateway.browser import console_protocol as protocol
from robotd.gateway.browser.asked_by_page import PageCommands
from robotd.gateway.command.arbiter import Arbiter, Driver
from robotd.gateway.command.asker import Asks
from robotd.gateway.command.idle import Idle
from robotd.gateway.command.kept_missions import Missions
from robotd.gateway.command.stop_line import StopLine
from robotd.gateway.feed.fan_out import FanOut
from robotd.gateway.feed.heard_frames import HeardFrame
from robotd.gateway.settings import WatchingSettings


class Page(Protocol):
    """What the others need of a connection."""

    driver: Driver

    def say(self, text: str) -> None:
        """Let a text wait to be sent."""

    def silent_s(self) -> float:
        """Return for how long the page has answered nothing."""


class Services:
    """What all browsers share: who asks the daemon, who stops, who drives, what is known."""

    def __init__(self, fan: FanOut, asker: Asks, stop_line: StopLine, watching: WatchingSettings) -> None:
        self.fan, self.asker, self.stop_line = fan, asker, stop_line
        self.audit = Audit()
        self.arbiter = Arbiter()
        self.allows_unattended = watching.unattended
        self.idle = Idle(watching.disarm_after_s)
        self.commands = PageCommands(asker, self.idle, stop_line.stop)
        self.missions = Missions(
            asker,
            stop_line,
            self.arbiter,
            silent_s=self._silent_s,
            patience_s=watching.patience_s,
            changed=self.tell_commander,
        )
        self._pages: dict[str, Page] = {}
        fan.join(self)

    def enter(self, page: Page) -> None:
        """Let a page be told who drives, and be asked whether it lives."""
        self._pages[page.driver.browser] = page
        page.say(self._commander())

    def leave(self, page: Page) -> None:
        """Note that a page is gone."""
        self._pages.pop(page.driver.browser, None)
        self.missions.gone(page.driver.browser)

    @property
    def pages(self) -> tuple[Page, ...]:
        """The pages that are connected now."""
        return tuple(self._pages.values())

    async def stop(self, who: str, whence: str) -> float:
        """Stop the robot for somebody, and return how long that took [s].

        Raises:
            ServerError: the daemon did not confirm it.
        """
        with self.noted(who, whence, "stop"):
            return await self.stop_line.stop(f"STOP by {who}")

    @contextlib.contextmanager
    def noted(self, who: str, whence: str, what: str) -> Iterator[None]:
        """Note what somebody does, and what came of it."""
        result = "done"
        try:
            yield
        except RobotdError as error:
            result = str(error)
            raise
        except BaseException:
            result = "outcome unknown: who asked has left"
            raise
        finally:
            self.audit.note(now_ns() + wall_offset_ns(), who, whence, what, result)

    def tell_commander(self) -> None:
        """Tell every page who drives."""
        text = self._commander()
        for page in self.pages:
            page.say(text)

    def hear(self, heard: HeardFrame) -> None:
        """Take from what the daemon says when a mission is over."""
        mission = self.fan.snapshot.mission
        if heard.event == "mission_progress" and isinstance(mission, MissionProgress) and mission.is_last:
            self.missions.ended(mission.mission_id)

    def lost(self, topic: str, count: int) -> None:
        """Miss what the renewals of the lease tell as well."""

    def _commander(self) -> str:
        wish = self.arbiter.wish
        return protocol.commander(
            commander=self.arbiter.commander,
            wish=None if wish is None else wish.driver,
            wish_left_s=None if wish is None else max(0.0, wish.until_s - now_ns() / NS_PER_S),
        )

    def _silent_s(self, browser: str) -> float:
        page = self._pages.get(browser)
        return float("inf") if page is None else page.silent_s()
