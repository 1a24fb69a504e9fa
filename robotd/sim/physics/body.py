"""A synchro-drive body: ramps, wheels, encoders, bumpers.

Theory of operation: the state is known exactly at *knots*: multiples of 5 ms, and the moments of commands.
Between two knots each wheel speed is a ramp into a plateau, so the way and the turn are closed formulas; the
path is the arc of that way and turn. Whatever is asked between knots is computed from the last one and
forgotten: how often somebody looks, or advances, changes nothing. Randomness, slip and collision enter at
knots only.
"""

import math
import random
from dataclasses import dataclass

from firmware_proto.common import Fault
from robotd.core.angles import FULL_TURN_RAD
from robotd.core.pose import Pose2
from robotd.sim.physics.noise import NoiseSettings
from robotd.sim.physics.walls import WallSegments, clearance_m, nearest_points

_KNOT_US = 5_000
_US_PER_S = 1e6
_US_PER_H = 3.6e9
_BUMPERS = 16
_BUMPER_GIVE_M = 0.005
"""Travel of a bumper; at least what the body covers between two knots, so that it feels what stops it."""


@dataclass(frozen=True, slots=True)
class BodySettings:
    """A body like LILY's. The encoder scales are those a calibrated daemon expects by default."""

    radius_m: float = 0.3
    acceleration_mps2: float = 0.6
    turn_acceleration_radps2: float = 3.0
    speed_max_mps: float = 0.9
    turn_max_radps: float = 2.5
    counts_per_m: float = 27300.0
    counts_per_rad: float = 4096.0
    battery_full_mv: int = 25_600
    battery_drain_mv_per_h: float = 500.0

    def __post_init__(self) -> None:
        """Refuse a body that cannot be."""
        for name in self.__slots__:
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"{name} must be positive, got {value}")

    @property
    def bumper_reach_m(self) -> float:
        """How near a wall presses a bumper."""
        return self.radius_m + max(_BUMPER_GIVE_M, 1.1 * self.speed_max_mps * _KNOT_US / _US_PER_S)


@dataclass(slots=True)
class _Axis:
    """One wheel speed that ramps towards a goal."""

    limit: float
    acceleration: float
    speed: float = 0.0
    goal: float = 0.0

    def after(self, seconds: float) -> tuple[float, float]:
        """Return ``(way, speed)`` after some time."""
        missing = self.goal - self.speed
        ramp_s = min(seconds, abs(missing) / self.acceleration)
        reached = self.goal if ramp_s < seconds else self.speed + math.copysign(self.acceleration, missing) * ramp_s
        return (self.speed + reached) / 2.0 * ramp_s + self.goal * (seconds - ramp_s), reached

    def head_for(self, goal: float) -> None:
        self.goal = min(self.limit, max(-self.limit, goal))

    def halt(self) -> None:
        self.speed = self.goal = 0.0

    @property
    def rests(self) -> bool:
        return self.speed == 0.0 and self.goal == 0.0


