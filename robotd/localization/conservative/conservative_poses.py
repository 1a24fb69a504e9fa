"""Feasible poses that never lose the true one: D widened and E shrunk as far as a proof needs.

[BrownDonald2000]_ sec. 2.2.1 asks for an obstacle within eps of the head of a reading and none before it. On a grid
that loses the true cell now and then: the robot is not at the centre of its cell, its heading is not the slice's,
heads are rounded to cells, and beams graze cells that their pixels do not. Here all of this is bounded.

**Promised.** Let obstacles be the closed squares of the map's occupied cells and all that lies outside the grid. Let
the axis of the robot be anywhere in a free cell ``p``; its heading within ``heading_error_rad`` of a slice ``theta``
(half a slice, where slices go all round); every range wrong by at most ``range_error_m`` (eps); a miss mean that the
way to the first obstacle is no shorter than the cut-off less eps. Then no reading excludes ``(p, theta)``: its rank
is m, the number of readings. If k readings break their bounds, it is at least m - k.

**Proof**, in cells. The axis is at ``c_p + u`` with u in ``Q = [-1/2, 1/2]^2``, the heading ``theta + delta`` with
``|delta| <= h``. Seen from the axis at the slice's heading, the beam starts at ``s``, runs in direction ``d``, and
its head is ``v = s + rho d``; ``rho`` was measured, ``rho*`` is true. ``R`` turns by delta.

*D.* The beam ends at ``e = c_p + u + R (s + rho* d)``, on an obstacle cell ``w``: ``c_w - e`` is in Q. The cell of
the head is ``q = p + round(v)``: ``c_p + v - c_q`` is in Q. Turning v moves it by ``2 sin(h/2) |v|`` at most, and
``rho* d`` is within eps of ``rho d``. So ``c_w - c_q`` is in ``3 Q + B_r``, a square with round corners, ``r = eps +
2 sin(h/2) |v|``: D is the map grown by it. As ``|v|`` does not depend on the heading, a reading has one r, rounded up
to quarter cells, and readings of one r share one grown map.

*E.* Take the *fan* of ``(p, theta)``: all beams from ``c_p + u + R s`` in direction ``R d``, for all u and delta.
Look at it on the centre lines of the grid's columns (rows, if d is nearer to them), from the first line ahead of all
its starts to the last that all its beams cross before they are ``rho - eps`` long. The true beam crosses each of
these lines in a free cell, for it meets no obstacle before ``rho* >= rho - eps``; that cell is in the *window* of
cells of the line that the fan meets; it lies no farther beside the one before than the fan is steep; and if it
does lie beside it, the beam left that one by its side or by its front, so that one of these two neighbours is free. So
there is a path of free cells through the windows, one on each line, by such steps; if beams start at the axis, it
begins at p. E are the cells from which there is none: a wall, however thin, even one of cells that touch at corners,
cuts the whole fan. The true cell is not one of them.

All is widened by a ten-thousandth of a cell, more than floating point errs and directions and starts are rounded by.

**Three-valued maps.** Whether a cell that was never seen is an obstacle is not known: it may end beams, and blocks
none. The promise holds if the cells that were seen are right and the robot stands in one that was seen vacant.

How large the regions are: docs/decisions/0012-conservative.md.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.drawn import Drawn
from robotd.grid.fans import SLACK_CELLS, direction_keys, draw_fans, start_keys
from robotd.grid.footprints import dilate
from robotd.grid.kernels.draw.draw_kernel import turned
from robotd.grid.readings import Readings
from robotd.grid.ternary import TernaryMap
from robotd.grid.translation import translated

_HEADING_ERROR_MAX_RAD = math.pi / 8
"""Half of a step of 45 degrees: well below the 45 degrees at which a fan would run along its lines."""
_RADIUS_STEPS_PER_CELL = 4
"""Radii are rounded up to such steps, so that readings of different lengths share grown maps."""


@dataclass(frozen=True, slots=True)
class ErrorBounds:
    """How wrong readings and headings may be."""

    range_error_m: float
    """Of every range, and of the cut-off."""
    heading_error_rad: float
    """Of the headings that are tried: half the step between them."""

    def __post_init__(self) -> None:
        """Refuse impossible values."""
        # Not `< 0.0`: NaN has to be refused, too.
        if not self.range_error_m >= 0.0:
            raise ValueError(f"range_error_m must not be negative, got {self.range_error_m}")
        if not 0.0 <= self.heading_error_rad <= _HEADING_ERROR_MAX_RAD:
            raise ValueError(f"heading_error_rad must lie in [0, pi / 8], got {self.heading_error_rad}")


@dataclass(frozen=True, slots=True, eq=False)
class SureObstacles:
    """What is sure of a map, and what is not."""

    standing: NDArray[np.bool_]
    """``bool[rows, cols]``: the robot may be there."""
    blocking: NDArray[np.bool_]
    """``bool[rows, cols]``: surely an obstacle."""
    ending: NDArray[np.bool_]
    """``bool[rows, cols]``: perhaps an obstacle."""
    outside_blocks: bool = True
    """Whether what lies outside the grid is surely an obstacle; perhaps it is one in any case."""

    @classmethod
    def of(cls, occupied: NDArray[np.bool_]) -> "SureObstacles":
        """Take every cell, and what lies outside, for what the map says."""
        return cls(~occupied, occupied, occupied)

    @classmethod
    def of_map(cls, ternary: TernaryMap) -> "SureObstacles":
        """Take only cells that were seen for what the map says."""
        # Unseen cells may end beams and block none: only so is nothing excluded by what was never seen.
        return cls(ternary.vacant, ternary.occupied, ~ternary.vacant, outside_blocks=False)


def conservative_poses(
    obstacles: SureObstacles, reading: RangeReading, heading_rad: float, resolution_m: float, bounds: ErrorBounds
) -> NDArray[np.bool_]:
    """Return the cells that may hold the robot at this slice, ``bool[rows, cols]``; the reference, O(n^2 r^2).

    Args:
        obstacles: what is certain of the map.
        reading: a hit or a miss.
        heading_rad: the slice, in the map frame.
        resolution_m: side of one cell.
        bounds: how wrong the reading and the heading may be.

    Raises:
        ValueError: the reading measured nothing.
    """
    drawn = Drawn.of(Readings.of((reading,)), turned(np.array([heading_rad])), resolution_m)
    error_cells = bounds.range_error_m / resolution_m
    possible = obstacles.standing & _passable(obstacles, drawn, error_cells, bounds)
    if reading.status is ReadingStatus.MISS:
        return possible
    head = drawn.starts[0] + drawn.range_cells[0] * drawn.ahead[0]
    steps = head_radius_steps(np.hypot(*head), error_cells, bounds.heading_error_rad)
    row, col = drawn.head_cells[0].tolist()
    return possible & translated(grown_ending(obstacles, int(steps)), row, col, outside=True)


def _passable(obstacles: SureObstacles, drawn: Drawn, error_cells: float, bounds: ErrorBounds) -> NDArray[np.bool_]:
    """Return from where a path of cells that may be free leads through the windows of the fan."""
    # No beam crosses more lines than the grid has rows and columns together.
    reach = sum(obstacles.blocking.shape)
    directions, starts = direction_keys(drawn.bearings_rad), start_keys(drawn.starts)
    fans = draw_fans(directions, starts, bounds.heading_error_rad, reach)
    axis, forward, first, least, greatest, _, at_home = fans.lines[0].tolist()
    count = int(fans.lines_crossed(np.zeros(1, np.intp), drawn.range_cells - error_cells)[0])

    def open_at(along: int, aside: int) -> NDArray[np.bool_]:
        row, col = (along, aside) if axis == 0 else (aside, along)
        looked: NDArray[np.bool_] = ~translated(obstacles.blocking, row, col, outside=obstacles.outside_blocks)
        return looked

    everywhere = np.ones_like(obstacles.standing)
    paths, line = {0: everywhere}, 0
    for number, (low, high) in enumerate(fans.windows[:count].tolist()):
        before, paths, behind, line = paths, {}, line, forward * (first + number)
        for aside in range(low, high + 1):
            # Starts that lie off the axis may be in any cell of the first line; only a beam from the axis is
            # known to begin at p.
            arriving = everywhere if number == 0 and not at_home else ~everywhere
            for old, path in before.items():
                if number == 0 or least <= aside - old <= greatest:
                    side = old + int(np.sign(aside - old))
                    # Two obstacles that touch at a corner are a wall: no beam slips through between them.
                    leaving = everywhere if side == old else open_at(behind, side) | open_at(line, old)
                    arriving = arriving | (path & leaving)
            paths[aside] = arriving & open_at(line, aside)
    passable: NDArray[np.bool_] = np.logical_or.reduce(list(paths.values()))
    return passable


def head_radius_steps(
    heads_cells: NDArray[np.float64], error_cells: float, heading_error_rad: float
) -> NDArray[np.int64]:
    """Return the radius r of the proof for heads so far from the axis, in quarters of a cell, rounded up."""
    radii = error_cells + 2.0 * math.sin(heading_error_rad / 2.0) * heads_cells + SLACK_CELLS
    # Up, never to the nearest: the promise holds for a radius that is too large, not for one too small.
    steps: NDArray[np.int64] = np.ceil(radii * _RADIUS_STEPS_PER_CELL).astype(np.int64)
    return steps


def grown_ending(obstacles: SureObstacles, radius_steps: int) -> NDArray[np.bool_]:
    """Return what may end a beam, ``bool[rows, cols]``, grown by quarters of a cell and what the proof adds."""
    radius, ending = radius_steps / _RADIUS_STEPS_PER_CELL, obstacles.ending
    # Grown by as many cells as it has, with obstacles all round, a map is full.
    full = radius >= max(ending.shape)
    return np.ones_like(ending) if full else dilate(ending, rounded_square(radius), outside=True)


def rounded_square(radius_cells: float) -> NDArray[np.bool_]:
    """Return the cells whose centre is within ``3 Q + B_r`` of the centre of the middle one.

    >>> rounded_square(0.5).astype(int).tolist()
    [[0, 1, 1, 1, 0], [1, 1, 1, 1, 1], [1, 1, 1, 1, 1], [1, 1, 1, 1, 1], [0, 1, 1, 1, 0]]
    """
    reach = int(radius_cells + 1.5)
    beyond = np.maximum(np.abs(np.arange(-reach, reach + 1)) - 1.5, 0.0)
    footprint: NDArray[np.bool_] = beyond[:, None] ** 2 + beyond**2 <= radius_cells**2
    return footprint
