"""What the daemon does when its loop stood still: stop what is driven, tell the mission, let it go on."""

import asyncio
import logging
from typing import NoReturn

from robotd.app.compose import Daemon
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.log import log_place
from robotd.mission.safety.hold import WELL_S, Stall

_LOOK_EVERY_S = 0.1
"""Often enough for a hold of a second; what it finds is noted, so a replay does not depend on it."""

log = logging.getLogger(__name__)


class Stalls:
    """Between the guard, which knows of stalls, and the mission, which knows what to do about them."""

    def __init__(self, daemon: Daemon) -> None:
        self._daemon = daemon
        self._log = log_place()

    def must_stop(self) -> bool:
        """Return whether the base is driven, from any thread.

        What merely sweeps or computes goes on: nothing of it can hurt anybody.
        """
        return self._daemon.robot.drive.is_driven

    def stalled(self, stood_still_s: float, was_stopped: bool, stuck_in: str) -> None:
        """Tell the mission, and the log."""
        done = "the base was stopped" if was_stopped else "nothing was stopped, for the base was not driven"
        where = " < ".join(line.strip() for line in stuck_in.splitlines() if line.strip())
        log.error("the event loop stood still for %.2f s: %s; it was in %s", stood_still_s, done, where)
        self._daemon.causes.stalled(Stall(now_ns(), stood_still_s, was_stopped, self._log))


async def keep_going(daemon: Daemon, silence_s: float) -> NoReturn:
    """Let a held mission go on as soon as all has been well for a while; a replay has it from its recording.

    Args:
        daemon: whose missions.
        silence_s: a base whose odometry is older is not well.
    """
    holding = daemon.supervisor.holding
    hold = holding.hold
    while True:
        # Asked and not awaited as an event: what ends a hold is that nothing happened, and nothing tells of
        # that.
        await asyncio.sleep(_LOOK_EVERY_S)
        if hold.cause is None or hold.is_ending:
            continue
        if holding.base_silent_s() > silence_s:
            hold.unwell_ns = now_ns()
        if holding.has_waited_enough():
            daemon.causes.give_up()
        elif now_ns() - hold.unwell_ns >= WELL_S * NS_PER_S:
            daemon.causes.go_on()
