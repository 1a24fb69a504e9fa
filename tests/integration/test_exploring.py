"""A whole daemon explores rooms that nobody described to it: it ends by itself, and says why."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.config import Config
from robotd.contract.area import Bounds
from robotd.contract.arguments import PoseArgument
from robotd.contract.events import Event, MissionPhase, MissionProgress, StopPlaced, SweepDone
from robotd.contract.explored import ExploringEnded, StopChosen
from robotd.contract.missions import Explore, with_lease
from robotd.contract.requests import MapLoad, PlanTo, RecordStart, RecordStop
from robotd.core.errors import MapError
from robotd.core.pose import Pose2
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.mission.motion.legs import next_odometry
from robotd.sim.buildings.world import Start, Wall, load_world
from robotd.sim.physics.laser import Laser
from robotd.sim.physics.noise import NoiseSettings
from robotd.sim.physics.plant import ShotAnswer
from robotd.sim.robot import SimSettings, SimulatedRobot
from tests.integration.conftest import Live
from tests.support.replayed import check, replayed

pytestmark = pytest.mark.slow

QUICK = Config(sweep=SweepSettings(readings=150))
LYING = SimSettings(noise=NoiseSettings(translation_scale_error=0.05, drift_noise_rad=0.02))
"""Wheels that count 5 % short, and wander."""


def robot_in(world: str, *walls: Wall, seed: int = 1) -> SimulatedRobot:
    room = load_world(world)
    return SimulatedRobot(replace(room, wall=(*room.wall, *walls)), seed, LYING)


def ended(said: list[Event]) -> ExploringEnded:
    (end,) = (event for event in said if isinstance(event, ExploringEnded))
    return end


def chosen(said: list[Event]) -> list[StopChosen]:
    return [event for event in said if isinstance(event, StopChosen)]


async def test_it_explores_an_office_by_itself_and_the_replay_does_the_same(live: Live, tmp_path: Path) -> None:
    robot = robot_in("office")
    async with live(robot) as it:
        recording = await it.daemon.control.perform(RecordStart())
        said = await it.done(Explore.of("office", robot.start, returns=True))
        await it.daemon.control.perform(RecordStop())
        end = ended(said)
        assert end.ending in {"complete", "good_enough", "unreachable"}
        assert end.seen_m2 > 13.0
        assert 2 <= end.stops <= 10
        assert len(chosen(said)) == end.stops - 1
        for choice in chosen(said):
            best = choice.candidates[0]
            assert (best.x_m, best.y_m) == (choice.x_m, choice.y_m)
            assert choice.tour_m[0] == (choice.x_m, choice.y_m)
            assert f"{best.way_m:.1f} m" in choice.reason
        last = [event for event in said if isinstance(event, StopPlaced)][-1]
        assert last.outcome == "placed"
        assert robot.truth.distance_m(robot.start) < 0.15
        assert recording.path is not None
    check(replayed(Path(recording.path)))


async def test_what_was_asked_for_comes_first_and_a_budget_ends_it(live: Live) -> None:
    robot = robot_in("laboratory")
    async with live(robot, QUICK) as it:
        said = await it.done(Explore.of("lab", robot.start, stops_m=((2.5, 1.2),), stops_max=3))
    first, *others = chosen(said)
    assert ((first.x_m, first.y_m), first.reason, first.candidates, first.tour_m) == ((2.5, 1.2), "asked for", (), ())
    assert others
    assert all((other.x_m, other.y_m) == other.tour_m[0] for other in others)
    end = ended(said)
    assert (end.ending, end.stops) == ("budget", 3)
    assert "to_do" in {left.why for left in end.left}
    assert "hidden" not in {left.why for left in end.left}


@pytest.mark.parametrize("budget", [{"way_max_m": 1.0}, {"time_max_s": 20.0}])
async def test_way_and_time_are_budgets_too(live: Live, budget: dict[str, float]) -> None:
    robot = robot_in("laboratory")
    async with live(robot, QUICK) as it:
        end = ended(await it.done(Explore.of("lab", robot.start, **budget)))
    assert end.ending == "budget"
    assert end.stops <= 4


async def test_bounds_keep_it_in_and_must_hold_the_robot(live: Live) -> None:
    robot = robot_in("laboratory")
    async with live(robot, QUICK) as it:
        _, end = await it.do(Explore.of("lab", robot.start, within=Bounds(3.0, 3.0, 6.0, 6.0)))
        assert end.phase is MissionPhase.FAILED
        assert "outside of the bounds" in end.message
        said = await it.done(Explore.of("lab", robot.start, within=Bounds(0.0, 0.0, 3.0, 2.2)))
        assert all(0.0 <= choice.x_m <= 3.0 and 0.0 <= choice.y_m <= 2.2 for choice in chosen(said))
        assert ended(said).stops <= 5


async def test_it_stops_for_what_was_not_there_when_it_looked_round(live: Live) -> None:
    """A box comes to stand in its way while it turns towards its goal: it is seen, told, gone round or left."""
    robot = robot_in("laboratory")
    async with live(robot) as it:
        mission_id = it.daemon.control.start(Explore.of("lab", robot.start, stops_m=((4.2, 1.2),), stops_max=2), 1e4)
        words: list[str] = []
        async for event in it.events:
            if isinstance(event, StopChosen):
                put(robot, Wall(((2.4, 1.0), (2.7, 1.0), (2.7, 1.4), (2.4, 1.4))))
            if isinstance(event, MissionProgress) and event.mission_id == mission_id:
                words.append(event.message)
                phase = event.phase
                if event.is_last:
                    break
        assert any("stands what is not on the map" in message for message in words)
        assert phase is MissionPhase.DONE
        assert not it.daemon.control.status.bumpers_rad


@pytest.mark.parametrize("stays", [True, False], ids=["it stays", "it walks on"])
async def test_it_stops_for_what_steps_in_its_way_while_it_drives(live: Live, stays: bool) -> None:
    """Somebody steps in its way on a leg that was free when it looked along it: no bump, told only if they stay."""
    robot = robot_in("laboratory")
    somebody = Wall(((2.5, 1.0), (2.8, 1.0), (2.8, 1.4), (2.5, 1.4)))
    async with live(robot, QUICK) as it:
        mission_id = it.daemon.control.start(Explore.of("lab", robot.start, stops_m=((4.2, 1.2),), stops_max=2), 1e4)
        words: list[str] = []
        is_there, was_stopped = False, False
        async for event in it.events:
            if not is_there and robot.truth.x_m > 1.55:
                put(robot, somebody)
                is_there = True
            if is_there and not was_stopped and robot.at_rest and robot.truth.x_m < 2.3:
                was_stopped = True
                put(robot, *[somebody] * stays)
            if isinstance(event, MissionProgress) and event.mission_id == mission_id:
                words.append(event.message)
                phase = event.phase
                if event.is_last:
                    break
        assert was_stopped
        assert any("stands what is not on the map" in message for message in words) == stays
        assert phase is MissionPhase.DONE, words
        assert stays or robot.truth.distance_m(Pose2(4.2, 1.2, 0.0)) < 0.2
        assert not it.daemon.control.status.bumpers_rad


async def test_it_does_not_drive_with_a_laser_that_fell_silent(live: Live, monkeypatch: pytest.MonkeyPatch) -> None:
    robot = robot_in("laboratory")
    honest = Laser.shoot

    def blind_on_the_way(laser: Laser, at_us: int) -> ShotAnswer:
        return honest(laser, at_us) if robot.truth.x_m < 1.5 else laser._answer(ShotStatus.WEAK)

    monkeypatch.setattr(Laser, "shoot", blind_on_the_way)
    async with live(robot, QUICK) as it:
        _, end = await it.do(Explore.of("lab", robot.start, stops_m=((4.2, 1.2),), stops_max=2))
    assert end.phase is MissionPhase.FAILED
    assert end.message.startswith("the rangefinder failed 10 times in a row while the robot drove")
    assert robot.truth.x_m < 2.5


def put(robot: SimulatedRobot, *more: Wall) -> None:
    """Put walls where the robot's world had none, in the place of those that were put there before."""
    world = load_world("laboratory")
    walls = replace(world, wall=(*world.wall, *more)).walls
    robot._body._walls = walls
    robot._laser._walls = walls


