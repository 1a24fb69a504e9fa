"""Searching for the best poses, in NumPy: the twin of the kernel in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.planes import Found, Ground, Planes, Question, Window, endings
from robotd.grid.ray import ray_steps

_FAR_CELLS = float(1 << 28)


def make_planes(ground: Ground) -> Planes:
    """Return what the search keeps of a map; the twin reads the map itself and keeps nothing more."""
    key_of = endings(ground.error_radius_cells, ground.blocked_by)
    return Planes(ground, key_of, np.empty(0, np.uint16), np.empty(0, np.uint64), np.empty(0, np.uint8), None)


def renew_planes(planes: Planes, ground: Ground, window: Window) -> Planes:  # noqa: ARG001  # nothing to renew
    """Return the planes after cells changed, all of them in a window; the old ones are used up."""
    return make_planes(ground)


def search_poses(planes: Planes, question: Question, *, threads: int = 1) -> Found:  # noqa: ARG001  # one is enough
    """Return the best poses.

    Heading by heading, cells that may hold an answer are kept in a list, and dropped once they have missed too many
    readings: first by the heads of all beams, then, only where the heads leave a chance, by their bodies.
    """
    ground = planes.ground
    free = np.argwhere(_asked_for(ground.free, question))
    best, least, found = 0, max(1, question.least_rank - question.slack), [np.zeros((0, 4), np.int32)]
    total = len(question.readings)
    bounds = []
    for heading in range(len(question.headings_rad)):
        beams = _beams(ground, question, heading)
        cells, heads = _count(ground, beams, free, np.zeros(len(free), np.int64), total - least, bodies=False)
        bounds.append((total - int(heads.min(initial=total)), heading, cells, heads))
    for bound, heading, hopeful, heads in sorted(bounds, key=lambda bound: -bound[0]):
        if bound < least:
            break
        kept = heads <= total - least
        beams = _beams(ground, question, heading)
        cells, misses = _count(ground, beams, hopeful[kept], heads[kept], total - least, bodies=True)
        ranks = total - misses
        best = max(best, int(ranks.max(initial=0)))
        least = max(least, best - question.slack if best >= question.least_rank else 0)
        found.append(np.column_stack((np.full(len(cells), heading), cells, ranks)).astype(np.int32))
    if best < question.least_rank:
        return Found(0, max(1, question.least_rank - question.slack), found[0])
    return _limited(np.concatenate(found), best, least, question.limit)


def _limited(poses: NDArray[np.int32], best: int, least: int, limit: int) -> Found:
    """Return the poses of a rank, or of the least higher one that leaves few enough."""
    while (poses[:, 3] >= least).sum() > limit:
        least += 1
    poses = poses[poses[:, 3] >= least]
    return Found(best, least, poses[np.lexsort((poses[:, 2], poses[:, 1], poses[:, 0]))])


def _asked_for(free: NDArray[np.bool_], question: Question) -> NDArray[np.bool_]:
    wanted = np.zeros_like(free)
    cols = np.arange(free.shape[1])
    row_first, row_last = question.area[:2]
    wanted[row_first:row_last] = (question.spans[:, :1] <= cols) & (cols < question.spans[:, 1:])
    return wanted & free


Beam = tuple[NDArray[np.int64], NDArray[np.int64] | None]
"""The cells of the body, ``int64[n, 2]``, and the head, None for a miss."""


def _beams(ground: Ground, question: Question, heading: int) -> list[Beam]:
    """Draw all readings at one heading, by the rules of ``localization/probe.py``."""
    heading_rad = question.headings_rad[heading]
    bearing_rad, range_m, x_m, y_m, is_miss = question.readings.T
    sin, cos = np.sin(heading_rad), np.cos(heading_rad)
    positions = np.stack((sin * x_m + cos * y_m, cos * x_m - sin * y_m), axis=1) / question.resolution_m
    bearings_rad = bearing_rad + heading_rad
    ahead = np.stack((np.sin(bearings_rad), np.cos(bearings_rad)), axis=1)
    range_cells = range_m / question.resolution_m
    free_cells = np.clip(range_cells - ground.error_radius_cells, 0.0, question.reach_cells)
    counts = np.maximum(np.ceil(free_cells * np.abs(ahead).max(axis=1)), 1.0).astype(np.int64)
    starts, heads, steps = (
        _nearest(positions),
        _nearest(positions + range_cells[:, None] * ahead),
        ray_steps(bearings_rad),
    )
    return [
        (
            start + np.floor(0.5 + np.arange(count)[:, None] * step).astype(np.int64),
            None if missed > 0.0 else head,
        )
        for start, count, step, head, missed in zip(starts, counts, steps, heads, is_miss, strict=True)
    ]


def _nearest(cells: NDArray[np.float64]) -> NDArray[np.int64]:
    return np.floor(np.clip(cells, -_FAR_CELLS, _FAR_CELLS) + 0.5).astype(np.int64)


def _count(
    ground: Ground,
    beams: list[Beam],
    cells: NDArray[np.intp],
    misses: NDArray[np.int64],
    allowed: int,
    *,
    bodies: bool,
) -> tuple[NDArray[np.intp], NDArray[np.int64]]:
    """Return the cells that miss no more than is allowed, and what they missed so far.

    Args:
        ground: the map.
        beams: to be counted.
        cells: ``intp[n, 2]``.
        misses: ``int64[n]``, what they missed before.
        allowed: how many each may miss.
        bodies: whether beams count that meet their head and are blocked, or those that do not meet their head.
    """
    for body, head in beams:
        ends = np.ones(len(cells), np.bool_) if head is None else _at(ground.grown, cells + head, ground.outside_ends)
        misses = misses + (_blocked(ground, cells, body, ends) if bodies else ~ends)
        kept = misses <= allowed
        if not kept.all():
            cells, misses = cells[kept], misses[kept]
        if len(cells) == 0:
            break
    return cells, misses


def _blocked(
    ground: Ground, cells: NDArray[np.intp], body: NDArray[np.int64], asked: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Return from which of some cells a body meets too many that block, ``bool[n]``."""
    blocked = np.zeros(len(cells), np.bool_)
    some = np.flatnonzero(asked)
    met = np.zeros(len(some), np.int64)
    for offset in body:
        met += _at(ground.blocking, cells[some] + offset, ground.outside_blocks)
    blocked[some] = met >= ground.blocked_by
    return blocked


def _at(plane: NDArray[np.bool_], cells: NDArray[np.int64], outside: bool) -> NDArray[np.bool_]:
    """Return what a plane holds at some cells, inside it or not."""
    inside = ((cells >= 0) & (cells < plane.shape)).all(axis=1)
    values = np.full(len(cells), outside)
    values[inside] = plane[cells[inside, 0], cells[inside, 1]]
    return values
