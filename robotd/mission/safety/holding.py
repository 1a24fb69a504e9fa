"""What the supervisor does about a stall of ours: nothing while the base stands, a hold while it is driven."""

import asyncio
import logging
from collections.abc import Awaitable, Callable
from typing import Protocol

from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.contract.events import Event, Status
from robotd.contract.modes import Mode
from robotd.core.attention import attention
from robotd.core.clock import now_ns
from robotd.core.errors import RobotdError
from robotd.core.silence import within
from robotd.hardware.devices.device import Device
from robotd.mission.modes import UNDER_WAY, Occasion
from robotd.mission.robot import Robot
from robotd.mission.safety.hold import HOLDS_A_MINUTE, Hold, Stall

_ARM_TIMEOUT_S = 5.0
_DEADMAN = ("deadman",)
_NEXT_STEP = "continue with: robotctl arm (after a fault robotctl clear first), then the mission again"

Devices = tuple[Device, ...]

log = logging.getLogger(__name__)


class Host(Protocol):
    """The supervisor, as far as a hold concerns it."""

    robot: Robot

    @property
    def mode(self) -> Mode:
        """What the robot is allowed to do now."""

    @property
    def status(self) -> Status:
        """The whole robot in one look."""

    def halt(self, occasion: Occasion, reason: str) -> None:
        """Stop first, then end the mission."""

    def publish(self, event: Event) -> None:
        """Tell everybody."""


class Holding:
    """Begins and ends holds; whatever else ends the mission ends them too."""

    def __init__(
        self, host: Host, hold: Hold, armed: Callable[[], Devices], arm: Callable[[Devices], Awaitable[None]]
    ) -> None:
        """Hold the missions of a host; ``armed`` tells what is armed for them, ``arm`` arms it again."""
        self._armed = armed
        self._arm = arm
        self.hold = hold
        self._host = host
        self._stall: Stall | None = None
        self._going_on: asyncio.Task[None] | None = None

    def stalled(self, stall: Stall) -> None:
        """Take note of a stall; if the base was stopped, hold the mission."""
        attention().miss(stall.stood_still_s)
        self._stall = stall
        self.hold.unwell_ns = stall.time_ns
        if not stall.was_stopped:
            return
        if self._host.mode in UNDER_WAY:
            self._begin(stall)
        else:
            self._host.halt(Occasion.STOP, f"{stall}; {_NEXT_STEP}")

    def explains(self, status: DeviceStatus) -> bool:
        """Say whether a device is disarmed because of us, which ends nothing.

        Either the mission is held, and it was stopped for that; or its deadman ran out while our loop stood still, and
        that holds the mission.
        """
        stall = self._recent()
        if (
            status.link is not LinkState.READY
            or self._host.mode not in UNDER_WAY
            or status.faults not in {(), _DEADMAN}
        ):
            return False
        if self.hold.cause is None and status.faults and stall is not None:
            log.warning("%s: its deadman ran out while the loop stood still", status.name)
            self._begin(stall)
            return True
        return self.hold.cause is not None

    def blamed(self, reason: str) -> str:
        """Return a reason, with a stall before it that may be the cause."""
        stall = self._recent()
        return reason if stall is None else f"{reason}; shortly before, {stall}; {_NEXT_STEP}"

    def go_on(self) -> None:
        """Arm the devices again and let the mission go on; whatever comes between ends it as always."""
        if self.hold.cause is not None and not self.hold.is_ending:
            self.hold.is_ending = True
            self._going_on = asyncio.create_task(self._go_on(), name="go on")

    def end(self) -> None:
        """End the hold because the mission ends."""
        self.hold.end()
        if self._going_on is not None and self._going_on is not asyncio.current_task():
            self._going_on.cancel()

    async def _go_on(self) -> None:
        devices = self._armed()
        try:
            async with within(_ARM_TIMEOUT_S):
                for device in devices:
                    if device.status.faults == _DEADMAN:
                        await device.clear_faults()
                await self._arm(devices)
        except (TimeoutError, RobotdError) as error:
            if self.hold.cause is not None:  # otherwise it was ended by a stop, which has said why
                self._host.halt(Occasion.STOP, f"cannot go on: {str(error) or 'arming took too long'}; {_NEXT_STEP}")
            return
        if self.hold.cause is not None:
            log.info("the mission goes on: the loop has been well for a while")
            self.hold.end()
            self._host.publish(self._host.status)

    def _begin(self, stall: Stall) -> None:
        if not self.hold.begin(f"{stall}; it goes on by itself", stall.time_ns):
            often = f"for the {HOLDS_A_MINUTE + 1}th time within a minute"
            self._host.halt(Occasion.STOP, f"{stall}, {often}; {_NEXT_STEP}")
            return
        log.warning("held: %s", stall)
        self._host.robot.stop_now()
        self._host.publish(self._host.status)

    def _recent(self) -> Stall | None:
        return self._stall if self._stall is not None and self._stall.is_recent(now_ns()) else None
