"""How far an obstacle may lie from the head of a reading: the farther the head, the farther off an angle puts it.

The paper's eps ([BrownDonald2000]_ sec. 2.2.1) is one length for all readings. An angle that is off by half a degree
is nothing at 2 m and 0.26 m at 30 m. So readings are parted by their range into levels, each with a radius of its own:
D of a level is the map grown by its radius, and since these are nested, a level more costs one map more, however many
readings it has. Bodies end as much before their heads.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_STEP = math.sqrt(2.0)
"""From one level to the next; what is rounded to the nearest is off by no more than a fifth."""
_LEVELS_MAX = 5
"""Up to four times the least radius: where more is needed, headings are too coarse for the reach."""


@dataclass(frozen=True, slots=True)
class ErrorRadii:
    """Error radii in levels, by range; lengths in cells."""

    cells: tuple[float, ...]
    """The radius of each level, ascending."""
    begins: tuple[float, ...] = ()
    """The range from which on each level counts, but the first, which counts from 0: ascending."""

    def __post_init__(self) -> None:
        """Refuse levels that are none."""
        if len(self.cells) != len(self.begins) + 1:
            raise ValueError(f"expected one range less than radii, got {len(self.begins)} and {len(self.cells)}")
        if list(self.cells) != sorted(self.cells) or list(self.begins) != sorted(self.begins):
            raise ValueError(f"expected levels in order, got {self.cells} from {self.begins}")

    @classmethod
    def growing(cls, least_cells: float, angle_rad: float, reach_cells: float) -> "ErrorRadii":
        """Return the levels of ``hypot(least_cells, angle_rad * range)``, up to a reach.

        >>> ErrorRadii.growing(1.5, 0.01, 200.0).cells
        (1.5, 2.121320344)
        """
        cells, begins = [least_cells], []
        while angle_rad > 0.0 and least_cells > 0.0 and len(cells) < _LEVELS_MAX:
            radius = cells[0] * _STEP ** len(cells)
            # Half way between two levels, by their ratio, begins the upper one.
            begin = math.sqrt(radius * radius / _STEP - cells[0] * cells[0]) / angle_rad
            if begin > reach_cells:
                break
            # Rounded, as roots differ in the last place between machines, and a radius decides which cells a
            # disk holds.
            cells.append(round(radius, 9))
            begins.append(begin)
        return cls(tuple(cells), tuple(begins))

    def levels(self, range_cells: NDArray[np.float64]) -> NDArray[np.intp]:
        """Return the level of each range."""
        return np.searchsorted(self.begins, range_cells, side="right")

    @property
    def widest(self) -> float:
        """By how much a head that counts on the last level may lie off, if there can be no level more."""
        return math.sqrt(max(0.0, self.cells[0] ** 2 * _STEP ** (2 * _LEVELS_MAX - 1) - self.cells[0] ** 2))

    @property
    def greatest(self) -> float:
        """The radius of the last level."""
        return self.cells[-1]
