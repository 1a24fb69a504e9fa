"""A range reading drawn on the grid: the paper's range vector z, pixelized for one heading.

One reading at one heading, by the rules of :mod:`robotd.grid.drawn`; the kernels draw the same cells, all readings at
all headings at once (:mod:`robotd.grid.kernels.draw.draw_kernel`), and the tests hold them against this.
[BrownDonald2000]_ sec. 2.3.3, fig. 17.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.drawn import Drawn
from robotd.grid.kernels.draw.draw_kernel import turned
from robotd.grid.readings import Readings


@dataclass(frozen=True, slots=True, eq=False)
class Probe:
    """Offsets from the cell of the robot's axis, ``(row, col)``, of one reading at one heading."""

    body: NDArray[np.intp]
    """``intp[n, 2]``, the paper's Z_r: cells that must be free, from the beam's start up to the error radius
    before its head. The robot's own cell is always in."""
    head: tuple[int, int] | None
    """Where an obstacle must be, give or take the error radius; None for a miss, which has no head."""


def probe_of(
    reading: RangeReading, heading_rad: float, *, resolution_m: float, error_radius_cells: float, reach_cells: int
) -> Probe:
    """Draw a measured reading, for a robot whose axis is at the centre of a cell.

    By the rules of :mod:`robotd.grid.drawn`.

    Args:
        reading: a hit or a miss.
        heading_rad: of the robot, in the map frame.
        resolution_m: side of one cell.
        error_radius_cells: eps, in cells; it shortens misses too, whose cut-off is as uncertain as any range.
        reach_cells: where to end the body at the latest; more than the grid is wide and high changes nothing.

    Raises:
        ValueError: the reading measured nothing.
    """
    drawn = Drawn.of(Readings.of((reading,)), turned(np.array([heading_rad])), resolution_m)
    body, _ = drawn.bodies(drawn.body_lengths(error_radius_cells, reach_cells))
    # The robot stands in its own cell: where the beam starts elsewhere, that has to be free all the same.
    if drawn.start_cells.any():
        body = np.concatenate((np.zeros((1, 2), np.int64), body))
    head_row, head_col = drawn.head_cells[0].tolist()
    return Probe(body.astype(np.intp), None if reading.status is ReadingStatus.MISS else (head_row, head_col))
