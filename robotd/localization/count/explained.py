"""Which of the readings does one pose explain? FP_eps asked at a single pose, for all readings at once.

The same answer as :func:`.feasible_poses` gives there, without the other poses.
"""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.drawn import Drawn
from robotd.grid.kernels.draw.draw_kernel import turned
from robotd.grid.readings import Readings
from robotd.localization.obstacles.levels import Levels
from robotd.localization.obstacles.prepared_map import PreparedMap


def explained_at(levels: Levels, readings: Readings, cell: tuple[int, int], heading_rad: float) -> NDArray[np.bool_]:
    """Return for each reading whether it is feasible at a pose, ``bool[n]``.

    Args:
        levels: the map, for each level of readings.
        readings: hits and misses.
        cell: ``(row, col)`` of the robot, in the grid.
        heading_rad: of the robot, in the map frame.

    O(cells of all bodies).
    """
    explained = np.zeros(len(readings), np.bool_)
    # Only free cells are poses, for counting and search as well: the three have to agree.
    if levels.obstacles.on_map(levels.obstacles.free)[cell]:
        for the_map, which in levels.parted(readings):
            explained[which] = _explained(the_map, readings[which], cell, heading_rad)
    return explained


def _explained(
    the_map: PreparedMap, readings: Readings, cell: tuple[int, int], heading_rad: float
) -> NDArray[np.bool_]:
    """Return for each reading of one level whether it is feasible at a free cell, ``bool[n]``."""
    obstacles = the_map.obstacles
    # Drawn as for the count: another rule of rounding would call a reading unexplained that the rank has in it.
    drawn = Drawn.of(readings, turned(np.array([heading_rad])), the_map.spec.resolution_m)
    body, beam = drawn.bodies(drawn.body_lengths(the_map.error_radius_cells, 2 * max(the_map.spec.shape)))
    at = np.array(cell) + obstacles.rim
    is_met = _look_up(obstacles.blocking, at + body, outside=obstacles.outside_blocks)
    met = np.bincount(beam[is_met], minlength=len(readings))
    ends = _look_up(obstacles.grown, at + drawn.head_cells, outside=obstacles.outside_ends) | drawn.is_miss
    explained: NDArray[np.bool_] = ends & (met < obstacles.blocked_by)
    return explained


def _look_up(mask: NDArray[np.bool_], cells: NDArray[np.intp], *, outside: bool) -> NDArray[np.bool_]:
    """Return the mask at cells ``intp[n, 2]``, in the grid or not, ``bool[n]``."""
    inside = ((cells >= 0) & (cells < mask.shape)).all(axis=1)
    found = np.full(len(cells), outside)
    found[inside] = mask[tuple(cells[inside].T)]
    return found
