"""The statistical occupancy grid: what the beams of all stops say about each cell ([BrownDonald2000]_ sec. 1, 3.2)."""

import enum
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from robotd.core.bounds import Within, refuse_outside
from robotd.core.grid_bytes import grid_digest
from robotd.core.grid_spec import MAX_SIDE_CELLS, GridSpec
from robotd.core.map_stop import MapStop
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid import kernels
from robotd.grid.between import between
from robotd.grid.readings import Readings
from robotd.grid.tables import NO_INFORMATION, lower_table, raise_table

_AS_IT_IS = np.arange(256, dtype=np.uint8)


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
        low_m, high_m = np.min(points_m, axis=0), np.max(points_m, axis=0)
        needed = np.ceil((high_m - low_m + 2 * margin_m) / self.resolution_m).astype(int)
        cols, rows = np.maximum(needed, (self.cols, self.rows)).tolist()
        if max(rows, cols) > MAX_SIDE_CELLS:
            raise ValueError(f"a map of {rows} x {cols} cells is too large; at most {MAX_SIDE_CELLS} along a side")
        origin_m = (low_m + high_m) / 2 - np.array([cols, rows]) * self.resolution_m / 2
        return GridSpec(self.resolution_m, float(origin_m[0]), float(origin_m[1]), (rows, cols))


class OccupancyGrid:
    """8-bit cells, 0 surely vacant to 255 surely occupied, and the two tables that change them."""

    def __init__(
        self, spec: GridSpec, cells: NDArray[np.uint8] | None = None, settings: GridSettings | None = None
    ) -> None:
        """Start from nothing known, or from the cells of a stored map ``uint8[rows, cols]`` (copied).

        ``spec`` has the last word on size and resolution; ``settings`` on tables and policies.
        """
        if cells is not None and (cells.shape != spec.shape or cells.dtype != np.uint8):
            raise ValueError(f"expected uint8{list(spec.shape)}, got {cells.dtype}{list(cells.shape)}")
        self.spec = spec
        self.settings = settings or GridSettings()
        self.cells: NDArray[np.uint8] = (
            np.full(spec.shape, NO_INFORMATION, np.uint8) if cells is None else np.array(cells, np.uint8, order="C")
        )
        self._raise = raise_table(self.settings.raise_alpha)
        self._lower = lower_table(self.settings.lower_alpha)
        self._presume = np.arange(256, dtype=np.uint8)
        """What becomes of a cell between two beams: something where nothing was known, else nothing."""
        self._presume[NO_INFORMATION] = self._lower[NO_INFORMATION]

    def insert(self, sweep: Sweep, map_from_robot: Pose2) -> NDArray[np.intp]:
        """Update the cells by the readings of a stop; what lies outside the grid is ignored.

        Args:
            sweep: the readings, in the robot frame.
            map_from_robot: where the robot stood.

        Returns:
            Flat indices ``row * cols + col`` of the cells whose value changed, ascending. O(readings x cells a beam).
        """
        return self._insert(Readings.of(self.usable(sweep)), map_from_robot)

    def lay_in(self, stop: MapStop) -> NDArray[np.intp]:
        """Update the cells by a stop as :meth:`insert` does by its sweep, without making that of it."""
        beams = stop.beams(misses=self.settings.over_range is OverRange.CLEAR)
        return self._insert(Readings(beams), stop.map_from_robot)

    def _insert(self, readings: Readings, map_from_robot: Pose2) -> NDArray[np.intp]:
        tables, at_once = (self._lower, self._raise), self.settings.policy is UpdatePolicy.PER_SWEEP
        insert_sweep = kernels.in_use().insert.insert_sweep
        changed = insert_sweep(self.cells, readings.rows, map_from_robot, self.spec, tables, at_once=at_once)
        if self.settings.between_beams is BetweenBeams.UNSEEN:
            return changed
        tables, filled = (self._presume, _AS_IT_IS), between(readings, self.spec.resolution_m)
        presumed = insert_sweep(self.cells, filled.rows, map_from_robot, self.spec, tables, at_once=True)
        # No cell is in both: what a beam crossed is no longer unseen. Two runs in order are what this sort is best at.
        return np.sort(np.concatenate((changed, presumed)), kind="stable")

    def digest(self) -> str:
        """Return the SHA-256 of placement and cells, in hexadecimal: equal exactly if the maps are."""
        return grid_digest(self.spec, self.cells)

    def usable(self, sweep: Sweep) -> tuple[RangeReading, ...]:
        """Return the readings of a sweep that change this grid."""
        if self.settings.over_range is OverRange.CLEAR:
            return sweep.measured
        return tuple(reading for reading in sweep.measured if reading.status is ReadingStatus.OK)
