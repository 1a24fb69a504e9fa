"""The main job, end to end, in memory: map a room, be found in it, say so when that is not possible."""

import asyncio
import math
from dataclasses import replace
from statistics import median

import numpy as np
import pytest

from robotd.config import Config
from robotd.contract.device_status import LinkState
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import Event, MapChanged, MissionPhase, SweepDone, SweepProgress
from robotd.contract.missions import DriveTo, Localize, MapStart, PriorHeading
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm, MapLoad, MapSave
from robotd.core.angles import wrap_rad
from robotd.core.clock import NS_PER_S
from robotd.core.errors import MissionError
from robotd.core.reading import ReadingStatus
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.mission.whereabouts.map_in_use import MapInUse
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from tests.integration.conftest import Live
from tests.support.living import Living, until_ready
from tests.support.own_boards import own_board
from tests.support.places import cells_in_use

pytestmark = pytest.mark.slow

QUICK = Config(sweep=SweepSettings(readings=150))
"""Where it does not matter how well the map is seen; the first tests look as often as a user's robot does."""


def place(it: Living) -> MapInUse:
    assert it.daemon.supervisor.whereabouts.map_in_use is not None
    return it.daemon.supervisor.whereabouts.map_in_use


def final_estimates(said: list[Event]) -> list[PoseEstimate]:
    return [e for e in said if isinstance(e, PoseEstimate) and e.final and e.state is not PoseState.PREDICTED]


async def test_the_robot_maps_the_laboratory_and_is_found_in_it_within_50_mm(live: Live) -> None:
    robot = SimulatedRobot(load_world("laboratory"), seed=3)
    async with live(robot) as it:
        said = await it.done(MapStart.of("lab", robot.stops_m, robot.start))
        sweeps = [event.sweep for event in said if isinstance(event, SweepDone)]
        assert len(sweeps) == 1 + len(robot.stops_m)
        assert all(len(sweep.readings) == 300 for sweep in sweeps)
        errors_m = []
        for probe_m in robot.probes_m:
            _, end = await it.do(DriveTo(*probe_m))
            if end.phase is MissionPhase.FAILED:  # a stray reading may leave an obstacle where there is none
                continue
            found = final_estimates(await it.done(Localize()))[-1]
            assert found.state is PoseState.LOCALIZED
            assert found.best is not None
            errors_m.append(math.hypot(found.best.x_m - robot.truth.x_m, found.best.y_m - robot.truth.y_m))
        assert len(errors_m) >= 4
        assert median(errors_m) < 0.050
        assert max(errors_m) < 0.150


async def test_every_reading_of_a_sweep_has_its_own_bearing_time_and_status(live: Live) -> None:
    robot = SimulatedRobot(load_world("office"), seed=1)
    async with live(robot) as it:
        said = await it.done(MapStart.of("office", (), robot.start))
    (sweep,) = [event.sweep for event in said if isinstance(event, SweepDone)]
    bearings = np.sort([reading.bearing_rad % (2 * math.pi) for reading in sweep.readings])
    gaps = np.diff([*bearings, bearings[0] + 2 * math.pi])
    assert np.degrees(gaps).min() > 1.2 * 0.8
    assert np.degrees(gaps).max() < 1.2 * 1.2
    times = [reading.time_ns for reading in sweep.readings]
    assert times == sorted(times)
    assert len(set(times)) == 300
    assert {ReadingStatus.OK} <= {reading.status for reading in sweep.readings}
    progress = [event for event in said if isinstance(event, SweepProgress)]
    assert [event.taken for event in progress] == list(range(10, 301, 10))
    assert progress[-1].hits + progress[-1].misses + progress[-1].rejected == 300


async def test_estimates_are_published_while_the_sweep_is_under_way(live: Live) -> None:
    robot = SimulatedRobot(load_world("office"), seed=1)
    async with live(robot) as it:
        await it.done(MapStart.of("office", robot.stops_m, robot.start))
        said = await it.done(Localize(smallest_error=True))
    estimates = [event for event in said if isinstance(event, PoseEstimate)]
    partial = [event for event in estimates if not event.final]
    assert len(partial) >= 14
    assert [event.readings for event in partial] == sorted(event.readings for event in partial)
    done = next(index for index, event in enumerate(said) if isinstance(event, SweepDone))
    assert sum(isinstance(event, PoseEstimate) for event in said[:done]) >= 10
    assert estimates[-1].final
    # Beside the rank, of the whole sweep alone: nine of ten readings agree within a few cells.
    assert [event.smallest_error_m for event in partial] == [None] * len(partial)
    assert 0.0 < (estimates[-1].smallest_error_m or 0.0) <= 0.2


