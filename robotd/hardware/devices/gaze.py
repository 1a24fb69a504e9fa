"""Where a scanner is asked to look: set by a head that has no motor, read by the scanner.

A scanner measures all round at once. For missions, which aim and shoot, it is two devices: a head that turns by
choosing one of the directions that are measured anyhow, and a rangefinder that gives the reading of the one chosen.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Fan:
    """The directions that a scanner measures, evenly apart."""

    first_rad: float
    """The one farthest to the right, counter-clockwise from the scanner's front."""
    step_rad: float
    """From one to the next, to the left."""
    count: int

    @property
    def last_rad(self) -> float:
        """The one farthest to the left."""
        return self.direction_rad(self.count - 1)

    def direction_rad(self, index: int) -> float:
        """Return a direction, counter-clockwise from the scanner's front."""
        return self.first_rad + index * self.step_rad

    def nearest(self, direction_rad: float) -> int | None:
        """Return the index of the nearest direction; None if it lies outside."""
        index = round((direction_rad - self.first_rad) / self.step_rad)
        return index if 0 <= index < self.count else None


@dataclass(slots=True)
class Gaze:
    """One for each robot."""

    fan: Fan | None = None
    """What can be looked at; None until a scanner said so."""
    index: int = 0
    """Which direction of the fan is looked at."""
