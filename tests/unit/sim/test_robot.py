from dataclasses import replace

import pytest

from robotd.core.errors import ConfigError
from robotd.sim.buildings.world import Start, load_world
from robotd.sim.robot import DEVICES, SimulatedRobot


def test_it_knows_its_world_and_has_a_board_and_a_clock_for_each_device() -> None:
    world = load_world("laboratory")
    robot = SimulatedRobot(world, 3)
    assert (robot.start, robot.stops_m, robot.probes_m) == (world.start_pose, world.stops_m, world.probes_m)
    assert tuple(robot.boards) == tuple(robot.clocks) == DEVICES
    assert robot.truth == world.start_pose
    assert robot.at_rest


def test_a_start_inside_the_furniture_is_refused() -> None:
    with pytest.raises(ConfigError, match="does not fit"):
        SimulatedRobot(replace(load_world("office"), start=Start(3.8, 3.8)))


def test_clocks_are_those_of_the_seed() -> None:
    world = load_world("office")
    assert SimulatedRobot(world, 1).clocks == SimulatedRobot(world, 1).clocks != SimulatedRobot(world, 2).clocks
