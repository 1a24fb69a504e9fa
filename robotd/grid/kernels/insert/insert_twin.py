"""A sweep into the occupancy grid, in NumPy: the twin of the kernel in C."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.ray import ray_cells
from robotd.grid.tables import NO_INFORMATION, UpdateTable


def insert_sweep(
    cells: NDArray[np.uint8],
    readings: NDArray[np.float64],
    map_from_robot: Pose2,
    spec: GridSpec,
    tables: tuple[UpdateTable, UpdateTable],
    *,
    at_once: bool,
    between: NDArray[np.float64] | None = None,
) -> NDArray[np.intp]:
    """See :class:`.InsertKernel`."""
    rays, (lower, higher), before = _Rays.of(readings, map_from_robot, spec), tables, cells.copy()
    passed_rays, passed = ray_cells(rays.starts, rays.bearings_rad, rays.lengths_cells, spec.shape)
    flat = cells.reshape(-1)
    if at_once:
        # A hit beats the misses of its sweep: one grazing neighbour would otherwise erase a wall that was just met.
        hit = np.unique(rays.hits[rays.hits >= 0])
        vacant = np.setdiff1d(passed, hit)
        flat[vacant] = lower[flat[vacant]]
        flat[hit] = higher[flat[hit]]
    else:
        # As in the paper, reading by reading: a later beam may take back what an earlier one raised.
        bounds = np.searchsorted(passed_rays, np.arange(len(rays.hits) + 1))
        for ray, hit in enumerate(rays.hits):
            vacant = passed[bounds[ray] : bounds[ray + 1]]
            # A ray's last cell may be the one that it ended in.
            vacant = vacant[vacant != hit]
            flat[vacant] = lower[flat[vacant]]
            if hit >= 0:
                flat[hit] = higher[flat[hit]]
    if between is not None:
        rays = _Rays.of(between, map_from_robot, spec)
        _, passed = ray_cells(rays.starts, rays.bearings_rad, rays.lengths_cells, spec.shape)
        # After the readings: what a beam has crossed is no longer unseen.
        flat[passed[flat[passed] == NO_INFORMATION]] = lower[NO_INFORMATION]
    return np.flatnonzero(cells != before)


@dataclass(frozen=True, slots=True, eq=False)
class _Rays:
    """Beams on the grid; positions and lengths in cells, as in :mod:`robotd.grid.ray`."""

    starts: NDArray[np.float64]
    """``float64[n, 2]``, ``(row, col)``, inside the grid or not."""
    bearings_rad: NDArray[np.float64]
    lengths_cells: NDArray[np.float64]
    hits: NDArray[np.intp]
    """``intp[n]``: flat index of the cell in which each ended, -1 if it met nothing or ended outside the grid."""

    @classmethod
    def of(cls, readings: NDArray[np.float64], map_from_robot: Pose2, spec: GridSpec) -> "_Rays":
        bearing_rad, range_m, x_m, y_m, is_miss = np.ascontiguousarray(readings.T)
        cos, sin = math.cos(map_from_robot.heading_rad), math.sin(map_from_robot.heading_rad)
        origins_m = np.stack(
            (map_from_robot.x_m + cos * x_m - sin * y_m, map_from_robot.y_m + sin * x_m + cos * y_m), axis=1
        )
        bearings_rad = map_from_robot.heading_rad + bearing_rad
        ends_m = origins_m + range_m[:, None] * np.stack((np.cos(bearings_rad), np.sin(bearings_rad)), axis=1)
        hits = np.where(is_miss > 0.0, -1, spec.flat_at(ends_m))
        return cls(spec.positions_at(origins_m), bearings_rad, range_m / spec.resolution_m, hits)
