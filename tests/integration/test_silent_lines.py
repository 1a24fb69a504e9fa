"""A line that is silent for a moment holds what drives and delays what stands; one that is lost ends the mission."""

import asyncio
import random
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from firmware_proto.common import BoardKind
from firmware_proto.drive_messages import OdometryReport, SetVelocity
from firmware_proto.framing import Deframer
from robotd.contract.events import MissionPhase, MissionProgress
from robotd.contract.missions import Legs, MapStart
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm, RecordStop, Stop
from robotd.core.clock import now_ns
from robotd.hardware.link.tap import Direction
from robotd.hardware.wire.board import BoardWire
from robotd.mission.safety.hold import HOLDS_A_MINUTE, Stall
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.faults.fault import Fault
from robotd.sim.faults.of_flow import SilentLine
from robotd.sim.faults.of_frames import frames_of
from robotd.sim.robot import DEVICES
from tests.support.bench import Bench, bench
from tests.support.replayed import replayed

pytestmark = pytest.mark.slow

STOPPED_S = 0.55
"""Odometry may be silent for half a second, and a report is due each 40 ms."""
DEADMAN_S = 0.4
"""Its set-points last so long, and none comes while no odometry does."""
LOST_S = 1.1
PATIENT_S = 10.0
READINGS = 12
"""A sweep that lasts longer than a silence."""


class NoOdometry(Fault):
    """The base says how it is, but not where."""

    def changed(self, data: bytes, way: Direction) -> bytes:
        frames = data if way is Direction.TO_BOARD else b"".join(f for f in frames_of(data) if not _is_odometry(f))
        return bytes(frames)


class NoSetPoints(Fault):
    """The base hears everything but how to move."""

    def changed(self, data: bytes, way: Direction) -> bytes:
        if way is Direction.FROM_BOARD:
            return data
        return bytes(b"".join(frame for frame in frames_of(data) if not _is_set_point(frame)))


def _is_odometry(frame: bytes) -> bool:
    return any(isinstance(one.message, OdometryReport) for one in BoardWire(BoardKind.DRIVE).feed(b"\0" + frame))


def _is_set_point(frame: bytes) -> bool:
    return any(raw.type == SetVelocity.TYPE for raw in Deframer().feed(b"\0" + frame))


@asynccontextmanager
async def mapping(directory: Path, silence_s: float = 1.0) -> AsyncIterator[Bench]:
    """Yield a robot that makes a map with two stops, and check that its recording replays."""
    async with bench(directory, Dialects(), readings=READINGS, silence_s=silence_s) as it:
        await it.daemon.control.perform(Arm())
        it.start(MapStart.of("laboratory", it.robot.stops_m[:1], it.robot.start, Legs.STRAIGHT))
        yield it
        await it.daemon.control.perform(RecordStop())  # what ends the daemon is in no replay
    (file,) = (directory / "recordings").glob("*.mcap")
    report = replayed(file)
    assert report.differences == ()
    assert report.digest == report.recorded_digest


def fall_silent(it: Bench, devices: tuple[str, ...] = DEVICES) -> None:
    for device in devices:
        it.cables[device].set_fault(SilentLine(random.Random(1)))


def mend(it: Bench) -> None:
    for cable in it.cables.values():
        cable.mend()


async def until(it: Bench, happens: Callable[[Bench], bool]) -> None:
    async with asyncio.timeout(120.0):
        with it.daemon.control.events.subscribe(depth=100_000) as events:
            while not happens(it):
                await events.get()


async def ended(it: Bench) -> MissionProgress:
    async with asyncio.timeout(300.0):
        async for event in it.events:
            if isinstance(event, MissionProgress) and event.is_last:
                return event
    raise AssertionError("a subscription never ends")


def twist(it: Bench) -> tuple[float, float]:
    latest = it.daemon.robot.drive.odometry.latest
    return (0.0, 0.0) if latest is None else (abs(latest.twist.speed_mps), abs(latest.twist.turn_radps))


def is_held(it: Bench) -> bool:
    return it.daemon.control.status.held is not None


async def rests_unarmed(it: Bench) -> None:
    """Check that nothing moves by itself once the lines are there again."""
    where = it.robot.truth
    await asyncio.sleep(10.0)
    assert it.robot.truth == where
    assert it.mode in {Mode.DISARMED, Mode.FAULT}  # its deadman is latched if it drove
    assert not any(device.status.armed for device in it.daemon.robot.devices)


MOMENTS: dict[str, Callable[[Bench], bool]] = {
    "sweeping": lambda it: it.robot._head.arrives_us is not None,
    "turning": lambda it: twist(it)[1] > 0.3,
    "driving": lambda it: twist(it)[0] > 0.2,
}


@pytest.mark.parametrize("moment", MOMENTS)
@pytest.mark.parametrize("lasts_s", [0.2, 0.45, 0.7, 0.85])
async def test_a_moment_without_a_word_ends_nothing(tmp_path: Path, moment: str, lasts_s: float) -> None:
    async with mapping(tmp_path) as it:
        await until(it, MOMENTS[moment])
        fall_silent(it)
        await asyncio.sleep(lasts_s)
        assert is_held(it) == (moment != "sweeping" and lasts_s > STOPPED_S)
        assert it.mode is Mode.UNDER_WAY
        assert not is_held(it) or not it.daemon.robot.drive.is_driven
        mend(it)
        await asyncio.sleep(0.1)
        assert is_held(it) == (moment != "sweeping" and lasts_s > DEADMAN_S)
        end = await ended(it)
        assert end.phase is MissionPhase.DONE, end


