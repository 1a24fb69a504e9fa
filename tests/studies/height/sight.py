"""What a rangefinder on a head measures that looks round level, and at further tilts, wherever somebody puts it."""

import math
import random
from collections.abc import Sequence

from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Slant, Sweep, Tilt
from robotd.hardware.devices.calibration import HeadMount, RangefinderCalibration
from robotd.hardware.devices.pantilt import AimReadback
from robotd.hardware.devices.rangefinder import Shot
from robotd.hardware.devices.reading_in_robot import reading_in_robot
from robotd.hardware.devices.slant import slanted_beam
from robotd.sim.buildings.world import World
from robotd.sim.physics.walls import ray_cast

MOUNT = HeadMount(height_m=0.55)
"""As high as LILY's beam, which met the floor two metres ahead."""
READINGS = 300
_SIGMA_M, _OUTLIERS = 0.02, 0.05
_REACH_M = 10.0


def sweep_at(world: World, pose: Pose2, cut_off_m: float, tilts: Sequence[Tilt], seed: str) -> Sweep:
    """Return a whole look round: 2 cm of noise along the beam, one reading in twenty is wrong."""
    slants = (Slant(tilt, _round(world, pose, tilt, seed)) for tilt in tilts)
    return Sweep(0, IDENTITY, _round(world, pose, Tilt(0.0, cut_off_m), seed), tuple(slants))


def _round(world: World, pose: Pose2, tilt: Tilt, seed: str) -> tuple[RangeReading, ...]:
    # Each tilt by its own stream: what is measured level is the same whatever else is looked at.
    draw = random.Random(f"{seed}/{tilt.tilt_rad}")
    return tuple(_reading(world, pose, tilt, math.tau * number / READINGS, draw) for number in range(READINGS))


def _reading(world: World, pose: Pose2, tilt: Tilt, pan_rad: float, draw: random.Random) -> RangeReading:
    beam = slanted_beam(MOUNT, pan_rad, tilt.tilt_rad)
    start_m = pose.transform(beam.start_x_m, beam.start_y_m)
    wall_m = ray_cast(
        world.walls,
        start_m,
        pose.heading_rad + pan_rad,
        eye_height_m=beam.start_z_m,
        climb=math.tan(tilt.tilt_rad),
    )
    true_m = min(wall_m, beam.floor_m) / beam.per_m
    range_m = true_m + draw.gauss(0.0, _SIGMA_M)
    if draw.random() < _OUTLIERS:
        range_m = draw.uniform(0.3, min(2.0 * true_m, _REACH_M))
    shot = (
        Shot(0, ReadingStatus.OK, range_m, None)
        if 0.0 < range_m <= _REACH_M
        else Shot(0, ReadingStatus.MISS, None, None)
    )
    calibration = RangefinderCalibration(range_max_m=tilt.cut_off_m)
    return reading_in_robot(MOUNT, calibration, AimReadback(0, pan_rad, tilt.tilt_rad), shot)
