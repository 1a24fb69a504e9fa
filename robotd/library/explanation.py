"""What a map says to each reading of a sweep, if the robot stands at one pose."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.core.reading import Sweep
from robotd.grid.readings import Readings
from robotd.localization.count.explained import explained_at
from robotd.localization.fit.refinement import expected_ranges
from robotd.localization.ready_map import ReadyMap


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Explanation:
    """Columns as long as the sweep, in its order; what was not measured is not explained."""

    pose: Pose2
    explained: NDArray[np.bool_]
    """``bool[n]``: the paper's feasibility, from the cell that holds the pose."""
    expected_m: NDArray[np.float64]
    """``float64[n]``: how far the beam would go on the map from the pose itself; NaN where nothing was measured."""
    heads_m: NDArray[np.float64]
    """``float64[n, 2]``: where each beam ended, map frame; NaN where nothing was measured."""

    @property
    def share(self) -> float:
        """Share of the measured readings that are explained; 0 of none."""
        measured = int(np.count_nonzero(np.isfinite(self.expected_m)))
        return float(self.explained.sum()) / measured if measured else 0.0

    def __repr__(self) -> str:
        """Say how many are explained."""
        return f"Explanation({self.explained.sum()} of {np.isfinite(self.expected_m).sum()} readings explained)"

    @classmethod
    def of(cls, the_map: ReadyMap, sweep: Sweep, pose: Pose2) -> "Explanation":
        """Ask a map at a pose, on the map or off it. O(readings x cells a beam)."""
        measured = np.array([reading.is_measured for reading in sweep.readings], np.bool_)
        readings, number = Readings.of(sweep.measured), len(sweep.readings)
        explained, expected_m, heads_m = (
            np.zeros(number, np.bool_),
            np.full(number, np.nan),
            np.full((number, 2), np.nan),
        )
        cos, sin = np.cos(pose.heading_rad), np.sin(pose.heading_rad)
        heads_m[measured] = readings.heads_m @ np.array([[cos, sin], [-sin, cos]]) + (pose.x_m, pose.y_m)
        cell = the_map.spec.cell_at(pose.x_m, pose.y_m)
        # Nothing is feasible where the robot cannot be, and beyond the map there are no cells to ask.
        if the_map.spec.contains(*cell):
            explained[measured] = explained_at(the_map.prepared, readings, cell, pose.heading_rad)
        at = np.array([[pose.x_m, pose.y_m, pose.heading_rad]])
        as_drawn = the_map.meanings[0].walls
        expected_m[measured] = expected_ranges(as_drawn, readings, at, the_map.settings.blocked_by).ranges_m[0]
        return cls(pose, explained, expected_m, heads_m)