@pytest.mark.parametrize("moment", ["turning", "driving"])
async def test_a_deadman_that_runs_out_though_the_base_was_heard_is_a_fault(tmp_path: Path, moment: str) -> None:
    async with mapping(tmp_path) as it:
        await until(it, MOMENTS[moment])
        it.cables["drive"].set_fault(NoSetPoints(random.Random(1)))
        await asyncio.sleep(DEADMAN_S + 0.1)
        assert (it.mode, is_held(it)) == (Mode.FAULT, False)
        mend(it)
        await asyncio.sleep(1.0)
        assert "drive: deadman" in (await ended(it)).message
        await rests_unarmed(it)


@pytest.mark.parametrize("moment", MOMENTS)
async def test_a_silence_that_the_setting_allows_ends_nothing(tmp_path: Path, moment: str) -> None:
    async with mapping(tmp_path, PATIENT_S) as it:
        await until(it, MOMENTS[moment])
        fall_silent(it)
        await asyncio.sleep(STOPPED_S)
        assert is_held(it) == (moment != "sweeping")
        assert not it.daemon.robot.drive.is_driven
        await asyncio.sleep(3.0)
        assert it.robot.at_rest
        mend(it)
        end = await ended(it)
        assert end.phase is MissionPhase.DONE, end
        assert not is_held(it)


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("moment", MOMENTS)
async def test_a_line_that_stays_silent_is_lost_within_a_second_held_or_not(
    tmp_path: Path, moment: str, device: str
) -> None:
    async with mapping(tmp_path) as it:
        await until(it, MOMENTS[moment])
        fall_silent(it, (device,))
        await asyncio.sleep(LOST_S)
        assert (it.mode, is_held(it)) == (Mode.DISARMED, False)
        await asyncio.sleep(1.0)
        mend(it)
        end = await ended(it)
        assert end.phase in {MissionPhase.STOPPED, MissionPhase.FAILED}
        assert f"{device}: silent for 1 s" in end.message
        await rests_unarmed(it)


async def test_a_cable_pulled_while_held_ends_the_mission(tmp_path: Path) -> None:
    async with mapping(tmp_path) as it:
        await until(it, MOMENTS["driving"])
        fall_silent(it)
        await until(it, is_held)
        it.cables["rangefinder"].unplug()
        await asyncio.sleep(0.1)
        assert it.mode is Mode.DISARMED
        await asyncio.sleep(1.0)
        it.cables["rangefinder"].plug()
        mend(it)
        await rests_unarmed(it)


async def test_a_device_lost_while_held_ends_the_mission(tmp_path: Path) -> None:
    async with mapping(tmp_path, PATIENT_S) as it:
        await until(it, MOMENTS["driving"])
        fall_silent(it, ("drive",))
        await until(it, is_held)
        it.cables["drive"].unplug()
        await asyncio.sleep(0.1)
        assert (it.mode, is_held(it)) == (Mode.DISARMED, False)
        assert (await ended(it)).phase is MissionPhase.STOPPED


@pytest.mark.parametrize("device", DEVICES)
async def test_a_device_lost_while_held_for_a_stall_ends_the_mission(tmp_path: Path, device: str) -> None:
    async with mapping(tmp_path) as it:
        await until(it, MOMENTS["driving"])
        it.daemon.causes.stalled(Stall(now_ns(), 0.4, True, "robotd.log"))
        assert is_held(it)
        await asyncio.sleep(0.3)
        it.cables[device].unplug()
        await asyncio.sleep(0.1)
        assert (it.mode, is_held(it)) == (Mode.DISARMED, False)
        await asyncio.sleep(1.0)
        it.cables[device].plug()
        await rests_unarmed(it)
        assert f"{device} is gone" in (await ended(it)).message


async def test_a_stop_while_the_base_is_silent_is_the_end(tmp_path: Path) -> None:
    async with mapping(tmp_path, PATIENT_S) as it:
        await until(it, MOMENTS["driving"])
        fall_silent(it)
        await until(it, is_held)
        await it.daemon.control.perform(Stop("enough"))
        await asyncio.sleep(1.0)
        mend(it)
        assert (await ended(it)).message.startswith("enough")
        assert not is_held(it)
        await rests_unarmed(it)


async def test_a_base_that_reports_but_tells_no_odometry_is_given_up(tmp_path: Path) -> None:
    async with mapping(tmp_path) as it:
        await until(it, MOMENTS["sweeping"])  # a base that is driven would end by its deadman
        it.cables["drive"].set_fault(NoOdometry(random.Random(1)))
        await until(it, is_held)
        await asyncio.sleep(9.0)
        assert is_held(it)
        await asyncio.sleep(1.5)
        assert (it.mode, is_held(it)) == (Mode.DISARMED, False)
        message = (await ended(it)).message
        assert "no odometry for 10 s" in message
        assert "continue with: robotctl arm" in message


async def test_the_seventh_silence_within_a_minute_ends_the_mission_and_says_why(tmp_path: Path) -> None:
    async with mapping(tmp_path) as it:
        for _ in range(HOLDS_A_MINUTE + 1):
            await until(it, lambda it: it.daemon.robot.drive.is_driven or it.mode is Mode.DISARMED)
            fall_silent(it)
            await asyncio.sleep(0.7)
            mend(it)
        end = await ended(it)
        assert end.phase is MissionPhase.FAILED
        assert it.mode is Mode.DISARMED
        for words in ("no odometry for 0.5 s", "7th time within a minute", "continue with: robotctl arm"):
            assert words in end.message
