"""Fans: all beams of one direction that error bounds allow, as windows of cells on successive lines of the grid.

A beam starts near the centre of the robot's cell and runs near its direction. Seen where it crosses the centre lines of
the columns (of the rows, if its direction is nearer to them), it is met in one cell of each line; all beams of a fan
are met in a window of cells, and from line to line no beam steps farther sideways than the fan is steep. What this
proves is told in :mod:`.conservative_poses`. Lengths and positions are in cells, as ``(row, col)``.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

SLACK_CELLS = 1e-4
"""What everything is widened by: more than floating point errs and what directions and starts are rounded by."""
DIRECTIONS = 1 << 34
"""Directions are rounded to this share of a turn: 3e-7 cells at 1000 cells."""
STARTS_PER_CELL = 1 << 20
"""Starts are rounded to this share of a cell."""
STARTS_MAX = 1 << 30
"""A thousand cells: no robot is as large as that."""
WINDOW_CELLS_MAX = 32
"""Where a fan gets wider than this, it ends: a shorter one blocks fewer poses, which never excludes the true one."""
SPREAD_CELLS = 0.5
"""How far a start may lie from the centre of the cell, along either axis."""


@dataclass(frozen=True, slots=True, eq=False)
class Fans:
    """Fans, each as far as it was drawn."""

    lines: NDArray[np.int32]
    """``int32[fans, 7]``: the axis across the lines (0: they are rows, 1: columns), the way it is run along (1 or -1),
    the offset of the first line from the robot's own that way, the least and the greatest step aside from line to
    line, the number of the first window, and 1 if the beams start in the robot's own cell, else 0."""
    windows: NDArray[np.int32]
    """``int32[n, 2]``: first and last offset aside of the cells that may be met, line after line, fan after fan."""
    ways: NDArray[np.float64]
    """``float64[fans, 2]``, ``(start, per_line)``: no beam crosses line ``k`` later than ``(k - start) * per_line``."""

    def lines_crossed(self, fan: NDArray[np.intp], lengths_cells: NDArray[np.float64]) -> NDArray[np.int32]:
        """Return how many lines all beams of some fans have crossed before they are so long, ``int32[n]``."""
        start, per_line = self.ways[fan].T
        drawn = np.diff(self.lines[:, 5], append=len(self.windows))
        # Slack to the side of fewer lines: E may be too small, never too large.
        before = np.ceil(lengths_cells / per_line + start - SLACK_CELLS)
        crossed: NDArray[np.int32] = np.clip(before - self.lines[fan, 2], 0.0, drawn[fan]).astype(np.int32)
        return crossed


def direction_keys(bearings_rad: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return rounded directions, ``int64[n]``: what is equal shares a fan."""
    keys: NDArray[np.int64] = np.rint(bearings_rad * (DIRECTIONS / math.tau)).astype(np.int64) % DIRECTIONS
    return keys


def start_keys(starts_cells: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return rounded starts ``(row, col)``, ``int64[n, 2]``: what is equal shares a fan.

    Raises:
        ValueError: a start is more than a thousand cells from the robot's axis.
    """
    keys = np.rint(starts_cells * STARTS_PER_CELL)
    if keys.size and not np.abs(keys).max() <= STARTS_MAX:
        raise ValueError("a beam starts more than a thousand cells from the axis of the robot")
    return keys.astype(np.int64)


def draw_fans(directions: NDArray[np.int64], starts: NDArray[np.int64], turn_rad: float, line_count: int) -> Fans:
    """Draw the fans of beams of a robot anywhere in a cell, turned about its axis by no more than ``turn_rad``.

    Args:
        directions: ``int64[n]``, :func:`direction_keys` of the beams that are not turned.
        starts: ``int64[n, 2]``, :func:`start_keys` of their starts, seen from the axis.
        turn_rad: less than 45 degrees, so that no fan runs along the lines.
        line_count: how many lines to draw.
    """
    bearings_rad, starts_cells = directions * (math.tau / DIRECTIONS), starts / STARTS_PER_CELL
    which = np.arange(len(bearings_rad))
    ahead = np.stack((np.sin(bearings_rad), np.cos(bearings_rad)), axis=1)
    # Across the lines that the fan is nearest to cross at a right angle: there its windows are the narrowest.
    axis = np.abs(ahead).argmax(axis=1)
    forward = np.where(ahead[which, axis] > 0.0, 1.0, -1.0)
    along, aside = starts_cells[which, axis] * forward, starts_cells[which, 1 - axis]
    # Turning about the axis carries a start along a chord: that is added to its place in the cell.
    spread = SPREAD_CELLS + SLACK_CELLS + 2.0 * math.sin(turn_rad / 2.0) * np.hypot(*starts_cells.T)
    angles = np.arctan2(ahead[which, 1 - axis], np.abs(ahead[which, axis]))
    least, greatest = np.tan(angles - turn_rad), np.tan(angles + turn_rad)
    # The first line ahead of every start: lines before it are crossed by some of the beams only.
    first = np.ceil(along + spread)
    lines = first[:, None] + np.arange(line_count)
    ways = np.stack((lines - (along + spread)[:, None], lines - (along - spread)[:, None]))
    # A slope may have either sign, so which end of the way is the extreme one has to be tried.
    low = (aside - spread)[:, None] + (ways * least[:, None]).min(axis=0)
    high = (aside + spread)[:, None] + (ways * greatest[:, None]).max(axis=0)
    windows = np.floor(np.stack((low, high), axis=2) + 0.5)
    # Up to the first that is too wide: a path needs every line, so what comes after that is of no use.
    narrow = np.logical_and.accumulate(windows[:, :, 1] - windows[:, :, 0] < WINDOW_CELLS_MAX, axis=1)
    drawn = narrow.sum(axis=1)
    steps = np.floor(least - SLACK_CELLS), np.ceil(greatest + SLACK_CELLS)
    at_home = ~starts.any(axis=1)
    per_line = 1.0 / np.cos(np.abs(angles) + turn_rad)
    return Fans(
        np.column_stack((axis, forward, first, *steps, np.cumsum(drawn) - drawn, at_home)).astype(np.int32),
        np.ascontiguousarray(windows[narrow], np.int32),
        np.column_stack((along - spread, per_line)),
    )


@dataclass(frozen=True, slots=True, eq=False)
class FanBeams:
    """Readings at headings, listed by the fans that they are beams of."""

    fans: Fans
    lists: NDArray[np.int32]
    """``int32[fans + 1]``: first beam of each fan, and the end of the last."""
    beams: NDArray[np.int32]
    """``int32[beams, 5]``: how many lines are crossed, ascending within a fan; number of the heading; number of the
    grown map, -1 for a miss; ``(row, col)`` of the head."""

    @classmethod
    def of(cls, fans: Fans, fan: NDArray[np.intp], beams: NDArray[np.int32]) -> "FanBeams":
        """List beams in any order; ``fan`` says which fan each belongs to."""
        # Ascending within a fan: the kernel walks its lines once, and each beam leaves where it ends.
        order = np.lexsort((beams[:, 0], fan))
        lists = np.searchsorted(fan[order], np.arange(len(fans.lines) + 1)).astype(np.int32)
        return cls(fans, lists, np.ascontiguousarray(beams[order]))
