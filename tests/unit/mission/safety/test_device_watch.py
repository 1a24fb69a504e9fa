"""What a device says of itself decides whether the robot goes on: each combination, against rules in plain words."""

import asyncio
import itertools
from types import SimpleNamespace
from typing import Any, cast

import pytest

from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.contract.modes import Mode
from robotd.core.broadcast import Broadcast
from robotd.hardware.devices.credible import IMPLAUSIBLE
from robotd.hardware.devices.drive import DriveReadout
from robotd.mission.safety.device_watch import DeviceWatch
from robotd.mission.safety.mode_table import Occasion

READY, ABSENT, CONNECTING = LinkState.READY, LinkState.ABSENT, LinkState.CONNECTING


class Stage:
    """A watch and all that it may tell, noted in order."""

    def __init__(self, mode: Mode, *, is_explained: bool = False, armed: tuple[str, ...] = ("drive", "head")) -> None:
        self.mode = mode
        self.said: list[Any] = []
        self.halts = 0
        self.drive = SimpleNamespace(
            name="drive", readouts=Broadcast(), status=DeviceStatus("drive", READY, armed=True)
        )
        self.robot = cast("Any", SimpleNamespace(drive=self.drive))
        holding = SimpleNamespace(explains=lambda _: is_explained, blamed=lambda reason: f"{reason} (blamed)")
        arming = SimpleNamespace(armed=tuple(SimpleNamespace(name=name) for name in armed))
        self.watch = DeviceWatch(
            self, cast("Any", holding), cast("Any", arming), lambda: self.said.append("doubt"), 22.0
        )

    def halt(self, occasion: Occasion, reason: str) -> None:
        self.said.append((occasion, reason))

    def publish_status(self) -> None:
        self.said.append("status")


def expected(status: DeviceStatus, mode: Mode, *, is_explained: bool, is_left_out: bool) -> list[Any]:
    """Return what must be told, rule by rule."""
    lied = "implausible" in status.faults
    doubts = ["doubt"] if status.name == "drive" and (status.link is ABSENT or lied) else []
    if is_explained and not is_left_out:
        return [*doubts, "status"]
    if status.faults and mode is not Mode.FAULT:
        said = f"{status.name}: {', '.join(status.faults)}" + (f": {status.detail}" if lied else "")
        return [*doubts, (Occasion.FAULT, f"{said} (blamed)")]
    if mode is Mode.DISARMED or mode is Mode.FAULT:
        return [*doubts, "status"]
    if status.link is not READY:
        gone = (Occasion.DEVICE_LOST, f"{status.name} is gone: {status.detail} (blamed)")
        return [*doubts, "status" if is_left_out else gone]
    if not status.armed:
        why = "there again: arm again" if is_left_out else "no longer armed"
        return [*doubts, (Occasion.STOP, f"{status.name} is {why}")]
    return [*doubts, "status"]


@pytest.mark.parametrize("mode", Mode)
@pytest.mark.parametrize("name", ["drive", "head"])
def test_every_change_of_a_device_is_answered_by_the_first_rule_that_fits(name: str, mode: Mode) -> None:
    every = itertools.product(LinkState, (False, True), ((), ("bumper",), (IMPLAUSIBLE,)), (False, True), (False, True))
    for link, is_armed, faults, is_explained, is_left_out in every:
        status = DeviceStatus(name, link, armed=is_armed, faults=faults, detail="why")
        armed = tuple({"drive", "head"} - ({name} if is_left_out else set()))
        stage = Stage(mode, is_explained=is_explained, armed=armed)
        stage.watch.changed(status)
        assert stage.said == expected(status, mode, is_explained=is_explained, is_left_out=is_left_out), status


def test_the_mode_is_asked_after_a_stall_was_looked_for_since_that_may_end_the_mission() -> None:
    stage = Stage(Mode.UNDER_WAY, armed=("head",))

    def ends_it(_: DeviceStatus) -> bool:
        stage.mode = Mode.DISARMED  # a hold too many
        return True

    cast("Any", stage.watch)._holding.explains = ends_it
    stage.watch.changed(DeviceStatus("drive", READY, armed=False))
    assert stage.said == ["status"]


async def test_a_low_battery_is_a_fault_once() -> None:
    stage = Stage(Mode.IDLE)
    watching = asyncio.create_task(stage.watch.watch_battery())
    await asyncio.sleep(0)
    for volts in (25.0, 21.9, 21.8):
        stage.drive.readouts.publish(DriveReadout(0, volts, ()))
        await asyncio.sleep(0.01)
        if stage.said:
            stage.mode = Mode.FAULT
    watching.cancel()
    await asyncio.gather(watching, return_exceptions=True)
    assert stage.said == [(Occasion.FAULT, "drive: the battery is at 21.9 V, below 22 V")]
