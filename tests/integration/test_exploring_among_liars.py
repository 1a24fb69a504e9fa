"""Exploring where nothing is as it should be: it ends, says why, and stands."""

import asyncio
from collections.abc import Callable
from dataclasses import replace

import pytest

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.contract.events import MissionPhase, MissionProgress, SweepDone
from robotd.contract.explored import ExploringEnded
from robotd.contract.missions import Explore
from robotd.sim.buildings.world import Start, Wall, World, load_world
from robotd.sim.physics.body import Body
from robotd.sim.physics.laser import Laser
from robotd.sim.physics.plant import ShotAnswer
from robotd.sim.robot import SimulatedRobot
from tests.integration.conftest import Live

pytestmark = pytest.mark.slow

Counts = tuple[int, int]


def room(width_m: float, height_m: float, start: Start) -> World:
    corners_m = ((0.0, 0.0), (width_m, 0.0), (width_m, height_m), (0.0, height_m))
    return World("room", start, (Wall(corners_m),))


@pytest.mark.parametrize(
    ("world", "endings"),
    [
        (room(2.0, 2.0, Start(1.0, 1.0)), {"complete"}),
        (room(0.9, 0.9, Start(0.45, 0.45)), {"complete", "unreachable"}),
    ],
    ids=["nothing to discover", "walled in"],
)
async def test_where_there_is_nowhere_to_go_one_look_is_enough(live: Live, world: World, endings: set[str]) -> None:
    robot = SimulatedRobot(world, 1)
    async with live(robot) as it:
        said = await it.done(Explore.of("room", robot.start))
    (end,) = (event for event in said if isinstance(event, ExploringEnded))
    assert end.ending in endings
    assert (end.stops, end.way_m) == (1, 0.0)
    assert robot.truth.distance_m(robot.start) < 1e-9


async def test_a_corridor_without_end_takes_the_budget(live: Live) -> None:
    world = room(200.0, 2.0, Start(100.0, 1.0))
    robot = SimulatedRobot(world, 1)
    async with live(robot) as it:
        said = await it.done(Explore.of("corridor", robot.start, stops_max=2))
    (end,) = (event for event in said if isinstance(event, ExploringEnded))
    assert (end.ending, end.stops) == ("budget", 2)
    assert {left.why for left in end.left} == {"to_do"}


async def test_a_door_that_closes_behind_it_is_seen_and_not_driven_into(live: Live) -> None:
    """Two rooms; once it is in the second, the door is no more: it cannot go back, says so, and ends all the same."""
    between = Wall(((3.0, 0.0), (3.0, 0.7)), closed=False), Wall(((3.0, 1.9), (3.0, 2.6)), closed=False)
    world = room(6.0, 2.6, Start(1.2, 1.3))
    world = replace(world, wall=(*world.wall, *between))
    robot = SimulatedRobot(world, 1)
    async with live(robot) as it:
        mission = Explore.of("rooms", robot.start, stops_m=((4.5, 1.3),), stops_max=4, returns=True)
        mission_id = it.daemon.control.start(mission, 1e5)
        words: list[str] = []
        sweeps = 0
        async for event in it.events:
            if isinstance(event, SweepDone):
                sweeps += 1
                if sweeps == 2:
                    assert robot.truth.x_m > 4.0
                    _put(robot, replace(world, wall=(*world.wall, Wall(((3.0, 0.7), (3.0, 1.9)), closed=False))))
            if isinstance(event, MissionProgress) and event.mission_id == mission_id:
                words.append(event.message)
                phase = event.phase
                if event.is_last:
                    break
        assert phase is MissionPhase.DONE, words[-1]
        assert any("not got back" in message for message in words)
        assert not it.daemon.control.status.bumpers_rad
    assert robot.truth.x_m > 3.3


def _put(robot: SimulatedRobot, world: World) -> None:
    robot._body._walls = world.walls
    robot._laser._walls = world.walls


@pytest.mark.parametrize(
    ("lie", "words"),
    [
        pytest.param(lambda way, turn: (way // 2, turn), "", id="half as far"),
        pytest.param(lambda way, turn: (way, -turn), "turn is no nearer to its end", id="mirrored"),
        pytest.param(lambda way, turn: (0, 0), "turn is no nearer to its end", id="it stands"),
    ],
)
async def test_odometry_that_lies_ends_it_with_words_and_the_robot_stands(
    live: Live, monkeypatch: pytest.MonkeyPatch, lie: Callable[[int, int], Counts], words: str
) -> None:
    honest = vars(Body)["counts"].fget
    monkeypatch.setattr(Body, "counts", property(lambda body: lie(*honest(body))))
    robot = SimulatedRobot(load_world("laboratory"), 1)
    async with live(robot) as it:
        _, end = await it.do(Explore.of("lab", robot.start, stops_max=3))
        assert words in end.message
        await asyncio.sleep(1.0)
        assert robot.at_rest


async def test_a_laser_that_answers_a_tenth_of_the_time_is_no_laser(
    live: Live, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = SimulatedRobot(load_world("office"), 1)
    honest, count = Laser.shoot, iter(range(10**9))

    def mostly_blind(laser: Laser, at_us: int) -> ShotAnswer:
        answer = honest(laser, at_us)
        return answer if next(count) % 10 == 0 else laser._answer(ShotStatus.WEAK)

    monkeypatch.setattr(Laser, "shoot", mostly_blind)
    async with live(robot) as it:
        _, end = await it.do(Explore.of("office", robot.start))
        assert end.phase is MissionPhase.FAILED
        assert "the rangefinder failed at" in end.message
    assert robot.truth.distance_m(robot.start) < 1e-9
