"""What the supervisor does when a mission is interrupted for a moment: a hold, if the base is concerned, else nothing.

Our own loop stood still while the base was driven; or odometry fell silent, though the line is not lost. Either keeps
set-points away, and the base's deadman may run out before anything else is noticed: that is no fault of the base.
"""

import asyncio
import logging
import math

from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.contract.modes import Mode
from robotd.core.attention import attention
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import LinkTimeout, RobotdError
from robotd.core.silence import within
from robotd.mission.safety.arming import Arming
from robotd.mission.safety.hold import HOLDS_A_MINUTE, LATELY_NS, FellSilent, Hold, Stall
from robotd.mission.safety.mode_table import Occasion
from robotd.mission.safety.stopper import Stopper

_ARM_TIMEOUT_S = 5.0
"""For all devices together, as for an arm that a client asks for."""
_WAITED_FOR_S = 10.0
"""So long a base that is on the line but tells no odometry is waited for."""
_DEADMAN = ("deadman",)
"""The one fault that a hold forgives: our set-points stayed away, so the base stopped as it should."""
_NEXT_STEP = "continue with: robotctl arm (after a fault robotctl clear first), then the mission again"

_TOO_OFTEN = f"for the {HOLDS_A_MINUTE + 1}th time within a minute"

log = logging.getLogger(__name__)