async def test_in_one_of_two_equal_rooms_it_is_not_sure_of_the_wrong_one(live: Live) -> None:
    """One of the two is on the map a little better than the other, by luck: that is no reason to believe in it."""
    robot = SimulatedRobot(load_world("symmetric"), seed=0)
    by_looks_alone = replace(QUICK, localization=replace(QUICK.localization, history=False))
    states = []
    async with live(robot, by_looks_alone) as it:
        await it.done(MapStart.of("twins", robot.stops_m, robot.start))
        for probe_m in robot.probes_m:
            await it.done(DriveTo(*probe_m))
            found = final_estimates(await it.done(Localize()))[-1]
            states.append(found.state)
            here = (robot.truth.x_m, robot.truth.y_m)
            assert any(math.dist(here, (region.centre.x_m, region.centre.y_m)) < 0.2 for region in found.regions)
            if found.state is PoseState.AMBIGUOUS:
                assert found.best is None
                twins = [(here[0] + shift_m, here[1]) for shift_m in (-5.0, 5.0)]
                assert any(math.dist(twin, (r.centre.x_m, r.centre.y_m)) < 0.3 for twin in twins for r in found.regions)
    assert PoseState.AMBIGUOUS in states


async def test_which_of_two_equal_rooms_it_is_history_knows(live: Live) -> None:
    robot = SimulatedRobot(load_world("symmetric"), seed=0)
    found = []
    async with live(robot) as it:
        await it.done(MapStart.of("twins", robot.stops_m, robot.start))
        for probe_m in robot.probes_m:
            await it.done(DriveTo(*probe_m))
            found.append(final_estimates(await it.done(Localize(heading=PriorHeading.UNKNOWN)))[-1])
            assert found[-1].best is not None
            assert found[-1].best.distance_m(robot.truth) < 0.2
    assert any(one.by_history and one.unreachable for one in found)


async def test_a_robot_taken_off_its_map_is_lost(live: Live) -> None:
    lab, office = (SimulatedRobot(load_world(name), seed=1) for name in ("laboratory", "office"))
    async with live(office, QUICK) as it:
        await it.done(MapStart.of("office", office.stops_m, office.start))
        await it.daemon.control.perform(MapSave())
    async with live(lab, QUICK) as it:
        await it.daemon.control.perform(MapLoad.of("office", None, None))
        found = final_estimates(await it.done(Localize(0.0)))[-1]
    assert found.state is PoseState.LOST
    assert found.best is None


async def test_a_beam_slanted_to_the_floor_maps_and_localizes_as_lily_did(live: Live) -> None:
    level = Config()
    slanted = replace(
        level,
        sweep=replace(level.sweep, tilt_rad=-0.24),
        rangefinder=replace(level.rangefinder, range_max_m=2.1),
    )
    robot = SimulatedRobot(load_world("office"), seed=1)
    async with live(robot, slanted) as it:
        said = await it.done(MapStart.of("office", robot.stops_m, robot.start))
        misses = [event.sweep.count(ReadingStatus.MISS) for event in said if isinstance(event, SweepDone)]
        assert min(misses) > 30
        await it.done(DriveTo(*robot.probes_m[0]))
        found = final_estimates(await it.done(Localize()))[-1]
        assert found.state is PoseState.LOCALIZED
        assert found.best is not None
        assert found.best.distance_m(robot.truth) < 0.1


async def test_a_robot_that_is_lost_does_not_drive_until_it_is_found(live: Live) -> None:
    robot = SimulatedRobot(load_world("office"), seed=1)
    async with live(robot, QUICK) as it:
        await it.done(MapStart.of("office", robot.stops_m, robot.start))
        here = robot.truth
        lost = final_estimates(await it.done(Localize(here.heading_rad + 0.5)))[-1]
        assert lost.state is PoseState.LOST
        _, end = await it.do(DriveTo(*robot.probes_m[0]))
        assert end.phase is MissionPhase.FAILED
        assert "not localized" in end.message
        assert robot.truth.distance_m(here) < 0.01
        found = final_estimates(await it.done(Localize(robot.truth.heading_rad)))[-1]
        assert found.state is PoseState.LOCALIZED
        await it.done(DriveTo(*robot.probes_m[0]))


