"""How many readings each place explains at its best heading: a picture for people, from which nothing is concluded."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.grid.kernels.shared.packed_map import TILE_ROWS, WORD_CELLS
from robotd.grid.readings import Readings
from robotd.localization.count.heading_batches import MEMORY_BYTES, heading_batches
from robotd.localization.count.rank_grid import RankGrid
from robotd.localization.obstacles.levels import Levels

MOST_CELLS = 512
"""Along a side: more than people see, and 40 KB on the wire."""
_MOST_WORK = 20_000_000_000
"""Readings x headings x cells: a third of a second; a larger map is counted at fewer headings."""


@dataclass(frozen=True, slots=True, eq=False)
class Heat:
    """How much the best pose in each block of cells explains, as a picture."""

    spec: GridSpec
    """Where its cells lie, which are blocks of those of the map."""
    levels: NDArray[np.uint8] = field(repr=False)
    """``uint8[rows, cols]``: 255 where the best pose explains all readings."""
    block: int
    """Cells of the map along the side of a block, of which the greatest counts."""
    readings: int
    headings: int
    """How many were tried."""


def block_of(spec: GridSpec) -> int:
    """Return how many cells of a map along a side become one of the picture."""
    return -(-max(spec.shape) // MOST_CELLS)


def pictured(the_map: GridSpec, levels: NDArray[np.uint8], readings: int, headings: int) -> Heat:
    """Return the picture of a map in blocks of :func:`block_of`."""
    block, (rows, cols) = block_of(the_map), levels.shape
    spec = GridSpec(the_map.resolution_m * block, the_map.origin_x_m, the_map.origin_y_m, (rows, cols))
    return Heat(spec, levels, block, readings, headings)


def counted_apart(levels: Levels, readings: Readings, headings_rad: Sequence[float]) -> Heat:
    """Count readings for the picture alone: where the best poses are searched for, nothing else counts them."""
    spec = levels.spec
    work = len(readings) * len(headings_rad) * len(levels.maps[0].packed.tiles) * TILE_ROWS * WORD_CELLS
    # Evenly fewer headings, and not fewer readings: a picture of half the readings would show other places.
    thinned_rad = headings_rad[:: max(1, math.ceil(work / _MOST_WORK))]
    block = block_of(spec)
    greatest = np.zeros(tuple(-(-side // block) for side in spec.shape), np.uint8)
    for _, batch_rad in heading_batches(levels.maps[0], len(readings), thinned_rad, MEMORY_BYTES):
        ranks = RankGrid(levels.maps[0], batch_rad)
        ranks.add_by_level(readings, levels)
        np.maximum(greatest, ranks.heat(block), out=greatest)
    return pictured(spec, greatest, len(readings), len(thinned_rad))