async def test_it_does_not_begin_where_no_map_could_be_kept(live: Live, tmp_path: Path) -> None:
    (tmp_path / "maps").write_text("a file")
    async with live(robot_in("office"), QUICK) as it:
        with pytest.raises(MapError, match=r"no map could be kept in .*maps"):
            await it.daemon.control.perform(with_lease(Explore.of("office"), 1.0))
        assert it.daemon.control.status.mission_id is None


async def test_going_on_needs_a_map(live: Live) -> None:
    async with live(robot_in("office"), QUICK) as it:
        _, end = await it.do(Explore.of("office", resume=True))
        assert end.phase is MissionPhase.FAILED
        assert "no map is in use" in end.message


async def test_going_on_takes_the_map_in_use_and_its_name(live: Live) -> None:
    robot = robot_in("office")
    async with live(robot, QUICK) as it:
        await it.done(Explore.of("office", robot.start, stops_max=2))
        _, end = await it.do(Explore.of("kitchen", resume=True))
        assert "the map in use is office, not kitchen" in end.message
        said = await it.done(Explore.of("office", resume=True))
        assert ended(said).ending in {"complete", "good_enough", "unreachable"}
        placed = [event for event in said if isinstance(event, StopPlaced)]
        assert placed[0].stop == 2
        assert {event.outcome for event in placed} == {"placed"}
        sweeps = [event.sweep for event in said if isinstance(event, SweepDone)]
        tie = it.daemon.supervisor.whereabouts.believed
        assert tie is not None
        assert tie.in_map(sweeps[-1].in_odom).distance_m(robot.truth) < 0.1