async def test_a_base_that_was_out_of_sight_is_not_believed(live: Live) -> None:
    robot = SimulatedRobot(load_world("office"), seed=1)
    async with live(robot, QUICK) as it:
        await it.done(MapStart.of("office", robot.stops_m[:2], robot.start))
        own_board(robot, "drive").reboot(4711)
        async with asyncio.timeout(10.0):
            with it.daemon.robot.drive.status_changes.subscribe() as changes:
                while (await changes.get()).link is not LinkState.ABSENT:
                    pass
        await until_ready(it.daemon)
        await it.daemon.control.perform(Arm())
        _, end = await it.do(DriveTo(*robot.stops_m[0]))
        assert "not localized" in end.message
        found = final_estimates(await it.done(Localize()))[-1]
        assert found.state is PoseState.LOCALIZED
        await it.done(DriveTo(*robot.stops_m[0]))


async def test_an_unreachable_place_is_said_at_once_and_nothing_moves(live: Live) -> None:
    robot = SimulatedRobot(load_world("office"), seed=1)
    async with live(robot, QUICK) as it:
        await it.done(MapStart.of("office", robot.stops_m, robot.start))
        before = robot.truth
        said, end = await it.do(DriveTo(50.0, 50.0))
        assert end.phase is MissionPhase.FAILED
        assert "cannot be reached" in end.message
        assert robot.truth.distance_m(before) < 1e-6
        assert it.daemon.supervisor.mode is Mode.IDLE
        assert (said[-1].time_ns - said[0].time_ns) / NS_PER_S < 1.0


async def test_a_saved_map_comes_back_exactly_and_the_robot_is_found_in_it(live: Live) -> None:
    robot = SimulatedRobot(load_world("office"), seed=1)
    async with live(robot, QUICK) as it:
        said = await it.done(MapStart.of("office", robot.stops_m, robot.start))
        cells = await cells_in_use(it.daemon)
        entry = await it.daemon.control.perform(MapSave())
    changes = [event for event in said if isinstance(event, MapChanged) and not event.whole]
    assert [event.generation for event in changes] == list(range(1, len(robot.stops_m) + 2))
    again = SimulatedRobot(load_world("office"), seed=9)
    async with live(again, QUICK) as it:
        loaded = await it.daemon.control.perform(MapLoad.of("office", None, None))
        assert loaded.digest == entry.digest
        assert np.array_equal(await cells_in_use(it.daemon), cells)
        with pytest.raises(MissionError, match="tied to this map"):
            raise MissionError((await it.do(Localize()))[1].message)
        found = final_estimates(await it.done(Localize(again.truth.heading_rad)))[-1]
        assert found.state is PoseState.LOCALIZED
        assert found.best is not None
        assert math.hypot(found.best.x_m - again.truth.x_m, found.best.y_m - again.truth.y_m) < 0.1


async def test_a_robot_that_nobody_knows_the_heading_of_is_found_and_drives_on(live: Live) -> None:
    """Put down anywhere on a saved map, turned by any angle, its wheels tell nothing of where it is or looks."""
    office = load_world("office")
    async with live(SimulatedRobot(office, seed=1)) as it:
        await it.done(MapStart.of("office", office.stops_m, office.start_pose))
        await it.daemon.control.perform(MapSave())
    turned = replace(office, start=replace(office.start, heading_deg=office.start.heading_deg + 137.0))
    robot = SimulatedRobot(turned, seed=5)
    async with live(robot, QUICK) as it:
        await it.daemon.control.perform(MapLoad.of("office", None, None))
        said = await it.done(Localize(heading=PriorHeading.UNKNOWN))
        estimates = final_estimates(said)
        found = estimates[-1]
        assert found.state is PoseState.LOCALIZED
        assert found.best is not None
        # The base turns between the parts of a sweep; odometry, tied to the map, has followed it.
        here = it.daemon.supervisor.robot.drive.odometry.latest
        assert here is not None
        believed = it.daemon.supervisor.whereabouts.pose_of(here)
        assert believed is not None
        assert believed.distance_m(robot.truth) < 0.05
        assert abs(wrap_rad(believed.heading_rad - robot.truth.heading_rad)) < 0.02
        partial = [e for e in said if isinstance(e, PoseEstimate) and not e.final]
        assert [e.readings for e in partial] == sorted(e.readings for e in partial)
        assert 3 <= len(partial) <= 4, "a search at each quarter of the sweep, and no more"
        await it.done(DriveTo(*office.stops_m[0]))
        assert math.dist(office.stops_m[0], (robot.truth.x_m, robot.truth.y_m)) < 0.15
