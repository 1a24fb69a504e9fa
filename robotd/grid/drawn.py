"""How a reading is drawn on the grid: start, body and head, the one place in Python ([BrownDonald2000]_ sec. 2.3.3).

A robot stands with its axis at the centre of a cell. Seen from there, at some heading:

- the beam **starts** in the cell in which its start lies: the start is rounded, so that all beams of one direction
  share one chain of cells, whatever the heading;
- its **body** is the chain of a ray (:mod:`robotd.grid.ray`) from the centre of that cell, as long as the reading less
  the error radius, which shortens misses too, whose cut-off is as uncertain as any range. It has one cell at least;
  where it starts elsewhere, the robot's own cell is in it too;
- its **head** is the cell in which the whole vector ends, rounded once. A miss has none.

The same in C: ``kernels/draw/reading_on_grid.h``.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.grid.ray import ray_steps
from robotd.grid.readings import Readings

FAR_CELLS = 1 << 28
"""Heads that are farther away count as being so far."""


@dataclass(frozen=True, slots=True, eq=False)
class Drawn:
    """Readings at headings, beam by beam: reading after reading, for each all headings; in cells, as ``(row, col)``."""

    bearings_rad: NDArray[np.float64]
    """``float64[n]``, map frame."""
    starts: NDArray[np.float64]
    """``float64[n, 2]``: where each starts, seen from the robot's axis, before it is rounded."""
    ahead: NDArray[np.float64]
    """``float64[n, 2]``: the way each goes, of length 1."""
    range_cells: NDArray[np.float64]
    """``float64[n]``."""
    is_miss: NDArray[np.bool_]
    """``bool[n]``."""

    @classmethod
    def of(cls, readings: Readings, headings: NDArray[np.float64], resolution_m: float) -> "Drawn":
        """Draw readings.

        Args:
            readings: hits and misses.
            headings: ``float64[3, headings]``: angle [rad, map frame], sine and cosine, as
                :func:`~robotd.grid.kernels.draw.draw_kernel.turned` returns them.
            resolution_m: side of one cell.
        """
        bearing_rad, range_m, x_m, y_m, is_miss = readings.rows.T[:, :, None]
        (headings_rad, sin, cos), one = headings, np.ones(headings.shape[1])
        rows, cols = (sin * x_m + cos * y_m) / resolution_m, (cos * x_m - sin * y_m) / resolution_m
        bearings_rad = (bearing_rad + headings_rad).ravel()
        ahead = np.stack((np.sin(bearings_rad), np.cos(bearings_rad)), axis=1)
        starts = np.stack((rows.ravel(), cols.ravel()), axis=1)
        range_cells = (range_m / resolution_m * one).ravel()
        return cls(bearings_rad, starts, ahead, range_cells, (is_miss * one).ravel() > 0.0)

    @property
    def start_cells(self) -> NDArray[np.int64]:
        """In which cell each starts, ``int64[n, 2]``."""
        return _nearest(self.starts)

    @property
    def steps(self) -> NDArray[np.float64]:
        """From one cell of the body to the next, before they are rounded, ``float64[n, 2]``."""
        return ray_steps(self.bearings_rad)

    @property
    def head_cells(self) -> NDArray[np.int64]:
        """In which cell each ends, ``int64[n, 2]``; of a miss it means nothing."""
        # From the start as it is, not from its cell: rounding twice would put heads a cell off.
        return _nearest(self.starts + self.range_cells[:, None] * self.ahead)

    def body_lengths(self, error_radius_cells: float | NDArray[np.float64], reach_cells: float) -> NDArray[np.int64]:
        """Return how many cells each body has from its start on, ``int64[n]``.

        Args:
            error_radius_cells: by how much bodies are shorter than readings, all or each ``float64[n]``.
            reach_cells: where they end at the latest; more than the grid is wide and high changes nothing.
        """
        # Not below nothing: a reading nearer than the error radius is of something that may be anywhere round
        # the robot.
        free_cells = np.clip(self.range_cells - error_radius_cells, 0.0, reach_cells)
        lengths = np.ceil(free_cells * np.abs(self.ahead).max(axis=1))
        at_least_one: NDArray[np.int64] = np.maximum(lengths, 1.0).astype(np.int64)
        return at_least_one

    def bodies(self, lengths: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.intp]]:
        """Return the cells of all bodies, body after body, ``int64[cells, 2]``, and whose each is, ``intp[cells]``.

        Args:
            lengths: of each, from its start on; the robot's own cell is not added where it starts elsewhere.
        """
        beam = np.repeat(np.arange(len(lengths)), lengths)
        k = np.arange(len(beam)) - np.repeat(np.cumsum(lengths) - lengths, lengths)
        return self.start_cells[beam] + np.floor(0.5 + k[:, None] * self.steps[beam]).astype(np.int64), beam


def _nearest(cells: NDArray[np.float64]) -> NDArray[np.int64]:
    # Clipped before the cast, which is undefined beyond 64 bits. Not `rint`: it takes halves to the even cell.
    nearest: NDArray[np.int64] = np.floor(np.clip(cells, -FAR_CELLS, FAR_CELLS) + 0.5).astype(np.int64)
    return nearest
