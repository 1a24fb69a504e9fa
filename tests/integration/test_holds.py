"""A stall of ours holds a mission that drives, leaves one that stands alone, and ends none: on the virtual clock."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from firmware_proto.common import Fault
from robotd.app.stalls import keep_going
from robotd.config import Config
from robotd.contract.events import MissionPhase, MissionProgress
from robotd.contract.missions import DriveStraight, DriveTo, Legs, MapStart, Mission, Turn
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm, RecordStart, RecordStop, Stop
from robotd.core.angles import wrap_rad
from robotd.core.clock import now_ns
from robotd.core.errors import RobotdError
from robotd.core.pose import Odometry
from robotd.hardware.devices.drive import Drive
from robotd.mission.missions import by_odometry
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.mission.motion import legs
from robotd.mission.motion.legs import translate_to
from robotd.mission.motion.steering import DrivingSettings
from robotd.mission.safety.hold import HOLDS_A_MINUTE, Stall
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from tests.integration.conftest import Live
from tests.support.living import LEASE_S, AtOnce, Living
from tests.support.replayed import replayed

pytestmark = pytest.mark.slow

STALL_S = 0.4
QUICK = replace(Config(), sweep=SweepSettings(readings=24))


@asynccontextmanager
async def going(live: Live, directory: Path) -> AsyncIterator[Living]:
    """Yield a robot that lets held missions go on, and check that its recording replays."""
    file = directory / "recordings" / "held.mcap"
    async with live(SimulatedRobot(load_world("office"), seed=4), QUICK, armed=False) as it:
        await it.daemon.control.perform(RecordStart(str(file)))
        await it.daemon.control.perform(Arm())
        task = asyncio.create_task(keep_going(it.daemon, DrivingSettings().silence_s))
        try:
            yield it
        finally:
            task.cancel()
            await asyncio.wait({task})
        await it.daemon.control.perform(RecordStop())
    report = replayed(file)
    assert report.differences == ()
    assert report.digest == report.recorded_digest
    assert report.results > 0


def stall(it: Living) -> bool:
    """Do what the guard does, in its thread and afterwards on the loop; return whether the base was stopped."""
    was_stopped = it.daemon.robot.drive.is_driven
    if was_stopped:
        it.daemon.robot.stop_past_loop(0)
    it.daemon.causes.stalled(Stall(now_ns(), STALL_S, was_stopped, "robotd.log"))
    return was_stopped


def begin(it: Living) -> int:
    robot = it.robot
    x_m, y_m = robot.stops_m[0]
    return it.daemon.control.start(MapStart.of("office", ((x_m, y_m),), robot.start, Legs.STRAIGHT), LEASE_S)


async def until(it: Living, happens: Callable[[], bool], within_s: float = 120.0) -> None:
    with it.daemon.robot.drive.odometry.subscribe() as odometry:
        async with asyncio.timeout(within_s):
            while not happens():
                await odometry.get()


async def ended(it: Living, mission_id: int) -> MissionProgress:
    async for event in it.events:
        if isinstance(event, MissionProgress) and event.mission_id == mission_id and event.is_last:
            return event
    raise AssertionError("a subscription never ends")


def twist(it: Living) -> tuple[float, float]:
    latest = it.daemon.robot.drive.odometry.latest
    return (0.0, 0.0) if latest is None else (abs(latest.twist.speed_mps), abs(latest.twist.turn_radps))


MOMENTS: dict[str, Callable[[Living], bool]] = {
    "sweeping": lambda it: it.daemon.supervisor.status.mode == "mapping" and twist(it) == (0.0, 0.0),
    "turning": lambda it: twist(it)[1] > 0.3,
    "driving": lambda it: twist(it)[0] > 0.2,
}


@pytest.mark.parametrize("moment", MOMENTS)
@pytest.mark.parametrize("times", [1, 2])
async def test_a_mission_goes_on_after_a_stall(live: Live, tmp_path: Path, moment: str, times: int) -> None:
    async with going(live, tmp_path) as it:
        mission_id = begin(it)
        await until(it, lambda: MOMENTS[moment](it))
        for _ in range(times):
            is_held = stall(it) or it.daemon.control.status.held is not None
            status = it.daemon.control.status
            assert is_held == (moment != "sweeping")
            assert (status.held is not None) == is_held
            assert status.mode == "mapping"
            if is_held:
                assert "the loop stood still 0.4 s; log: robotd.log" in str(status.held)
            await asyncio.sleep(0.7)
            assert (it.daemon.control.status.held is not None) == is_held
            assert not is_held or not it.daemon.robot.drive.is_driven
        end = await ended(it, mission_id)
        assert end.phase is MissionPhase.DONE, end
        assert it.daemon.control.status.held is None


@pytest.mark.parametrize(("moment", "mission"), [("driving", DriveStraight(1.0)), ("turning", Turn(9.0))])
async def test_without_a_map_only_the_rest_of_the_way_is_gone_after_a_stall(
    live: Live, tmp_path: Path, moment: str, mission: Mission
) -> None:
    async with going(live, tmp_path) as it:
        before = it.robot.truth
        mission_id = it.daemon.control.start(mission, LEASE_S)
        await until(it, lambda: MOMENTS[moment](it))
        assert stall(it)
        assert it.daemon.control.status.held is not None
        end = await ended(it, mission_id)
        assert end.phase is MissionPhase.DONE, end
        moved = before.inverse() @ it.robot.truth
        asked = (1.0, 0.0, 0.0) if moment == "driving" else (0.0, 0.0, wrap_rad(9.0))
        assert (moved.x_m, moved.y_m, moved.heading_rad) == pytest.approx(asked, abs=0.03)


async def test_the_seventh_hold_within_a_minute_disarms_and_says_why(live: Live, tmp_path: Path) -> None:
    async with going(live, tmp_path) as it:
        mission_id = begin(it)
        for _ in range(HOLDS_A_MINUTE + 1):
            await until(it, lambda: it.daemon.robot.drive.is_driven)
            stall(it)
            await asyncio.sleep(1.3)
        end = await ended(it, mission_id)
        assert end.phase is MissionPhase.STOPPED
        assert it.daemon.supervisor.mode is Mode.DISARMED
        for words in ("too busy", "robotd.log", "7th time within a minute", "continue with: robotctl arm"):
            assert words in end.message


async def held(it: Living) -> int:
    mission_id = begin(it)
    await until(it, lambda: it.daemon.robot.drive.is_driven)
    assert stall(it)
    await asyncio.sleep(0.3)
    return mission_id


async def test_a_stop_while_held_is_the_end(live: Live, tmp_path: Path) -> None:
    async with going(live, tmp_path) as it:
        mission_id = await held(it)
        await it.daemon.control.perform(Stop("enough"))
        await asyncio.sleep(5.0)
        assert it.daemon.control.status.held is None
        assert (it.daemon.supervisor.mode, twist(it)) == (Mode.DISARMED, (0.0, 0.0))
        assert (await ended(it, mission_id)).message == "enough"


async def test_a_stop_while_devices_are_armed_again_is_the_end(live: Live, tmp_path: Path) -> None:
    async with going(live, tmp_path) as it:
        mission_id = await held(it)
        it.daemon.causes.go_on()
        await asyncio.sleep(0)
        assert it.daemon.supervisor.holding.hold.is_ending
        await it.daemon.control.perform(Stop("enough"))
        await asyncio.sleep(5.0)
        assert (it.daemon.supervisor.mode, twist(it)) == (Mode.DISARMED, (0.0, 0.0))
        assert (await ended(it, mission_id)).message == "enough"


async def test_a_lease_that_ends_while_held_is_the_end(live: Live, tmp_path: Path) -> None:
    async with going(live, tmp_path) as it:
        mission_id = await held(it)
        it.daemon.supervisor.mission.lease_expired(mission_id)
        await asyncio.sleep(5.0)
        assert (it.daemon.supervisor.mode, twist(it)) == (Mode.DISARMED, (0.0, 0.0))
        message = (await ended(it, mission_id)).message
        assert "fell silent" in message
        assert "shortly before, this machine was too busy" in message


async def test_a_fault_while_held_is_a_fault(live: Live, tmp_path: Path) -> None:
    async with going(live, tmp_path) as it:
        await held(it)
        it.robot.boards["drive"]._latch(Fault.BUMPER)  # type: ignore[attr-defined]  # as a bumper would
        await asyncio.sleep(5.0)
        assert it.daemon.supervisor.mode is Mode.FAULT
        with pytest.raises(RobotdError):
            await it.daemon.control.perform(Arm())


def _bumper() -> object:
    from firmware_proto.common import Fault

    return Fault.BUMPER


@pytest.mark.parametrize("stood_still", [True, False])
async def test_a_deadman_is_a_hold_if_we_stood_still_and_a_fault_if_not(
    live: Live, tmp_path: Path, stood_still: bool
) -> None:
    from firmware_proto.common import Fault

    async with going(live, tmp_path) as it:
        mission_id = begin(it)
        await until(it, lambda: twist(it)[1] > 0.3)
        if stood_still:
            it.daemon.causes.stalled(Stall(now_ns(), STALL_S, False, "robotd.log"))  # the guard came late, too
        it.robot.boards["drive"]._latch(Fault.DEADMAN)  # type: ignore[attr-defined]  # as in hardware
        await asyncio.sleep(0.2)
        status = it.daemon.control.status
        if not stood_still:
            assert (status.mode, status.held) == (Mode.FAULT, None)
            return
        assert status.mode == "mapping"
        assert status.held is not None
        assert (await ended(it, mission_id)).phase is MissionPhase.DONE


@pytest.mark.parametrize("mission", [DriveStraight(0.5), DriveTo(1.0, 1.0, Legs.STRAIGHT)])
async def test_a_deadman_in_the_last_moment_of_a_way_is_a_hold_and_not_a_fault_afterwards(
    live: Live, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mission: DriveStraight | DriveTo
) -> None:
    async def too_late(drive: Drive, *arguments: Any, **more: Any) -> Odometry:
        here = await translate_to(drive, *arguments, **more)
        # Told of with the odometry that ends the way, as what came late comes all at once.
        it.daemon.causes.stalled(Stall(now_ns(), STALL_S, False, "robotd.log"))
        it.robot.boards["drive"]._latch(Fault.DEADMAN)  # type: ignore[attr-defined]  # as in hardware
        return here

    async with going(live, tmp_path) as it:
        start = it.robot.start
        await it.done(MapStart.of("office", (), start, Legs.STRAIGHT))
        with monkeypatch.context() as patched:
            patched.setattr(by_odometry, "translate_to", too_late)
            patched.setattr(legs, "translate_to", too_late)
            mission_id = it.daemon.control.start(mission, LEASE_S)
            assert (await ended(it, mission_id)).phase is MissionPhase.DONE
        await asyncio.sleep(1.0)
        status = it.daemon.control.status
        assert (status.mode, status.held, twist(it)) == (Mode.IDLE, None, (0.0, 0.0))
        assert all(not device.faults and device.armed for device in status.devices)


async def test_a_stall_while_nothing_is_under_way_ends_nothing(live: Live, tmp_path: Path) -> None:
    async with going(live, tmp_path) as it:
        assert not stall(it)
        await asyncio.sleep(0.2)
        assert it.daemon.control.status.mode == "idle"
        await it.daemon.control.perform(Stop("enough"))
        assert not stall(it)
        await asyncio.sleep(3.0)
        assert it.daemon.control.status.mode == "disarmed"
        await it.daemon.control.perform(Arm())
        assert (await it.do(MapStart.of("office", (), it.robot.start)))[1].phase is MissionPhase.DONE


async def test_a_drive_goes_on_from_where_the_robot_is(live: Live, tmp_path: Path) -> None:
    async with going(live, tmp_path) as it:
        start, (x_m, y_m) = it.robot.start, it.robot.stops_m[0]
        await it.done(MapStart.of("office", ((x_m, y_m),), start, Legs.STRAIGHT))
        mission_id = it.daemon.control.start(DriveTo(start.x_m, start.y_m, Legs.STRAIGHT), LEASE_S)
        await until(it, lambda: twist(it)[0] > 0.2)
        stall(it)
        end = await ended(it, mission_id)
        assert end.phase is MissionPhase.DONE, end
        assert it.robot.truth.distance_m(start) < 0.2


async def phase(it: Living, wanted: MissionPhase, stop: int) -> None:
    async for event in it.events:
        if isinstance(event, MissionProgress) and (event.phase, event.stop) == (wanted, stop):
            return


async def test_a_stall_while_the_base_settles_ends_nothing(live: Live, tmp_path: Path) -> None:
    async with going(live, tmp_path) as it:
        mission_id = begin(it)
        await phase(it, MissionPhase.SWEEPING, 1)
        await asyncio.sleep(0.1)  # of the two tenths for which it must stand
        assert not stall(it)
        assert it.daemon.control.status.held is None
        assert (await ended(it, mission_id)).phase is MissionPhase.DONE


async def test_a_stall_while_something_is_computed_ends_nothing(
    live: Live, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    computing = list[str]()

    async def takes_long(self: AtOnce, name: str, function: Callable[..., object], *args: object) -> object:
        computing.append(name)
        await asyncio.sleep(0.5)
        computing.pop()
        return function(*args)

    monkeypatch.setattr(AtOnce, "run", takes_long)
    async with going(live, tmp_path) as it:
        mission_id = begin(it)
        await phase(it, MissionPhase.COMPUTING, 0)
        await asyncio.sleep(0.1)
        assert computing == ["place stop"]
        assert not stall(it)
        assert it.daemon.control.status.held is None
        assert (await ended(it, mission_id)).phase is MissionPhase.DONE


async def test_a_stall_while_the_robot_is_armed_ends_nothing(live: Live, tmp_path: Path) -> None:
    async with going(live, tmp_path) as it:
        await it.daemon.control.perform(Stop("to arm again"))
        await asyncio.sleep(0.5)
        arming = asyncio.create_task(it.daemon.control.perform(Arm()))
        await asyncio.sleep(0)
        assert not arming.done()
        assert not stall(it)
        await arming
        await asyncio.sleep(0.5)
        assert it.daemon.supervisor.mode is Mode.IDLE


async def test_a_stall_while_devices_are_armed_again_is_borne(live: Live, tmp_path: Path) -> None:
    async with going(live, tmp_path) as it:
        mission_id = await held(it)
        it.daemon.causes.go_on()
        await asyncio.sleep(0)
        assert it.daemon.supervisor.holding.hold.is_ending
        assert not stall(it)
        assert (await ended(it, mission_id)).phase is MissionPhase.DONE
