"""A map is made where odometry lies: each stop is placed on the stops before it."""

from dataclasses import replace

import pytest

from robotd.config import Config
from robotd.contract.events import Event, MapChanged, StopPlaced, SweepDone
from robotd.contract.missions import MapStart
from robotd.core.pose import Pose2
from robotd.localization.stop_poses import StopPoses
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.sim.buildings.world import load_world
from robotd.sim.physics.noise import NoiseSettings
from robotd.sim.robot import SimSettings, SimulatedRobot
from tests.integration.conftest import Live
from tests.support.living import Living

pytestmark = pytest.mark.slow

QUICK = Config(sweep=SweepSettings(readings=150))
LYING = NoiseSettings(translation_scale_error=0.05, rotation_scale_error=0.03, drift_noise_rad=0.02)
"""Wheels that count 5 % short and turns that go 3 % too far, and wander."""


def lying_robot() -> SimulatedRobot:
    return SimulatedRobot(load_world("laboratory"), seed=5, settings=SimSettings(noise=LYING))


async def mapped(it: Living, robot: SimulatedRobot) -> tuple[list[Event], Pose2]:
    """Map the laboratory; return what was said, and where odometry alone has the robot in the end."""
    said = await it.done(MapStart.of("lab", robot.stops_m[:5], robot.start))
    first, last = ([event.sweep for event in said if isinstance(event, SweepDone)][at].in_odom for at in (0, -1))
    return said, robot.start @ first.inverse() @ last


async def test_stops_are_placed_to_centimetres_where_odometry_is_decimetres_off(live: Live) -> None:
    robot = lying_robot()
    async with live(robot, QUICK) as it:
        said, by_odometry = await mapped(it, robot)
        placed = [event for event in said if isinstance(event, StopPlaced)]
        assert [event.stop for event in placed] == list(range(6))
        assert {event.outcome for event in placed[1:]} <= {"placed", "wide", "weak"}
        assert by_odometry.distance_m(robot.truth) > 0.25
        assert placed[-1].pose.distance_m(robot.truth) < 0.12
        assert placed[-1].deviation_m < 0.1
        # Tied in the same step: what is told next is told on the map as it is.
        tie = it.daemon.supervisor.whereabouts.believed
        last = [event.sweep.in_odom for event in said if isinstance(event, SweepDone)][-1]
        assert tie is not None
        assert tie.in_map(last).distance_m(placed[-1].pose) < 1e-9
        changes = [event for event in said if isinstance(event, MapChanged) and not event.whole]
        assert [event.stops for event in changes] == [1, 2, 3, 4, 5, 6]


async def test_where_that_is_not_wanted_odometry_has_the_only_say(live: Live) -> None:
    robot = lying_robot()
    config = replace(QUICK, localization=replace(QUICK.localization, stops=StopPoses.ODOMETRY))
    async with live(robot, config) as it:
        said, by_odometry = await mapped(it, robot)
        assert not any(isinstance(event, StopPlaced) for event in said)
        tie = it.daemon.supervisor.whereabouts.believed
        last = [event.sweep.in_odom for event in said if isinstance(event, SweepDone)][-1]
        assert tie is not None
        assert tie.in_map(last).distance_m(by_odometry) < 1e-9
