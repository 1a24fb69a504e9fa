"""Size of a new map, and how readings change it ([BrownDonald2000]_ sec. 1, 3.2)."""

import enum
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from robotd.core.bounds import Within, refuse_outside
from robotd.core.grid_spec import MAX_SIDE_CELLS, GridSpec


class UpdatePolicy(enum.StrEnum):
    """How the readings of one sweep are put together."""

    PER_READING = "per_reading"
    """One after the other, exactly as in the paper: the last beam through a cell has the last word."""
    PER_SWEEP = "per_sweep"
    """Each cell is updated at most once, and a hit beats all misses."""


class OverRange(enum.StrEnum):
    """What a beam says that met nothing up to the cut-off."""

    CLEAR = "clear"
    """The cells up to the cut-off are vacant."""
    DISCARD = "discard"
    """Nothing, as in the paper's own runs."""


class BetweenBeams(enum.StrEnum):
    """What two beams of a stop that lie side by side say of the ground between them."""

    SEEN = "seen"
    """It is vacant up to where the nearer one ends, where nothing else is known of it (:mod:`robotd.grid.between`)."""
    UNSEEN = "unseen"
    """Nothing, as in the paper."""


@dataclass(frozen=True, slots=True)
class GridSettings:
    """Size of a new map and how readings change it; the defaults are LILY's, but for the two policies."""

    resolution_m: Annotated[float, Within(0.005, 2.0, "m")] = 0.05
    """Side of one cell."""
    rows: Annotated[int, Within(1, MAX_SIDE_CELLS, "cells")] = 256
    """Cells along map y."""
    cols: Annotated[int, Within(1, MAX_SIDE_CELLS, "cells")] = 256
    """Cells along map x."""
    raise_alpha: Annotated[float, Within(0.0, 0.99, "of 1")] = 0.3
    """Share of the doubt that a hit leaves."""
    lower_alpha: Annotated[float, Within(0.0, 0.99, "of 1")] = 0.15
    """Share of the probability of an obstacle that a miss leaves."""
    policy: UpdatePolicy = UpdatePolicy.PER_SWEEP
    """How the readings of one sweep are put together. On two real buildings the paper's policy freed 8 and 17 % of the
    cells that the very sweep had hit, by neighbouring beams that graze them; both localized equally well."""
    over_range: OverRange = OverRange.CLEAR
    """What becomes of readings beyond the cut-off."""
    between_beams: BetweenBeams = BetweenBeams.SEEN
    """What two beams side by side say of the ground between them."""

    def __post_init__(self) -> None:
        """Refuse impossible values."""
        refuse_outside(self)

    def spec_covering(self, points_m: Sequence[tuple[float, float]], margin_m: float) -> GridSpec:
        """Return the placement of a grid with map-frame points round its middle.

        It has at least this size, and is larger where that does not leave ``margin_m`` round every point.

        Raises:
            ValueError: that would be more than ``MAX_SIDE_CELLS`` along a side.
        """
        xs_m, ys_m = zip(*points_m, strict=True)
        cols = max(self.cols, math.ceil((max(xs_m) - min(xs_m) + 2 * margin_m) / self.resolution_m))
        rows = max(self.rows, math.ceil((max(ys_m) - min(ys_m) + 2 * margin_m) / self.resolution_m))
        if max(rows, cols) > MAX_SIDE_CELLS:
            raise ValueError(f"a map of {rows} x {cols} cells is too large; at most {MAX_SIDE_CELLS} along a side")
        # Round their middle: whatever the map has in excess is then the same to all sides.
        origin_x_m = (min(xs_m) + max(xs_m)) / 2 - cols * self.resolution_m / 2
        origin_y_m = (min(ys_m) + max(ys_m)) / 2 - rows * self.resolution_m / 2
        return GridSpec(self.resolution_m, origin_x_m, origin_y_m, (rows, cols))
