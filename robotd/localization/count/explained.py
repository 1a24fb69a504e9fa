"""Which of the readings does one pose explain? FP_eps asked at a single pose, for all readings at once.

The same answer as :func:`.feasible_poses` gives there, without the other poses.
"""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.ray import ray_steps, sample_counts
from robotd.grid.readings import Readings
from robotd.localization.obstacles.prepared_map import PreparedMap


def explained_at(
    the_map: PreparedMap, readings: Readings, cell: tuple[int, int], heading_rad: float
) -> NDArray[np.bool_]:
    """Return for each reading whether it is feasible at a pose, ``bool[n]``.

    Args:
        the_map: the map.
        readings: hits and misses.
        cell: ``(row, col)`` of the robot, in the grid.
        heading_rad: of the robot, in the map frame.

    O(cells of all bodies).
    """
    obstacles = the_map.obstacles
    if not obstacles.free[cell]:
        return np.zeros(len(readings), np.bool_)
    x_m, y_m = readings.start_x_m, readings.start_y_m
    cos, sin = np.cos(heading_rad), np.sin(heading_rad)
    at = np.stack((sin * x_m + cos * y_m, cos * x_m - sin * y_m), axis=1) / the_map.spec.resolution_m
    bearings_rad = heading_rad + readings.bearing_rad
    range_cells = readings.range_m / the_map.spec.resolution_m
    starts = np.array(cell) + _nearest(at)
    free_cells = np.minimum(range_cells - the_map.error_radius_cells, 2 * max(the_map.spec.shape))
    met = _met(obstacles.blocking, starts, bearings_rad, free_cells, outside=obstacles.outside_blocks)
    ahead = np.stack((np.sin(bearings_rad), np.cos(bearings_rad)), axis=1)
    heads = np.array(cell) + _nearest(at + range_cells[:, None] * ahead)
    ends = _look_up(obstacles.grown, heads, outside=obstacles.outside_ends) | readings.is_miss
    explained: NDArray[np.bool_] = ends & (met < obstacles.blocked_by)
    return explained


def _met(
    blocking: NDArray[np.bool_],
    starts: NDArray[np.intp],
    bearings_rad: NDArray[np.float64],
    lengths_cells: NDArray[np.float64],
    *,
    outside: bool,
) -> NDArray[np.intp]:
    """Return how many blocking cells each body meets, ``intp[n]``."""
    counts = np.maximum(sample_counts(bearings_rad, lengths_cells), 1.0).astype(np.intp)
    ray = np.repeat(np.arange(len(counts)), counts)
    sample = np.arange(len(ray)) - np.repeat(np.cumsum(counts) - counts, counts)
    cells = starts[ray] + np.floor(0.5 + sample[:, None] * ray_steps(bearings_rad)[ray]).astype(np.intp)
    return np.bincount(ray[_look_up(blocking, cells, outside=outside)], minlength=len(counts))


def _look_up(mask: NDArray[np.bool_], cells: NDArray[np.intp], *, outside: bool) -> NDArray[np.bool_]:
    """Return the mask at cells ``intp[n, 2]``, in the grid or not, ``bool[n]``."""
    inside = ((cells >= 0) & (cells < mask.shape)).all(axis=1)
    found = np.full(len(cells), outside)
    found[inside] = mask[tuple(cells[inside].T)]
    return found


def _nearest(cells: NDArray[np.float64]) -> NDArray[np.intp]:
    return np.floor(cells + 0.5).astype(np.intp)
