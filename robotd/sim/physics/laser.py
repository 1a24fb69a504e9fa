"""A point laser on the head: one beam, through the room or down to its floor."""

import math
import random
from dataclasses import dataclass

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.core.pose import Pose2
from robotd.hardware.devices.calibration import HeadMount
from robotd.hardware.devices.slant import slanted_beam
from robotd.sim.physics.body import Body
from robotd.sim.physics.noise import NoiseSettings
from robotd.sim.physics.plant import ShotAnswer
from robotd.sim.physics.steppers import StepperHead
from robotd.sim.physics.walls import WallSegments, ray_cast

_STRENGTH_AT_1_M = 20_000
_STRENGTH_MAX = 65_535


@dataclass(frozen=True, slots=True)
class LaserSettings:
    """The instrument and how it is mounted."""

    range_min_m: float = 0.3
    """Nearer obstacles cannot be measured."""
    reach_m: float = 10.0
    """From farther ones nothing comes back."""
    takes_us: int = 4_000
    """Time of one measurement."""
    range_bias_m: float = 0.0
    """What it adds to every range."""
    height_m: float = 0.55
    """Of the beam's origin above the floor."""
    mount_x_m: float = 0.0
    """Of the beam's origin in the robot frame."""
    mount_y_m: float = 0.0
    pan_zero_rad: float = 0.0
    """Where the beam points in the robot frame when the head reads pan 0."""
    tilt_zero_rad: float = 0.0
    """How far above level the beam points when the head reads tilt 0."""
    lens_ahead_m: float = 0.0
    lens_up_m: float = 0.0
    """Where the beam leaves the head, ahead of its axes and above them, when it looks level."""

    def __post_init__(self) -> None:
        """Refuse an instrument that cannot measure."""
        if not 0.0 <= self.range_min_m < self.reach_m:
            raise ValueError(f"range_min_m must lie in [0, reach_m), got {self.range_min_m}, {self.reach_m}")
        if not self.height_m > 0.0:
            raise ValueError(f"height_m must be positive, got {self.height_m}")
        if self.takes_us < 1:
            raise ValueError(f"takes_us must be at least 1, got {self.takes_us}")

    @property
    def mount(self) -> HeadMount:
        """Where the beam begins, with no zeros: those are added to what the head reads."""
        return HeadMount(
            self.mount_x_m,
            self.mount_y_m,
            height_m=self.height_m,
            lens_ahead_m=self.lens_ahead_m,
            lens_up_m=self.lens_up_m,
        )


class Laser:
    """The plant behind the rangefinder board; lives in true time [us]."""

    def __init__(
        self,
        walls: WallSegments,
        body: Body,
        head: StepperHead,
        *,
        settings: LaserSettings,
        noise: NoiseSettings,
        randomness: random.Random,
    ) -> None:
        self._walls = walls
        self._body = body
        self._head = head
        self._settings = settings
        self._mount = settings.mount
        self._noise = noise
        self._random = randomness
        self._on = False

    def switch(self, *, on: bool) -> None:
        """Switch the light; without it every shot is answered ``LASER_OFF``."""
        self._on = on

    def shoot(self, at_us: int) -> ShotAnswer:
        """Measure along the beam, from where body and head are at that moment."""
        if not self._on:
            return self._answer(ShotStatus.LASER_OFF)
        self._head.advance(at_us)
        return self._answer_along(at_us, *self._head.beam_rad)

    def measure(self, at_us: int, pan_rad: float) -> ShotAnswer:
        """Measure level in a direction, wherever the head points."""
        if not self._on:
            return self._answer(ShotStatus.LASER_OFF)
        return self._answer_along(at_us, pan_rad, 0.0)

    def _answer_along(self, at_us: int, pan_rad: float, tilt_rad: float) -> ShotAnswer:
        self._body.advance(at_us)
        range_m = self._measured_m(self._true_range_m(pan_rad, tilt_rad))
        if range_m > self._settings.reach_m:
            return self._answer(ShotStatus.OVER_RANGE)
        # Judged by what was measured, not by what is true: the instrument knows no other.
        if range_m < self._settings.range_min_m:
            return self._answer(ShotStatus.TOO_NEAR)
        return self._answer(ShotStatus.OK, range_m)

    def _true_range_m(self, pan_rad: float, tilt_rad: float) -> float:
        """Return the way of the light to the first wall or the floor; ``inf`` if there is neither."""
        settings = self._settings
        pan_rad, tilt_rad = pan_rad + settings.pan_zero_rad, tilt_rad + settings.tilt_zero_rad
        beam = slanted_beam(self._mount, pan_rad, tilt_rad)
        world_from_beam = self._body.true_pose @ Pose2(beam.start_x_m, beam.start_y_m, pan_rad)
        wall_m = ray_cast(
            self._walls,
            (world_from_beam.x_m, world_from_beam.y_m),
            world_from_beam.heading_rad,
            eye_height_m=beam.start_z_m,
            climb=math.tan(tilt_rad),
        )
        return min(wall_m, beam.floor_m) / beam.per_m  # from level to along the beam

    def _measured_m(self, true_m: float) -> float:
        """Return what the instrument makes of it; every shot draws the same amount of randomness."""
        settings = self._settings
        # Drawn whether they are needed or not: one outlier more must not change all shots after it.
        lottery, place = self._random.random(), self._random.random()
        error_m = self._random.gauss(0.0, self._noise.range_sigma_m)
        if lottery < self._noise.outlier_share:
            # Anywhere up to twice the way: a wrong reading is short as often as it is long.
            farthest_m = min(settings.reach_m, 2.0 * true_m)
            return settings.range_min_m + place * max(0.0, farthest_m - settings.range_min_m)
        return true_m + error_m + settings.range_bias_m

    def _answer(self, status: ShotStatus, range_m: float = 0.0) -> ShotAnswer:
        # What comes back falls with the square of the distance.
        strength = min(_STRENGTH_MAX, round(_STRENGTH_AT_1_M / range_m**2)) if range_m else 0
        return ShotAnswer(status, range_m, strength, self._settings.takes_us)
