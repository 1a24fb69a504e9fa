"""How far it is from everywhere to the goal, round the obstacles: a flood fill.

[BrownDonald2000]_ sec. 2.3.2, fig. 15. Cells are joined to their eight neighbours, by 1 along the sides and sqrt 2
across the corners, so contours are regular octagons. Once the field is there, a way is its descent, and where there is
none the field is infinite.
"""

import math

import numpy as np
from numpy.typing import NDArray

NEIGHBOURS = tuple((row, col) for row in (-1, 0, 1) for col in (-1, 0, 1) if (row, col) != (0, 0))
STEP_CELLS = tuple(math.hypot(row, col) for row, col in NEIGHBOURS)


def distance_field(free: NDArray[np.bool_], goal: tuple[int, int]) -> NDArray[np.float64]:
    """Return the length of the shortest way through free cells to the goal, in cells, ``float64[rows, cols]``.

    Obstacles, and cells from which the goal cannot be reached, are ``inf``; so is everything if the goal is not free.

    Dijkstra's algorithm in whole wavefronts: the shortest step is 1, so all cells less than 1 farther than the nearest
    unsettled one are final together. O(cells) work in as many array steps as the longest way is cells long.
    """
    rows, cols = free.shape
    width = cols + 2
    # A rim of obstacles: steps in the flattened grid cannot run over into the next row.
    passable = np.pad(free, 1).reshape(-1)
    distance = np.full(passable.shape, np.inf)
    steps = np.array([row * width + col for row, col in NEIGHBOURS])
    front = np.array([(goal[0] + 1) * width + goal[1] + 1])
    if not passable[front[0]]:
        return np.full(free.shape, np.inf)
    distance[front] = 0.0
    ring, beyond = 0, np.empty(0, np.intp)
    while front.size or beyond.size:
        # A whole ring in one array step: a heap would settle cells one by one, in Python.
        reached = _relax(distance, passable, front, steps)
        ring += 1
        # A step is shorter than 2, so what was reached lies in the next ring or the one after it.
        candidates = np.concatenate((beyond, reached))
        in_next = distance[candidates] < ring + 1
        front, beyond = np.unique(candidates[in_next]), candidates[~in_next]
        # What lay beyond may have been reached by a shorter way since, and was settled in that ring.
        front = front[distance[front] >= ring]
    return distance.reshape(rows + 2, width)[1:-1, 1:-1].copy()


def _relax(
    distance: NDArray[np.float64], passable: NDArray[np.bool_], front: NDArray[np.intp], steps: NDArray[np.intp]
) -> NDArray[np.intp]:
    """Shorten the ways of the front's neighbours in place; return those that became shorter, some perhaps twice."""
    cells: NDArray[np.intp] = (front[:, None] + steps).reshape(-1)
    ways = (distance[front][:, None] + np.array(STEP_CELLS)).reshape(-1)
    shorter = passable[cells] & (ways < distance[cells])
    improved: NDArray[np.intp] = cells[shorter]
    # Several cells of the front reach the same one: plain assignment would keep the last way, not the shortest.
    np.minimum.at(distance, improved, ways[shorter])
    return improved
