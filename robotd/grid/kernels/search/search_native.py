"""Searching for the best poses, in C."""

import functools
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.search.endings import endings
from robotd.grid.kernels.search.search_kernel import Ground, Planes, Question
from robotd.grid.kernels.shared.library import ffi, floats, instructions_named, ints, lib, octets, words
from robotd.grid.pose_set import PoseSet
from robotd.grid.window import CellWindow


def make_planes(ground: Ground) -> Planes:
    """See :class:`.SearchKernel`."""
    key_of = endings(ground.radii.cells[0], ground.blocked_by)
    sizes = _map_of(ground, key_of)
    cells = np.empty(lib.search_cells_size(sizes), np.uint16)
    pooled = np.empty(lib.search_pooled_size(sizes), np.uint64)
    near = np.empty(ground.free.shape, np.uint8)
    return _filled(ground, key_of, (cells, pooled, near), CellWindow.whole(near.shape))


def renew_planes(planes: Planes, ground: Ground, window: CellWindow) -> Planes:
    """See :class:`.SearchKernel`."""
    if planes.handle is None:  # a twin's
        return make_planes(ground)
    # Copied, since others may be searching the old ones: 0.06 ms of the 0.75 that a renewal takes at 256 x 256 cells.
    arrays = planes.cells.copy(), planes.pooled.copy(), planes.near.copy()
    return _filled(ground, planes.key_of, arrays, window)


def _filled(
    ground: Ground,
    key_of: NDArray[np.int8],
    arrays: tuple[NDArray[np.uint16], NDArray[np.uint64], NDArray[np.uint8]],
    window: CellWindow,
) -> Planes:
    """Fill what depends on a window of the map."""
    cells, pooled, near = arrays
    c_map = _map_of(ground, key_of)
    c_map.cells, c_map.pooled = ffi.from_buffer("uint16_t[]", cells), words(pooled)
    c_map.near = octets(near)
    scratch = np.empty(lib.search_planes_scratch_words(c_map), np.uint64)
    lib.search_prepare(c_map, window.first_row, window.end_row, window.first_col, window.end_col, words(scratch))
    return Planes(ground, key_of, cells, pooled, near, c_map)


def search_poses(planes: Planes, question: Question, *, threads: int = 1, instructions: str | None = None) -> PoseSet:
    """See :class:`.SearchKernel`; ``instructions`` is one of ``INSTRUCTION_SETS``, the best one if None.

    Raises:
        ValueError: this processor lacks those instructions.
    """
    if planes.handle is None:  # a twin's
        planes = make_planes(planes.ground)
    jumping, headings_rad = question.readings[_jumping(len(question.readings))], question.headings_rad
    # NumPy's sines, as everywhere: the twin's, to the last bit, decide in which cell a head lies.
    bearings_rad = headings_rad[:, None] + jumping[:, 0]
    sines, cosines = np.sin(bearings_rad), np.cos(bearings_rad)
    turned = np.array((np.sin(headings_rad), np.cos(headings_rad))).T.copy()
    readings = jumping[:, 1:].copy()
    readings[:, 0] /= question.resolution_m
    window = question.window
    limit = min(question.limit, window.size * len(headings_rad))
    # Twice the limit before they are thinned out, and the 256 cells of a window more that one report may add.
    poses = np.empty((2 * limit + 256, 4), np.int32)
    job = ffi.new("search_job *")
    job.map = planes.handle
    job.readings, job.headings = floats(readings), floats(turned)
    job.sines, job.cosines = floats(sines), floats(cosines)
    job.reading_count, job.heading_count = len(readings), len(headings_rad)
    radii = planes.ground.radii
    levels, cells = radii.levels(readings[:, 0]).astype(np.int32), np.array(radii.cells)
    job.levels, job.radii = ints(levels), floats(cells)
    job.resolution_m, job.reach_cells = question.resolution_m, question.reach_cells
    job.area = window.first_row, window.end_row, window.first_col, window.end_col
    job.spans = ints(question.spans)
    job.by_blocks = question.by_blocks
    job.slack, job.least_rank, job.limit = question.slack, question.least_rank, limit
    job.budget = question.budget
    job.bits, job.threads = max(3, len(readings).bit_length()), threads
    job.instructions = instructions_named(instructions)
    scratch = np.empty(lib.search_scratch_words(job), np.uint64)
    job.scratch, job.poses = words(scratch), ints(poses)
    if not lib.search_poses(job):
        raise ValueError(f"this processor has no {instructions}")
    found = poses[: job.pose_count]
    # Threads find poses in any order; the answer must not depend on that.
    order = np.lexsort((found[:, 2], found[:, 1], found[:, 0]))
    return PoseSet.of_rows(
        found[order], job.best_rank, job.least, slack=question.slack, is_complete=bool(job.is_complete)
    )


@functools.lru_cache(maxsize=8)
def _jumping(count: int) -> NDArray[np.intp]:
    """Return an order of readings in which neighbours look in different directions, whatever the sweep."""
    # By the golden section, and prime to the number of readings, so that every reading comes once.
    steps = (step for step in range(int(0.618 * count), 0, -1) if math.gcd(step, count) == 1)
    return np.arange(count) * next(steps, 1) % count


def _map_of(ground: Ground, key_of: NDArray[np.int8]) -> Any:
    """Return ``search_map *`` of no planes yet; it does not keep the arrays alive."""
    c_map = ffi.new("search_map *")
    c_map.rows, c_map.cols = ground.free.shape
    c_map.levels, c_map.sectors = len(ground.radii.cells), int(key_of.max()) + 1
    c_map.keys = c_map.sectors + c_map.levels - 1
    c_map.outside_blocks, c_map.outside_ends = ground.outside_blocks, ground.outside_ends
    c_map.blocked_by = ground.blocked_by
    c_map.free, c_map.blocking = octets(ground.free.view(np.uint8)), octets(ground.blocking.view(np.uint8))
    c_map.grown, c_map.key_of = octets(ground.grown.view(np.uint8)), ffi.from_buffer("int8_t[]", key_of)
    return c_map
