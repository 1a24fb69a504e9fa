"""Wall fields and beams cast on them, in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.cast.cast_kernel import BLOCKS, DEPTH_CELLS, ENDS, FAR_CODE, REACH_CELLS, SKIP_MAX
from robotd.grid.kernels.shared.library import agree, ffi, floats, lib, octets

agree(REACH_CELLS=REACH_CELLS, FAR_CODE=FAR_CODE, DEPTH_CELLS=DEPTH_CELLS, SKIP_MAX=SKIP_MAX, ENDS=ENDS, BLOCKS=BLOCKS)


def wall_codes(walls: NDArray[np.bool_]) -> NDArray[np.int8]:
    """See :class:`.CastKernel`."""
    rows, cols = walls.shape
    codes = np.empty((rows, cols), np.int8)
    scratch = np.empty(2 * walls.size + cols + 2 * REACH_CELLS, np.uint8)
    lib.wall_codes(octets(walls.view(np.uint8)), rows, cols, octets(scratch), ffi.from_buffer("int8_t[]", codes))
    return codes


def skip_codes(ends: NDArray[np.bool_], blocks: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """See :class:`.CastKernel`."""
    rows, cols = ends.shape
    # Not zeroed: the kernel writes every cell, the ring included.
    skips = np.empty((rows + 2, cols + 2), np.uint8)
    scratch = octets(np.empty(skips.size + cols + 2 + 2 * SKIP_MAX, np.uint8))
    lib.skip_codes(octets(ends.view(np.uint8)), octets(blocks.view(np.uint8)), rows, cols, scratch, octets(skips))
    return skips


def cast_beams(
    skips: NDArray[np.uint8], beams: NDArray[np.float64], poses: NDArray[np.float64], blocked_by: int
) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
    """See :class:`.CastKernel`."""
    shape = (len(poses), len(beams))
    ways, stops = np.empty(shape), np.empty(shape, np.uint8)
    rows, cols = skips.shape
    sizes = (floats(beams), len(beams), floats(poses), len(poses), blocked_by)
    lib.cast_beams(octets(skips), rows, cols, *sizes, floats(ways), octets(stops))
    return ways, stops
