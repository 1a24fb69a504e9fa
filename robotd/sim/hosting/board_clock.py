"""A board's own clock: it began at another moment than the host's, and runs at another rate.

Plants live in *true time*, the host's monotonic clock in microseconds; boards live in their own. The three
adapters here stand between a board and its plant.
"""

from dataclasses import dataclass, replace

from firmware_proto.common import Fault
from robotd.sim.physics.noise import stream
from robotd.sim.physics.plant import DrivePlant, HeadPlant, ScannerPlant, ShotAnswer

_PPB = 10**9
_OLDEST_BOOT_US = 600_000_000
"""Each board has been up for a time of its own, ten minutes at most."""


@dataclass(frozen=True, slots=True)
class BoardClock:
    """Integer arithmetic throughout: exact, and monotonic whatever the numbers."""

    offset_us: int = 0
    """The board's time when the host's clock showed 0."""
    skew_ppb: int = 0
    """How many nanoseconds it gains in a second."""

    @classmethod
    def of_seed(cls, seed: int, device: str, skew_ppm: float) -> "BoardClock":
        """Draw the clock of one device."""
        random = stream(seed, f"{device}/clock")
        # From a stream of its own: another board on the robot must not change what this one's clock is.
        return cls(random.randrange(_OLDEST_BOOT_US), round(random.uniform(-1000.0, 1000.0) * skew_ppm))

    def board_us(self, true_us: int) -> int:
        """Return the board's time at a true time."""
        return self.offset_us + true_us * (_PPB + self.skew_ppb) // _PPB

    def true_us(self, board_us: int) -> int:
        """Return the earliest true time at which the board's clock shows ``board_us``."""
        # Rounded up, so that the board's clock has got there by then.
        return -((self.offset_us - board_us) * _PPB // (_PPB + self.skew_ppb))


class DriveOnClock:
    """A drive plant as its board times it."""

    def __init__(self, plant: DrivePlant, clock: BoardClock) -> None:
        self._plant = plant
        self._clock = clock

    def advance(self, to_us: int) -> None:
        """Let time pass."""
        self._plant.advance(self._clock.true_us(to_us))

    def command(self, speed_mps: float, turn_radps: float) -> None:
        """Ramp towards these velocities."""
        self._plant.command(speed_mps, turn_radps)

    def cut(self) -> None:
        """Cut the motors."""
        self._plant.cut()

    @property
    def counts(self) -> tuple[int, int]:
        """Translation and rotation encoder."""
        return self._plant.counts

    @property
    def velocity(self) -> tuple[float, float]:
        """Measured translation [m/s] and rotation [rad/s]."""
        return self._plant.velocity

    @property
    def bumpers(self) -> int:
        """Pressed bumpers."""
        return self._plant.bumpers

    @property
    def battery_mv(self) -> int:
        """Battery voltage [mV]."""
        return self._plant.battery_mv

    @property
    def broken(self) -> Fault:
        """What is wrong at this moment."""
        return self._plant.broken


class HeadOnClock:
    """A head plant as its board times it."""

    def __init__(self, plant: HeadPlant, clock: BoardClock) -> None:
        self._plant = plant
        self._clock = clock
        self.limits_rad = plant.limits_rad

    def advance(self, to_us: int) -> None:
        """Let time pass."""
        self._plant.advance(self._clock.true_us(to_us))

    def aim(self, pan_rad: float, tilt_rad: float) -> None:
        """Start turning there."""
        self._plant.aim(pan_rad, tilt_rad)

    def halt(self) -> None:
        """Stop turning where it is."""
        self._plant.halt()

    @property
    def angles_rad(self) -> tuple[float, float]:
        """Measured pan and tilt."""
        return self._plant.angles_rad

    @property
    def arrives_us(self) -> int | None:
        """When the motion under way will be done."""
        arrives_us = self._plant.arrives_us
        # A tick later: rounded down, the board would look before the head is there.
        return None if arrives_us is None else self._clock.board_us(arrives_us) + 1

    @property
    def broken(self) -> Fault:
        """What is wrong at this moment."""
        return self._plant.broken


class LaserOnClock:
    """A laser plant as its board times it."""

    def __init__(self, plant: ScannerPlant, clock: BoardClock) -> None:
        self._plant = plant
        self._clock = clock

    def switch(self, *, on: bool) -> None:
        """Switch the light."""
        self._plant.switch(on=on)

    def shoot(self, at_us: int) -> ShotAnswer:
        """Measure along the beam."""
        return self._timed(at_us, self._plant.shoot(self._clock.true_us(at_us)))

    def measure(self, at_us: int, pan_rad: float) -> ShotAnswer:
        """Measure in a direction."""
        return self._timed(at_us, self._plant.measure(self._clock.true_us(at_us), pan_rad))

    def _timed(self, at_us: int, answer: ShotAnswer) -> ShotAnswer:
        at_true_us = self._clock.true_us(at_us)
        done_us = self._clock.board_us(at_true_us + answer.takes_us)
        return replace(answer, takes_us=max(1, done_us - at_us))
