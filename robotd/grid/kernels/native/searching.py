"""Searching for the best poses, in C."""

import functools
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels._native import ffi, lib
from robotd.grid.kernels.native.buffers import floats, ints, words
from robotd.grid.kernels.native.counting import INSTRUCTION_SETS
from robotd.grid.kernels.planes import Found, Ground, Planes, Question, Window, endings


def make_planes(ground: Ground) -> Planes:
    """See the twin."""
    key_of = endings(ground.error_radius_cells, ground.blocked_by)
    nothing = Planes(ground, key_of, np.empty(0, np.uint16), np.empty(0, np.uint64), np.empty(0, np.uint8))
    c_map = _map_of(nothing)
    cells = np.empty(lib.search_cells_size(c_map), np.uint16)
    pooled = np.empty(lib.search_pooled_size(c_map), np.uint64)
    planes = Planes(ground, key_of, cells, pooled, np.empty(ground.free.shape, np.uint8))
    return renew_planes(planes, ground, (slice(0, ground.free.shape[0]), slice(0, ground.free.shape[1])))


def renew_planes(planes: Planes, ground: Ground, window: Window) -> Planes:
    """See the twin."""
    renewed = Planes(ground, planes.key_of, planes.cells, planes.pooled, planes.near)
    c_map = _map_of(renewed)
    scratch = np.empty(lib.search_scratch_size(c_map), np.uint64)
    rows, cols = window
    lib.search_prepare(c_map, rows.start, rows.stop, cols.start, cols.stop, words(scratch))
    return renewed


def search_poses(planes: Planes, question: Question, *, threads: int = 1, instructions: str | None = None) -> Found:
    """See the twin; ``instructions`` is one of ``INSTRUCTION_SETS``, the best one if None.

    Raises:
        ValueError: this processor lacks those instructions.
    """
    jumping, headings_rad = question.readings[_jumping(len(question.readings))], question.headings_rad
    bearings_rad = headings_rad[:, None] + jumping[:, 0]
    sines, cosines = np.sin(bearings_rad), np.cos(bearings_rad)
    turned = np.array((np.sin(headings_rad), np.cos(headings_rad))).T.copy()
    readings = jumping[:, 1:].copy()
    readings[:, 0] /= question.resolution_m
    poses = np.empty((2 * question.limit + 256, 4), np.int32)
    c_map = _map_of(planes)
    job = ffi.new("search_job *")
    job.map = c_map
    job.readings, job.headings = floats(readings), floats(turned)
    job.sines, job.cosines = floats(sines), floats(cosines)
    job.reading_count, job.heading_count = len(readings), len(headings_rad)
    job.resolution_m, job.error_radius_cells = question.resolution_m, planes.ground.error_radius_cells
    job.reach_cells = question.reach_cells
    job.area, job.spans = question.area, ints(question.spans)
    job.by_blocks = question.by_blocks
    job.slack, job.least_rank, job.limit = question.slack, question.least_rank, question.limit
    job.bits, job.threads = max(3, len(readings).bit_length()), threads
    job.instructions = -1 if instructions is None else INSTRUCTION_SETS.index(instructions)
    scratch = np.empty(lib.search_size(job), np.uint64)
    job.scratch, job.poses = words(scratch), ints(poses)
    if not lib.search_poses(job):
        raise ValueError(f"this processor has no {instructions}")
    found = poses[: job.pose_count]
    order = np.lexsort((found[:, 2], found[:, 1], found[:, 0]))
    return Found(job.best_rank, job.least, found[order])


@functools.lru_cache(maxsize=8)
def _jumping(count: int) -> NDArray[np.intp]:
    """Return an order of readings in which neighbours look in different directions, whatever the sweep."""
    steps = (step for step in range(int(0.618 * count), 0, -1) if math.gcd(step, count) == 1)
    return np.arange(count) * next(steps, 1) % count


def _map_of(planes: Planes) -> Any:
    """Return ``search_map *``; it does not keep the arrays alive."""
    ground, c_map = planes.ground, ffi.new("search_map *")
    c_map.rows, c_map.cols = ground.free.shape
    c_map.keys = planes.keys
    c_map.outside_blocks, c_map.outside_ends = ground.outside_blocks, ground.outside_ends
    c_map.blocked_by = ground.blocked_by
    c_map.free, c_map.blocking = (
        ffi.from_buffer("uint8_t[]", ground.free),
        ffi.from_buffer("uint8_t[]", ground.blocking),
    )
    c_map.grown, c_map.key_of = ffi.from_buffer("uint8_t[]", ground.grown), ffi.from_buffer("int8_t[]", planes.key_of)
    c_map.cells, c_map.pooled = ffi.from_buffer("uint16_t[]", planes.cells), words(planes.pooled)
    c_map.near = ffi.from_buffer("uint8_t[]", planes.near)
    return c_map
