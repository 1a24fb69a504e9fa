"""What an emulated board has under it: the physics, simulated or recorded.

Boards speak the protocol and know no physics; plants are physics and know no protocol. All times are the
board's own, in microseconds, and only ever grow.
"""

from dataclasses import dataclass
from typing import Protocol

from firmware_proto.common import Fault
from firmware_proto.rangefinder_messages import ShotStatus


class DrivePlant(Protocol):
    """A synchro-drive base."""

    def advance(self, to_us: int) -> None:
        """Let time pass."""

    def command(self, speed_mps: float, turn_radps: float) -> None:
        """Ramp towards these velocities."""

    def cut(self) -> None:
        """Cut the motors: no ramp."""

    @property
    def counts(self) -> tuple[int, int]:
        """Translation and rotation encoder, unwrapped."""

    @property
    def velocity(self) -> tuple[float, float]:
        """Measured translation [m/s] and rotation [rad/s]."""

    @property
    def bumpers(self) -> int:
        """Pressed bumpers, bit i at i * 22.5 degrees counter-clockwise of the heading."""

    @property
    def battery_mv(self) -> int:
        """Battery voltage [mV]."""

    @property
    def broken(self) -> Fault:
        """``MOTOR``, ``BATTERY``: what is wrong at this moment."""


_WATCH_US = 10_000
"""A fixed grid: how often somebody looks must not change what a base feels."""


class BumperWatch:
    """A moving base looks at its bumpers on a fixed grid, and once more when it has come to rest."""

    def __init__(self, plant: DrivePlant) -> None:
        self._plant = plant
        self._was_moving = False
        self.due_us: int | None = None
        """When it looks next."""

    def looked(self, now_us: int) -> None:
        """Note that the plant was looked at."""
        moves = any(self._plant.velocity)
        self.due_us = (now_us // _WATCH_US + 1) * _WATCH_US if moves or self._was_moving else None
        self._was_moving = moves


class HeadPlant(Protocol):
    """A pan/tilt head."""

    limits_rad: tuple[float, float, float, float]
    """Pan min, pan max, tilt min, tilt max."""

    def advance(self, to_us: int) -> None:
        """Let time pass."""

    def aim(self, pan_rad: float, tilt_rad: float) -> None:
        """Start turning there; inside the limits."""

    def halt(self) -> None:
        """Stop turning where it is."""

    @property
    def angles_rad(self) -> tuple[float, float]:
        """Measured pan and tilt."""

    @property
    def arrives_us(self) -> int | None:
        """When the motion under way will be done; None at rest."""

    @property
    def broken(self) -> Fault:
        """``MOTOR``: what is wrong at this moment."""


@dataclass(frozen=True, slots=True)
class ShotAnswer:
    """What the instrument gives for one shot."""

    status: ShotStatus
    range_m: float
    """Along the beam; 0.0 unless the status is OK."""
    strength: int
    takes_us: int
    """How long the measurement lasts before the board can answer."""


class LaserPlant(Protocol):
    """A laser rangefinder on the head."""

    def switch(self, *, on: bool) -> None:
        """Switch the light."""

    def shoot(self, at_us: int) -> ShotAnswer:
        """Measure along the beam as the head points at that moment."""


class ScannerPlant(LaserPlant, Protocol):
    """A laser that a mirror of its own can turn, too."""

    def measure(self, at_us: int, pan_rad: float) -> ShotAnswer:
        """Measure level in a direction, counter-clockwise from the robot's heading, wherever the head points."""