class Body:
    """The plant behind the drive board; lives in true time [us]."""

    def __init__(
        self, walls: WallSegments, start: Pose2, settings: BodySettings, noise: NoiseSettings, randomness: random.Random
    ) -> None:
        self.broken = Fault.NONE
        """What is wrong with it, for those who want to see what comes of that."""
        self._walls = walls
        self._settings = settings
        self._noise = noise
        self._random = randomness
        self._pose = start
        self._wheel_m = 0.0
        self._wheel_rad = 0.0
        self._speed = _Axis(settings.speed_max_mps, settings.acceleration_mps2)
        self._turn = _Axis(settings.turn_max_radps, settings.turn_acceleration_radps2)
        # Kept as a bound, and lessened by each way: walls are looked at once in some metres, not at each knot.
        self._clearance_m = clearance_m(walls, (start.x_m, start.y_m))
        self._first_us: int | None = None
        self._knot_us = 0
        self._now_us = 0

    def advance(self, to_us: int) -> None:
        """Let time pass; the past stays as it was."""
        if self._first_us is None:
            self._first_us = to_us
        self._now_us = max(self._now_us, to_us)
        while not self.at_rest:
            # On a fixed grid, whenever a command came: how often somebody looks changes nothing.
            next_us = self._knot_us - self._knot_us % _KNOT_US + _KNOT_US
            if next_us > self._now_us:
                return
            self._tie(next_us)
        self._knot_us = self._now_us  # at rest nothing happens: an hour of it is one step

    def command(self, speed_mps: float, turn_radps: float) -> None:
        """Ramp towards these velocities, as far as the motors go."""
        self._tie(self._now_us)  # a new ramp begins here, so here must be a knot
        self._speed.head_for(speed_mps)
        self._turn.head_for(turn_radps)

    def cut(self) -> None:
        """Cut the motors: the body stands."""
        self._tie(self._now_us)
        self._speed.halt()
        self._turn.halt()

    @property
    def counts(self) -> tuple[int, int]:
        """Translation and rotation encoder."""
        way_m, turn_rad = self._since_knot()
        return (
            # An encoder counts what has passed: it never rounds up.
            math.floor((self._wheel_m + way_m) * self._settings.counts_per_m),
            math.floor((self._wheel_rad + turn_rad) * self._settings.counts_per_rad),
        )

    @property
    def velocity(self) -> tuple[float, float]:
        """Translation [m/s] and rotation [rad/s] of the wheels."""
        seconds = (self._now_us - self._knot_us) / _US_PER_S
        return self._speed.after(seconds)[1], self._turn.after(seconds)[1]

    @property
    def at_rest(self) -> bool:
        """Whether it stands, and nobody asks it to move."""
        return self._speed.rests and self._turn.rests

    @property
    def true_pose(self) -> Pose2:
        """Where it really is, world frame."""
        way_m, turn_rad = self._since_knot()
        return _after_arc(self._pose, self._true_way_m(way_m), self._true_turn_rad(turn_rad))

    @property
    def bumpers(self) -> int:
        """Pressed bumpers: bit i for a wall that touches it at ``i * 22.5`` degrees of the heading."""
        reach_m = self._settings.bumper_reach_m
        # Walls are searched only where one can be near: most of the time none is.
        if self._clearance_m > reach_m:
            return 0
        distances, offsets = nearest_points(self._walls, (self._pose.x_m, self._pose.y_m))
        pressed = 0
        for offset_x_m, offset_y_m in offsets[distances <= reach_m]:
            bearing_rad = math.atan2(offset_y_m, offset_x_m) - self._pose.heading_rad
            pressed |= 1 << round(bearing_rad / FULL_TURN_RAD * _BUMPERS) % _BUMPERS
        return pressed

    @property
    def battery_mv(self) -> int:
        """Battery voltage, which slowly falls."""
        hours = (self._now_us - (self._first_us or 0)) / _US_PER_H
        return max(0, round(self._settings.battery_full_mv - hours * self._settings.battery_drain_mv_per_h))

    def _since_knot(self) -> tuple[float, float]:
        seconds = (self._now_us - self._knot_us) / _US_PER_S
        return self._speed.after(seconds)[0], self._turn.after(seconds)[0]

    def _true_way_m(self, way_m: float) -> float:
        return way_m * (1.0 + self._noise.translation_scale_error)

    def _true_turn_rad(self, turn_rad: float) -> float:
        return turn_rad * (1.0 + self._noise.rotation_scale_error)

    def _tie(self, at_us: int) -> None:
        """Make ``at_us`` the last knot."""
        seconds = (at_us - self._knot_us) / _US_PER_S
        self._knot_us = at_us
        if self.at_rest or seconds <= 0.0:
            return
        way_m, speed_mps = self._speed.after(seconds)
        turn_rad, turn_radps = self._turn.after(seconds)
        pose = self._randomized(way_m, turn_rad)
        if self._is_blocked(pose):
            # A wall takes the way and not the turn: a round body still turns on the spot beside it.
            way_m = speed_mps = 0.0
            pose = Pose2(self._pose.x_m, self._pose.y_m, pose.heading_rad)
        self._pose = pose
        self._wheel_m += way_m
        self._wheel_rad += turn_rad
        self._speed.speed, self._turn.speed = speed_mps, turn_radps

    def _randomized(self, way_m: float, turn_rad: float) -> Pose2:
        noise, gauss = self._noise, self._random.gauss
        # Wheels count what they turned; only the body falls short of it.
        slipped_m = way_m * min(1.0, noise.slip_share * self._random.expovariate(1.0)) if noise.slip_share else 0.0
        # Errors of independent steps add up as their squares, so noise grows with the root of the way.
        root_m, root_rad = math.sqrt(abs(way_m)), math.sqrt(abs(turn_rad))
        true_m = self._true_way_m(way_m) - slipped_m + gauss(0.0, noise.translation_noise_m) * root_m
        true_rad = self._true_turn_rad(turn_rad) + gauss(0.0, noise.rotation_noise_rad) * root_rad
        return _after_arc(self._pose, true_m, true_rad + gauss(0.0, noise.drift_noise_rad) * root_m)

    def _is_blocked(self, pose: Pose2) -> bool:
        """Whether a wall is in the way; walls are looked at only when one may be near enough."""
        nearest_m = self._clearance_m - pose.distance_m(self._pose)
        if nearest_m > self._settings.bumper_reach_m:
            self._clearance_m = nearest_m
            return False
        before_m = clearance_m(self._walls, (self._pose.x_m, self._pose.y_m))
        after_m = clearance_m(self._walls, (pose.x_m, pose.y_m))
        # Away from a wall it may always go, or it would stick where it touched.
        blocked = after_m < self._settings.radius_m and after_m < before_m
        self._clearance_m = before_m if blocked else after_m
        return blocked


def _after_arc(pose: Pose2, way_m: float, turn_rad: float) -> Pose2:
    """Return where an arc ends that begins at ``pose``: the chord leaves it at half the turn."""
    half = turn_rad / 2.0
    chord_m = way_m if abs(half) < 1e-9 else way_m * math.sin(half) / half
    return pose @ Pose2(chord_m * math.cos(half), chord_m * math.sin(half), turn_rad)
