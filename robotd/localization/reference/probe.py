"""A range reading drawn on the grid: the paper's range vector z, pixelized for one heading.

The definition, for one reading at one heading; the kernels draw the same cells, all readings at all headings at once
(:mod:`robotd.grid.kernels.draw.draw_kernel`), and the tests hold them against this.
[BrownDonald2000]_ sec. 2.3.3, fig. 17.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.ray import ray_offsets


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

    Where the beam does not start at the robot's axis, its start is rounded to a cell: then all beams of one direction
    share one chain of cells, whatever the heading. The head is rounded once, from the whole vector.

    Args:
        reading: a hit or a miss.
        heading_rad: of the robot, in the map frame.
        resolution_m: side of one cell.
        error_radius_cells: eps, in cells; it shortens misses too, whose cut-off is as uncertain as any range.
        reach_cells: where to end the body at the latest; more than the grid is wide and high changes nothing.

    Raises:
        ValueError: the reading measured nothing.
    """
    if reading.range_m is None:
        raise ValueError(f"a {reading.status} reading has no range")
    bearing = heading_rad + reading.bearing_rad
    cos, sin = float(np.cos(heading_rad)), float(np.sin(heading_rad))
    start_row = (sin * reading.origin_x_m + cos * reading.origin_y_m) / resolution_m
    start_col = (cos * reading.origin_x_m - sin * reading.origin_y_m) / resolution_m
    range_cells = reading.range_m / resolution_m
    start = np.array([_nearest(start_row), _nearest(start_col)])
    body = start + ray_offsets(bearing, min(range_cells - error_radius_cells, reach_cells))
    if start.any():
        body = np.concatenate((np.zeros((1, 2), np.intp), body))
    if reading.status is ReadingStatus.MISS:
        return Probe(body, None)
    head = (
        _nearest(start_row + range_cells * float(np.sin(bearing))),
        _nearest(start_col + range_cells * float(np.cos(bearing))),
    )
    return Probe(body, head)


def _nearest(offset_cells: float) -> int:
    """Return which cell a point lies in that is this far from the centre of cell 0."""
    return math.floor(offset_cells + 0.5)
