"""The head pointed, and a sweep without a map, on a whole robot: they move the head alone, and they replay."""

import math
import statistics
from pathlib import Path

import pytest

from robotd.contract.events import MissionPhase, MissionProgress, RangeMeasured, SweepDone
from robotd.contract.missions import Look, Measure, Scan
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm, RecordStart, RecordStop, Stop
from robotd.core.pose import Odometry
from robotd.core.reading import ReadingStatus
from robotd.hardware.devices.drive import Drive
from robotd.mission.missions import stop_and_sweep
from robotd.mission.motion.legs import rotate_to
from robotd.mission.motion.steering import DrivingSettings
from robotd.mission.safety.hold import Hold
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from tests.integration.conftest import Live
from tests.support.living import LEASE_S
from tests.support.replayed import check, replayed
from tests.support.true_range import true_range_m


async def test_the_head_looks_where_asked_and_a_scan_needs_no_map(live: Live, tmp_path: Path) -> None:
    robot = SimulatedRobot(load_world("office"), seed=5)
    async with live(robot, armed=False) as it:
        await it.daemon.control.perform(RecordStart(str(tmp_path / "recordings" / "head.mcap")))
        await it.daemon.control.perform(Arm())
        before = robot.truth
        _, looked = await it.do(Look(0.5, -0.1))
        assert looked.phase is MissionPhase.DONE
        words = looked.message.replace(",", "").split()
        said_deg = float(words[3]), float(words[6])
        assert said_deg == pytest.approx((math.degrees(0.5), math.degrees(-0.1)), abs=0.1)
        assert robot._head.true_angles_rad == pytest.approx((0.5, -0.1), abs=0.01)
        (sweep,) = [event.sweep for event in await it.done(Scan()) if isinstance(event, SweepDone)]
        assert robot.truth.distance_m(before) < 0.01
        assert len(sweep.readings) == 300
        assert sum(reading.status is ReadingStatus.OK for reading in sweep.readings) > 150
        assert it.daemon.supervisor.whereabouts.map_in_use is None
        _, end = await it.do(Look(0.0, 6.0))
        assert end.phase is MissionPhase.FAILED
        assert "the head cannot look there: tilt must be" in end.message
        assert it.daemon.supervisor.mode is Mode.IDLE
        await it.daemon.control.perform(RecordStop())
    check(replayed(tmp_path / "recordings" / "head.mcap"))


async def test_ranges_are_measured_where_the_head_points_and_nothing_moves(live: Live, tmp_path: Path) -> None:
    file = tmp_path / "recordings" / "measure.mcap"
    robot = SimulatedRobot(load_world("office"), seed=5)
    async with live(robot, armed=False) as it:
        await it.daemon.control.perform(RecordStart(str(file)))
        await it.daemon.control.perform(Arm())
        await it.done(Look(0.7, 0.0))
        before, aim = robot.truth, robot._head.true_angles_rad
        said = await it.done(Measure(20))
        assert (robot.truth, robot._head.true_angles_rad, robot._laser._on) == (before, aim, False)
        await it.daemon.control.perform(RecordStop())
    shots = [event for event in said if isinstance(event, RangeMeasured)]
    assert [shot.number for shot in shots] == list(range(20))
    there = true_range_m(robot)
    good = [shot.range_m for shot in shots if shot.status is ReadingStatus.OK and shot.range_m is not None]
    assert statistics.median(good) == pytest.approx(there, abs=0.02)
    check(replayed(file))


async def test_a_scan_by_the_head_alone_leaves_the_base_where_it_stands(live: Live) -> None:
    robot = SimulatedRobot(load_world("office"), seed=5)
    async with live(robot) as it:
        before = robot.truth
        (sweep,) = [event.sweep for event in await it.done(Scan(base_turns=False)) if isinstance(event, SweepDone)]
        assert robot.truth == before
    assert 200 < len(sweep.readings) < 300


@pytest.mark.parametrize("mission", [Look(2.0, 0.0), Scan(), Measure(1000)])
async def test_a_stop_ends_it(live: Live, mission: Look | Scan | Measure) -> None:
    async with live(SimulatedRobot(load_world("office"), seed=5)) as it:
        mission_id = it.daemon.control.start(mission, LEASE_S)
        await it.daemon.control.perform(Stop("enough"))
        async for event in it.events:
            if isinstance(event, MissionProgress) and event.mission_id == mission_id and event.is_last:
                assert event.phase is MissionPhase.STOPPED
                break
        assert it.daemon.supervisor.mode is Mode.DISARMED


@pytest.mark.parametrize(("inexact", "readings"), [(1, 300), (100, None)])
async def test_a_base_that_turns_too_far_between_parts_of_a_sweep_turns_again(
    live: Live, monkeypatch: pytest.MonkeyPatch, inexact: int, readings: int | None
) -> None:
    turns: list[float] = []

    async def too_far(drive: Drive, heading_rad: float, settings: DrivingSettings, hold: Hold | None) -> Odometry:
        turns.append(heading_rad)
        # More than the head makes up for: it would be asked to pan beyond its limits, and its board would refuse.
        off_rad = 0.06 if len(turns) <= inexact else 0.0
        return await rotate_to(drive, heading_rad + off_rad, settings, hold)

    monkeypatch.setattr(stop_and_sweep, "rotate_to", too_far)
    async with live(SimulatedRobot(load_world("office"), seed=5)) as it:
        said, end = await it.do(Scan())
        sweeps = [event.sweep for event in said if isinstance(event, SweepDone)]
    assert [len(sweep.readings) for sweep in sweeps] == ([] if readings is None else [readings])
    assert (len(turns), end.phase) == ((2, MissionPhase.DONE) if readings else (5, MissionPhase.FAILED))
    assert readings or "the base stands 2.9 degrees off" in end.message