async def test_after_a_crash_it_goes_on_from_the_stops_that_were_kept(live: Live) -> None:
    robot = robot_in("laboratory")
    async with live(robot, QUICK) as it:
        await it.done(Explore.of("lab", robot.start, stops_max=4))
        await it.daemon.control.keeping.keep()
    stood = robot.truth
    again = SimulatedRobot(replace(load_world("laboratory"), start=_start(stood)), 2, LYING)
    async with live(again, QUICK) as it:
        control = it.daemon.control
        recording = await control.perform(RecordStart())
        await next_odometry(it.daemon.robot.drive, 1.0)
        entry = await control.perform(MapLoad("lab", robot_in_map=PoseArgument.of(stood)))
        assert (entry.unsaved, entry.stops) == (True, 4)
        said = await it.done(Explore.of("lab", resume=True, stops_max=3))
        placed = [event for event in said if isinstance(event, StopPlaced)]
        assert [event.stop for event in placed] == [4, 5, 6]
        assert all(event.outcome in {"placed", "weak"} for event in placed)
        assert placed[-1].pose.distance_m(again.truth) < 0.1
        assert (control.status.map_name, control.status.map_unsaved) == ("lab", True)
        await control.perform(RecordStop())
    assert recording.path is not None
    check(replayed(Path(recording.path)))


async def test_a_bump_is_a_place_on_the_map_from_then_on(live: Live, tmp_path: Path) -> None:
    """A box too low for the laser: it is bumped into once, kept with the map, and gone round afterwards."""
    low = Wall(((2.4, 1.0), (2.7, 1.0), (2.7, 1.4), (2.4, 1.4)), height_m=0.1)
    robot = robot_in("laboratory", low)
    async with live(robot, QUICK) as it:
        control = it.daemon.control
        _, end = await it.do(Explore.of("lab", robot.start, stops_m=((4.2, 1.2),), stops_max=2))
        assert end.phase is MissionPhase.STOPPED
        assert "bumper" in end.message
        place = it.daemon.supervisor.whereabouts.map_in_use
        assert place is not None
        ((x_m, y_m),) = place.bumps_m[:1]
        assert abs(x_m - 2.4) < 0.1
        assert 0.9 < y_m < 1.5
        await control.keeping.keep()
        entry = await control.perform(MapLoad("lab"))
        loaded = it.daemon.supervisor.whereabouts.map_in_use
        assert loaded is not None
        assert loaded is not place
        assert loaded.bumps_m == place.bumps_m
        assert entry.unsaved
        way = await control.perform(PlanTo(4.2, 1.2))
        assert way.reason is not None  # nothing says where it is on the map that was loaded


def _start(pose: Pose2) -> Start:
    return Start(pose.x_m, pose.y_m, math.degrees(pose.heading_rad))
