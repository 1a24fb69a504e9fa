"""A pan/tilt head: stepper motors of finite speed, between limits."""

import math
from dataclasses import dataclass

from firmware_proto.common import Fault
from robotd.core.angles import FULL_TURN_RAD, wrap_rad

_US_PER_S = 1e6


@dataclass(frozen=True, slots=True)
class StepperSettings:
    """A head like the classic stepper units: +-159 degrees, 185.14 arc seconds a step."""

    pan_limit_rad: float = math.radians(159.0)
    """It pans so far to either side; a half turn or more means without end."""
    tilt_min_rad: float = math.radians(-47.0)
    tilt_max_rad: float = math.radians(31.0)
    speed_radps: float = 6.0
    """Of both axes."""
    step_rad: float = math.radians(185.1428 / 3600.0)
    """Angle of one motor step: where it can rest, and what it reads back."""

    backlash_rad: float = 0.0
    """Play of its pan gears: the beam follows the motor only when that has turned so far the other way."""

    def __post_init__(self) -> None:
        """Refuse a head that cannot turn."""
        for name in ("pan_limit_rad", "speed_radps", "step_rad"):
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise ValueError(f"{name} must be positive, got {getattr(self, name)}")
        if not 0.0 <= self.backlash_rad < 1.0:
            raise ValueError(f"backlash_rad must be in [0, 1), got {self.backlash_rad}")
        if not -math.pi <= self.tilt_min_rad <= 0.0 <= self.tilt_max_rad <= math.pi:
            raise ValueError(f"tilt_min_rad, tilt_max_rad must enclose 0, got {self.tilt_min_rad}, {self.tilt_max_rad}")

    @property
    def is_endless(self) -> bool:
        """Whether it pans on and on."""
        return self.pan_limit_rad >= math.pi


class StepperHead:
    """The plant behind the pan/tilt board; lives in true time [us]. Each axis turns at constant speed."""

    def __init__(self, settings: StepperSettings) -> None:
        self.broken = Fault.NONE
        """What is wrong with it, for those who want to see what comes of that."""
        self._settings = settings
        pan_limit_rad = min(settings.pan_limit_rad, math.pi)
        self.limits_rad = (-pan_limit_rad, pan_limit_rad, settings.tilt_min_rad, settings.tilt_max_rad)
        self._from_rad = (0.0, 0.0)
        self._to_rad = (0.0, 0.0)
        self._gear_rad = 0.0
        """Where the beam panned to when the motion began; within the play it stays there."""
        self._from_us = 0
        self._now_us = 0
        self._arrives_us: int | None = None

    def advance(self, to_us: int) -> None:
        """Let time pass."""
        self._now_us = max(self._now_us, to_us)
        if self._arrives_us is not None and self._now_us >= self._arrives_us:
            self._rest_at(self._to_rad)

    def aim(self, pan_rad: float, tilt_rad: float) -> None:
        """Start turning to the nearest steps; an endless head goes the shorter way round."""
        here = self.true_angles_rad
        # Where the beam is now: a turn that begins within the play first takes it up, and the beam stays.
        lag_rad = self._follow_rad(here[0]) - here[0]
        pan_rad, tilt_rad = self._nearest_step(pan_rad), self._nearest_step(tilt_rad)
        if self._settings.is_endless:
            here = (pan_rad - wrap_rad(pan_rad - here[0]), here[1])
        self._gear_rad = here[0] + lag_rad
        self._from_rad, self._to_rad, self._from_us = here, (pan_rad, tilt_rad), self._now_us
        longest_rad = max(abs(pan_rad - here[0]), abs(tilt_rad - here[1]))
        self._arrives_us = self._now_us + math.ceil(longest_rad / self._settings.speed_radps * _US_PER_S)

    def halt(self) -> None:
        """Stop turning, at the nearest step."""
        pan_rad, tilt_rad = self.true_angles_rad
        self._rest_at((self._nearest_step(pan_rad), self._nearest_step(tilt_rad)))

    @property
    def true_angles_rad(self) -> tuple[float, float]:
        """Where its motors are at this moment."""
        if self._arrives_us is None:
            return self._to_rad
        way_rad = (self._now_us - self._from_us) / _US_PER_S * self._settings.speed_radps
        pan_rad, tilt_rad = (_towards(*axis, way_rad) for axis in zip(self._from_rad, self._to_rad, strict=True))
        return pan_rad, tilt_rad

    @property
    def beam_rad(self) -> tuple[float, float]:
        """Where it points at this moment: where its motors are, less the play of the pan gears."""
        pan_rad, tilt_rad = self.true_angles_rad
        return self._follow_rad(pan_rad), tilt_rad

    @property
    def angles_rad(self) -> tuple[float, float]:
        """What it reads back: whole steps."""
        pan_rad, tilt_rad = self.true_angles_rad
        if self._settings.is_endless and not -math.pi <= pan_rad <= math.pi:
            pan_rad -= math.copysign(FULL_TURN_RAD, pan_rad)  # on its way across the half turn
        return self._nearest_step(pan_rad), self._nearest_step(tilt_rad)

    @property
    def arrives_us(self) -> int | None:
        """When the motion under way will be done; None at rest."""
        return self._arrives_us

    def _nearest_step(self, angle_rad: float) -> float:
        return round(angle_rad / self._settings.step_rad) * self._settings.step_rad

    def _follow_rad(self, motor_rad: float) -> float:
        half_rad = self._settings.backlash_rad / 2.0
        return min(max(self._gear_rad, motor_rad - half_rad), motor_rad + half_rad)

    def _rest_at(self, angles_rad: tuple[float, float]) -> None:
        self._gear_rad = self._follow_rad(angles_rad[0])
        self._to_rad = angles_rad
        self._arrives_us = None


def _towards(start_rad: float, end_rad: float, way_rad: float) -> float:
    missing_rad = end_rad - start_rad
    return end_rad if abs(missing_rad) <= way_rad else start_rad + math.copysign(way_rad, missing_rad)
