"""Whatever goes wrong in whatever moment, the robot comes to rest, stays so, and moves again only when armed again."""

import asyncio
from collections.abc import Awaitable, Callable
from importlib.util import find_spec
from pathlib import Path

import pytest

from firmware_proto.common import BoardState, Fault
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm, Clear
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import RobotdError
from robotd.hardware.wire.board import STOP_BYTES
from robotd.sim.emulators.catalogue import Firmware
from robotd.sim.robot import DEVICES
from tests.integration.wrongs import (
    ACTIVITIES,
    BY_HEAD,
    LEASE_S,
    MOVING,
    NOTICED_WITHIN_S,
    REST_WITHIN_S,
    SOON_S,
    WRONGS,
    Rig,
    arming,
    computing,
    daemon_is_killed,
    driving,
    measuring,
    preparing,
    rig,
    scanning,
    starting,
    sweeping,
)
from tests.support.living import until_ready
from tests.support.own_boards import board_of


async def check_rest(rig: Rig) -> None:
    """From here on nothing is armed and nothing moves, although time passes and lines come back."""
    assert rig.is_quiet
    assert BoardState.ARMED not in rig.states.values()
    where = rig.robot.truth
    await asyncio.sleep(5.0)
    assert rig.robot.truth == where
    assert rig.is_quiet
    assert BoardState.ARMED not in rig.states.values()


async def check_arming_works_again(rig: Rig) -> None:
    await until_ready(rig.daemon)
    await asyncio.sleep(SOON_S)
    if rig.mode is Mode.FAULT:
        with pytest.raises(RobotdError):
            await rig.daemon.control.perform(Arm())
        await rig.daemon.control.perform(Clear())
    assert rig.mode.value == "disarmed"
    assert not any(device.status.armed for device in rig.daemon.robot.devices)
    await rig.daemon.control.perform(Arm())
    await asyncio.sleep(SOON_S)
    assert rig.mode is Mode.IDLE
    assert set(rig.states.values()) == {BoardState.ARMED}


needs_c = pytest.mark.skipif(find_spec("robotd.sim.firmware._native") is None, reason="there was no C compiler")
CASES = [
    *((wrong, activity, Firmware.PYTHON) for wrong in WRONGS for activity in ACTIVITIES),
    *((wrong, activity, Firmware.PYTHON) for wrong in ("stop", "bumper", "drive unplugged") for activity in BY_HEAD),
    *(pytest.param(wrong, driving, Firmware.C, marks=needs_c) for wrong in WRONGS if wrong != "bumper"),
]


@pytest.mark.parametrize(("wrong", "activity", "boards"), CASES)
async def test_it_comes_to_rest(
    wrong: str, activity: Callable[[Rig], Awaitable[None]], boards: Firmware, tmp_path: Path
) -> None:
    happens, mode = WRONGS[wrong]
    async with rig(tmp_path, boards) as it:
        await activity(it)
        it.began_ns = now_ns()
        await happens(it)
        await asyncio.sleep(NOTICED_WITHIN_S)
        if activity is arming:
            assert it.asked[0].done()
        assert it.mode is mode
        await asyncio.sleep(REST_WITHIN_S)
        cut_off = {device for device in DEVICES if wrong in {f"{device} unplugged", f"{device} rebooted"}}
        assert all(it.stopped(device) for device in set(DEVICES) - cut_off)
        await check_rest(it)
        if wrong != "daemon ends":
            assert it.mode is mode
            await check_arming_works_again(it)
            return
    assert it.is_quiet


@pytest.mark.parametrize("activity", [*MOVING, scanning, measuring, sweeping, computing, preparing, starting])
async def test_a_silent_client_loses_its_robot_when_the_lease_ends(
    activity: Callable[[Rig], Awaitable[None]], tmp_path: Path
) -> None:
    async with rig(tmp_path) as it:
        await activity(it)
        it.began_ns = now_ns()
        await asyncio.sleep(LEASE_S + SOON_S)
        assert it.mode is Mode.DISARMED
        assert "lease" in it.daemon.control.status.reason
        stops = [entry.time_ns for entry in it.journal.remembered if getattr(entry, "data", b"") == STOP_BYTES]
        assert all(it.stopped(device) for device in DEVICES)
        assert min(at for at in stops if at >= it.began_ns) <= it.began_ns + (LEASE_S + 0.05) * NS_PER_S
        await asyncio.sleep(REST_WITHIN_S)
        await check_rest(it)
        await check_arming_works_again(it)


@pytest.mark.parametrize("boards", [Firmware.PYTHON, pytest.param(Firmware.C, marks=needs_c)])
@pytest.mark.parametrize("activity", ACTIVITIES)
async def test_a_killed_daemon_leaves_a_robot_that_stops_itself(
    activity: Callable[[Rig], Awaitable[None]], boards: Firmware, tmp_path: Path
) -> None:
    async with rig(tmp_path, boards) as it:
        await activity(it)
        await daemon_is_killed(it)
        await asyncio.sleep(REST_WITHIN_S)
        assert it.robot.at_rest
        if activity in MOVING:
            assert board_of(it.robot, "drive").faults == Fault.DEADMAN
