"""Readings drawn at one heading with no error, and what error would shorten their bodies to every cell of them.

The cells are those of :mod:`robotd.grid.drawn`.
"""

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.grid.drawn import Drawn
from robotd.grid.kernels.draw.draw_kernel import NO_HEAD, turned
from robotd.grid.kernels.error_radius.error_radius_kernel import Bodies
from robotd.grid.ray import ray_steps
from robotd.grid.readings import Readings
from robotd.localization.erring.error_map import NEVER

RANGE_CELLS_MAX = 32_000
"""Errors of longer readings do not fit into sixteen bits with room to spare."""


def draw_bodies(readings: Readings, heading_rad: float, spec: GridSpec) -> Bodies:
    """Draw readings.

    Args:
        readings: hits and misses.
        heading_rad: of the robot, in the map frame.
        spec: of the map.

    Raises:
        ValueError: a reading is longer than 32 000 cells.
    """
    drawn = Drawn.of(readings, turned(np.array([heading_rad])), spec.resolution_m)
    if drawn.range_cells.max(initial=0.0) > RANGE_CELLS_MAX:
        raise ValueError(f"a reading is {drawn.range_cells.max():.0f} cells long; at most {RANGE_CELLS_MAX}")
    errors, counts = errors_by_samples(drawn.bearings_rad, drawn.range_cells, reach_cells(spec))
    cells, _ = drawn.bodies(counts)
    ends, heads = np.cumsum(counts), drawn.head_cells
    heads[drawn.is_miss] = NO_HEAD
    return Bodies(
        chains=cells.astype(np.int32),
        lengths=np.minimum(errors, NEVER).astype(np.uint16),
        readings=np.column_stack((ends - counts, ends, heads)).astype(np.int32),
    )


def errors_by_samples(
    bearings_rad: NDArray[np.float64], range_cells: NDArray[np.float64], reach: int
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Return the smallest whole eps that leaves rays no more than 0, 1, 2, ... samples; no eps leaves them none.

    Args:
        bearings_rad: ``float64[n]``.
        range_cells: ``float64[n]``, lengths of the rays if there is no error.
        reach: where they end at the latest.

    Returns:
        ``float64[cells]``, whole numbers and ``inf``, for every sample of ray after ray; and how many each has,
        ``intp[n]``.
    """
    per_cell = np.maximum(np.abs(np.cos(bearings_rad)), np.abs(np.sin(bearings_rad)))
    counts = np.maximum(1.0, np.ceil(np.minimum(range_cells, reach) * per_cell)).astype(np.intp)
    left = np.arange(int(counts.sum())) - np.repeat(np.cumsum(counts) - counts, counts)
    ranges, shares = np.repeat(range_cells, counts), np.repeat(per_cell, counts)
    sample_cells = np.repeat(np.hypot(*ray_steps(bearings_rad).T), counts)
    # In exact arithmetic this is the answer; rounding may make it the one next to it.
    errors: NDArray[np.float64] = np.ceil(ranges - left * sample_cells) + 1.0
    # Downwards only: one was added above, so the guess is never too small.
    for _ in range(2):
        fewer = np.maximum(0.0, errors - 1.0)
        samples = np.ceil(np.clip(ranges - fewer, 0.0, reach) * shares)
        errors = np.where(np.maximum(1.0, samples) <= left, fewer, errors)
    errors[left == 0] = np.inf
    return errors, counts


def reach_cells(spec: GridSpec) -> int:
    """Return where bodies end at the latest: beyond the grid."""
    return 2 * max(spec.shape)