class Holding:
    """Begins and ends holds; whatever else ends the mission ends them too."""

    def __init__(self, stopper: Stopper, hold: Hold, arming: Arming) -> None:
        """Hold missions; ``arming`` knows what is armed for them, and arms it again."""
        self._arming = arming
        self.hold = hold
        self._stopper = stopper
        self._stall: Stall | None = None
        self._going_on: asyncio.Task[None] | None = None
        self._why_head_is_away: str | None = None
        # Handed down and not imported: the hold stands below, and is known to motion, which must not see the
        # supervisor.
        hold.wait_for_base = self._wait_for_base

    @property
    def cause(self) -> str | None:
        """Why the mission under way is held, or waits; None if it does neither."""
        return self.hold.cause or self._why_head_is_away

    def head_away(self, why: str | None) -> None:
        """Let the mission wait for the head, and say why; None if it does not wait any more.

        Nothing is stopped: a mission that asks for array work stands, and sweeps at most.
        """
        before = self._why_head_is_away
        self._why_head_is_away = None if why is None else f"the head is away ({why}); it goes on by itself"
        if self._why_head_is_away != before:
            log.warning("%s", self._why_head_is_away or "the head is back, and the mission goes on")
            self._stopper.publish_status()

    def stalled(self, stall: Stall) -> None:
        """Take note of a stall; if the base was stopped, hold the mission."""
        # Before anything else: timers that are due now were due because of us, and what waited unread is read
        # first.
        attention().miss(stall.stood_still_s)
        self._stall = stall
        self.hold.unwell_ns = stall.time_ns
        if not stall.was_stopped:
            return
        if self._stopper.mode is Mode.UNDER_WAY:
            self._hold_for(str(stall))
        else:
            self._stopper.halt(Occasion.STOP, f"{stall}; {_NEXT_STEP}")

    def explains(self, status: DeviceStatus) -> bool:
        """Say whether a device is disarmed because of us, which ends nothing.

        Either the mission is held, and it was stopped for that; or its deadman ran out because our set-points stayed
        away, and that holds the mission. Where they did not, it is a fault of the base or of its cable.
        """
        if (
            status.link is not LinkState.READY
            or self._stopper.mode is not Mode.UNDER_WAY
            # Any fault beside the deadman is one of the base's own, which no stall of ours explains.
            or status.faults not in {(), _DEADMAN}
        ):
            return False
        if self.hold.cause is None and status.faults and (why := self._why_unled()) is not None:
            log.warning("%s: its deadman ran out: %s", status.name, why)
            self._hold_for(why)
            return True
        return self.hold.cause is not None

    def blamed(self, reason: str) -> str:
        """Return a reason, with a stall before it that may be the cause."""
        stall = self._recent()
        return reason if stall is None else f"{reason}; shortly before, {stall}; {_NEXT_STEP}"

    def base_silent_s(self) -> float:
        """Return how old the newest odometry is, by its own time."""
        latest = self._stopper.robot.drive.odometry.latest
        return math.inf if latest is None else (now_ns() - latest.time_ns) / NS_PER_S

    def has_waited_enough(self) -> bool:
        """Whether the base has been silent for too long to be waited for, though its line is not lost."""
        # Both: a hold may last long for another reason, and silence from before the hold is not waiting.
        return min(self.hold.lasted_s(now_ns()), self.base_silent_s()) > _WAITED_FOR_S

    def give_up(self) -> None:
        """End a mission that waits for a base that does not come back."""
        if self.hold.cause is not None:
            self._stopper.halt(Occasion.STOP, f"drive: no odometry for {_WAITED_FOR_S:g} s; {_NEXT_STEP}")

    def go_on(self) -> None:
        """Arm the devices again and let the mission go on; whatever comes between ends it as always."""
        if self.hold.cause is not None and not self.hold.is_ending:
            # Arming takes a while: a second one beside it would race it for the same devices.
            self.hold.is_ending = True
            self._going_on = asyncio.create_task(self._go_on(), name="go on")

    def end(self) -> None:
        """End the hold because the mission ends."""
        self.hold.end()
        if self._going_on is not None and self._going_on is not asyncio.current_task():
            self._going_on.cancel()

    async def _go_on(self) -> None:
        devices = self._arming.armed
        try:
            async with within(_ARM_TIMEOUT_S, of="going on"):
                for device in devices:
                    # Cleared for it, because it was our silence that let the deadman run out; every other fault
                    # waits for people.
                    if device.status.faults == _DEADMAN:
                        await device.clear_faults()
                # Those that the client armed, and no other: a device that came back since was allowed nothing
                # yet.
                await self._arming.arm_these(devices)
        except (TimeoutError, RobotdError) as error:
            if self.hold.cause is not None:  # otherwise it was ended by a stop, which has said why
                self._stopper.halt(Occasion.STOP, f"cannot go on: {str(error) or 'arming took too long'}; {_NEXT_STEP}")
            return
        if self.hold.cause is not None:
            log.info("the mission goes on: all has been well for a while")
            self.hold.end()
            self._stopper.publish_status()

    def _wait_for_base(self, error: FellSilent) -> None:
        """Hold the mission until the base is heard again.

        Raises:
            LinkTimeout: it is not waited for: it is not there, was never heard, or fell silent too often.
        """
        robot = self._stopper.robot
        if self._stopper.mode is not Mode.UNDER_WAY or not robot.has_base or robot.drive.odometry.latest is None:
            raise error
        if not self._begin(str(error), now_ns()):
            raise LinkTimeout(f"{error}, {_TOO_OFTEN}; {_NEXT_STEP}") from error

    def _hold_for(self, cause: str) -> None:
        if not self._begin(cause, now_ns()):
            self._stopper.halt(Occasion.STOP, f"{cause}, {_TOO_OFTEN}; {_NEXT_STEP}")

    def _begin(self, cause: str, time_ns: int) -> bool:
        """Stop and hold; False if that was so too often, and the mission must end."""
        # Before the stop: that disarms the devices, and what they say of it must find its explanation (`explains`).
        if not self.hold.begin(f"{cause}; it goes on by itself", time_ns):
            return False
        log.warning("held: %s", cause)
        self._stopper.robot.stop_now()
        self._stopper.publish_status()
        return True

    def _why_unled(self) -> str | None:
        """Return why set-points stayed away just now; None if they did not."""
        stall, unled_ns = self._recent(), self.hold.unled_ns
        if stall is None and (unled_ns is None or now_ns() - unled_ns > LATELY_NS):
            return None
        return "the base was silent, and so without set-points" if stall is None else str(stall)

    def _recent(self) -> Stall | None:
        return self._stall if self._stall is not None and self._stall.is_recent(now_ns()) else None
