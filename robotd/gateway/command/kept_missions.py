"""Missions of browsers: started for them, kept alive for them, and stopped when their page falls silent.

The gateway holds the lease, so the robot stops by itself if the gateway hangs or dies.
"""

import asyncio
import logging
from collections.abc import Callable, Coroutine
from typing import Any

from robotd.contract.answers import MissionStarted
from robotd.contract.missions import MissionRequest
from robotd.contract.requests import Renew
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import RobotdError, ServerError
from robotd.gateway.command.arbiter import Arbiter, Driver
from robotd.gateway.command.asker import NOBODY, UNKNOWN, Asks
from robotd.gateway.command.stop_line import StopLine

RENEWALS_PER_LEASE = 4
_LOOK_S = 0.05

log = logging.getLogger(__name__)


class Missions:
    """The mission that a browser started, if there is one."""

    def __init__(
        self,
        asker: Asks,
        stop_line: StopLine,
        arbiter: Arbiter,
        *,
        silent_s: Callable[[str], float],
        patience_s: float,
        changed: Callable[[], None],
    ) -> None:
        """Keep missions alive.

        Args:
            asker: sends requests.
            stop_line: stops.
            arbiter: says who drives.
            silent_s: tells for how long the page of a browser has answered nothing.
            patience_s: how long that may be.
            changed: is told whenever another one drives, or nobody any more.
        """
        self._asker, self._stop_line, self._arbiter = asker, stop_line, arbiter
        self._silent_s, self._patience_s, self._changed = silent_s, patience_s, changed
        self._tasks: set[asyncio.Task[None]] = set()

    async def start(self, driver: Driver, mission: MissionRequest, *, attended: bool) -> MissionStarted:
        """Start a mission for a browser, and keep its lease.

        Raises:
            ServerError: another one drives, or the daemon refused, or it is not known what came of it.
        """
        self._arbiter.start(driver)
        try:
            started = await self._asker.ask(mission, who=f"{driver.who}, in the console")
        except BaseException as error:
            self._arbiter.refused()
            # It may be under way, and nobody would renew it: its lease ends it.
            if not isinstance(error, ServerError) or error.code not in {NOBODY, UNKNOWN}:
                raise
            raise ServerError(error.code, f"{error.message}; if it began, its lease ends it") from error
        self._arbiter.began(started.mission_id, mission.cmd, now_ns(), attended=attended)
        self._changed()
        self._own(self._keep(started))
        # The page may have gone while the daemon thought: nobody would tell again.
        self._look()
        return started

    def ended(self, mission_id: int) -> None:
        """Note what the daemon published: a mission is over."""
        commander = self._arbiter.commander
        if commander is not None and commander.mission_id == mission_id:
            self._arbiter.ended(mission_id)
            self._changed()

    def gone(self, browser: str) -> None:
        """Note that a browser is gone: a mission that somebody has to look at ends with who looked."""
        before = self._arbiter.commander
        self._stop_for(self._arbiter.gone(browser))
        if self._arbiter.commander is not before:
            self._changed()

    async def watch(self) -> None:
        """Stop the robot when the page of who drives is silent; hand it over when nobody answers: a duty."""
        try:
            while True:
                # Looked at twenty times a second, so that a page that falls silent costs the robot next to
                # nothing beyond its patience.
                await asyncio.sleep(_LOOK_S)
                self._look()
        finally:
            for task in self._tasks:
                task.cancel()
            await asyncio.gather(*self._tasks, return_exceptions=True)

    def _look(self) -> None:
        if self._arbiter.tick(now_ns() / NS_PER_S):
            self._changed()
        self._stop_for(self._arbiter.to_stop(self._silent_s, self._patience_s))

    def _stop_for(self, reason: str | None) -> None:
        if reason is not None:
            log.warning("the robot is stopped: %s", reason)
            self._own(self._stop(reason))

    async def _stop(self, reason: str) -> None:
        try:
            await self._stop_line.stop(reason)
        except RobotdError as error:  # the lease, which is not renewed, ends it
            log.warning("%s", error)

    async def _keep(self, started: MissionStarted) -> None:
        """Renew a lease until its mission is over; one answer that stays away is not waited for."""
        period_s = started.lease_s / RENEWALS_PER_LEASE
        while self._is_kept(started.mission_id):
            # From when it is asked, not from when it was answered: a slow answer must not stretch the time
            # between two renewals.
            next_s = now_ns() / NS_PER_S + period_s
            try:
                renewed = await self._asker.ask(Renew(started.mission_id), started.lease_s)
            except ServerError as error:
                if error.code not in {NOBODY, UNKNOWN}:
                    log.info("mission %d is over: %s", started.mission_id, error)
                    self.ended(started.mission_id)
            else:
                if renewed.mission is not None and renewed.mission.is_last:
                    self.ended(started.mission_id)
            await asyncio.sleep(max(0.0, next_s - now_ns() / NS_PER_S))

    def _is_kept(self, mission_id: int) -> bool:
        commander = self._arbiter.commander
        return commander is not None and commander.mission_id == mission_id and not self._arbiter.is_stopping

    def _own(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
