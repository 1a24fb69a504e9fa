"""LILY's part in the experiments, by a simulated robot: sweeps at the stops of a map, and probes at a test pose.

Her beam was slanted to the floor about 2 m ahead, and readings beyond 2.1 m were not believed ([BrownDonald2000]_
sec. 3.2). Ours meets the floor at 2.25 m, so that the floor is never taken for a wall.
"""

import math
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.cli.demo.room import brisk
from robotd.config import Config
from robotd.contract.events import SweepDone
from robotd.contract.missions import Legs, MapStart
from robotd.core.clock import run_virtual
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.hardware.devices.calibration import HeadMount, RangefinderCalibration
from robotd.hardware.devices.pantilt import AimReadback
from robotd.hardware.devices.rangefinder import Shot
from robotd.hardware.devices.reading_in_robot import reading_in_robot
from robotd.localization.stop_poses import StopPoses
from robotd.sim.buildings.world import World
from robotd.sim.physics.body import Body, BodySettings
from robotd.sim.physics.laser import Laser, LaserSettings
from robotd.sim.physics.noise import NoiseSettings, stream
from robotd.sim.physics.plant import ShotAnswer
from robotd.sim.physics.steppers import StepperHead, StepperSettings
from robotd.sim.physics.walls import Point, ray_cast
from robotd.sim.robot import SimulatedRobot
from tests.support.living import living

CUT_OFF_M = 2.1
RANGE_MIN_M = 0.3
TILT_RAD = -0.24
ROBOT_RADIUS_M = BodySettings().radius_m

_CALIBRATION = RangefinderCalibration(range_min_m=RANGE_MIN_M, range_max_m=CUT_OFF_M)
_TURN_US = 2_000_000
"""Longer than the head takes for any turn."""


@dataclass(frozen=True, slots=True)
class Tour:
    """What a mapping mission brought home: sweeps, and where odometry placed them."""

    sweeps: tuple[Sweep, ...]
    map_from_odom: Pose2

    def map_by(self, settings: GridSettings, spec: GridSpec) -> OccupancyGrid:
        """Return the map that these sweeps make."""
        grid = OccupancyGrid(spec, settings=settings)
        for sweep in self.sweeps:
            grid.insert(sweep, self.map_from_odom @ sweep.in_odom)
        return grid


def tour_of(world: World, stops_m: tuple[Point, ...], seed: int) -> Tour:
    """Carry out a mapping mission, daemon, serial protocol and all, in memory and in virtual time."""
    with tempfile.TemporaryDirectory() as directory:
        return run_virtual(_mission(world, stops_m, seed, Path(directory)))


async def _mission(world: World, stops_m: tuple[Point, ...], seed: int, directory: Path) -> Tour:
    # LILY took odometry's word for where its stops were.
    by_odometry = replace(Config().localization, stops=StopPoses.ODOMETRY)
    rangefinder = replace(Config().rangefinder, range_max_m=CUT_OFF_M)
    config = Config(driving=brisk(), rangefinder=rangefinder, localization=by_odometry)
    config = replace(config, sweep=replace(config.sweep, tilt_rad=TILT_RAD))
    robot = SimulatedRobot(world, seed)
    async with living(directory, robot, config) as it:
        said = await it.done(MapStart.of(world.name, stops_m, robot.start, Legs.STRAIGHT))
        tie = it.daemon.supervisor.whereabouts.tie
    assert tie is not None
    return Tour(tuple(event.sweep for event in said if isinstance(event, SweepDone)), tie.map_from_odom)


def probes_at(world: World, pose: Pose2, count: int, seed: int) -> tuple[RangeReading, ...]:
    """Return this many readings evenly round a robot that stands at a pose, whatever became of them."""
    noise = NoiseSettings()
    body = Body(world.walls, pose, BodySettings(), noise, stream(seed, "drive"))
    head = StepperHead(StepperSettings(pan_limit_rad=math.pi))
    laser = Laser(world.walls, body, head, settings=LaserSettings(), noise=noise, randomness=stream(seed, "probes"))
    laser.switch(on=True)
    return tuple(_probe(head, laser, number * _TURN_US, math.tau * number / count) for number in range(count))


def _probe(head: StepperHead, laser: Laser, at_us: int, bearing_rad: float) -> RangeReading:
    head.advance(at_us)
    head.aim(math.remainder(bearing_rad, math.tau), TILT_RAD)
    shot = _shot(laser.shoot(at_us + _TURN_US))
    return reading_in_robot(HeadMount(), _CALIBRATION, AimReadback(0, *head.angles_rad), shot)


def _shot(answer: ShotAnswer) -> Shot:
    match answer.status:
        case ShotStatus.OK:
            return Shot(0, ReadingStatus.OK, answer.range_m, answer.strength)
        case ShotStatus.OVER_RANGE:
            return Shot(0, ReadingStatus.MISS, None, None)
    return Shot(0, ReadingStatus.TOO_NEAR, None, None)


def true_ranges_m(world: World, pose: Pose2, count: int) -> tuple[float, ...]:
    """Return how far the walls really are along this many probes, evenly round."""
    headings = (pose.heading_rad + math.tau * number / count for number in range(count))
    return tuple(ray_cast(world.walls, (pose.x_m, pose.y_m), heading_rad) for heading_rad in headings)
