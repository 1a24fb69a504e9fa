"""Searching for the best poses, in NumPy: the twin of the kernel in C."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from robotd.grid.drawn import Drawn
from robotd.grid.kernels.draw.draw_kernel import turned
from robotd.grid.kernels.search.endings import endings
from robotd.grid.kernels.search.search_kernel import Ground, Planes, Question
from robotd.grid.pose_set import PoseSet
from robotd.grid.readings import Readings
from robotd.grid.window import CellWindow


def make_planes(ground: Ground) -> Planes:
    """See :class:`.SearchKernel`."""
    key_of = endings(ground.radii.cells[0], ground.blocked_by)
    return Planes(ground, key_of, np.empty(0, np.uint16), np.empty(0, np.uint64), np.empty(0, np.uint8), None)


def renew_planes(planes: Planes, ground: Ground, window: CellWindow) -> Planes:  # noqa: ARG001  # nothing to renew
    """See :class:`.SearchKernel`."""
    return make_planes(ground)


def search_poses(planes: Planes, question: Question, *, threads: int = 1) -> PoseSet:  # noqa: ARG001  # one is enough
    """See :class:`.SearchKernel`."""
    ground, around = planes.ground, _Around.of(planes.ground)
    free = np.argwhere(_asked_for(ground.free, question))
    best, least, found = 0, max(1, question.least_rank - question.slack), [np.zeros((0, 4), np.int32)]
    total = len(question.readings)
    bounds = []
    for heading in range(len(question.headings_rad)):
        beams = _beams(ground, question, heading)
        cells, heads = _count(around, beams, free, np.zeros(len(free), np.int64), total - least, bodies=False)
        bounds.append((total - int(heads.min(initial=total)), heading, cells, heads))
    # The most promising headings first: what they reach raises the least rank, and the others need not be counted.
    left, is_complete = question.budget, True
    for bound, heading, hopeful, heads in sorted(bounds, key=lambda bound: -bound[0]):
        if bound < least:
            break
        if left <= 0:
            is_complete = False
            break
        kept = heads <= total - least
        beams = _beams(ground, question, heading)
        # What counts is how many readings how many cells were asked for, by their heads already.
        left -= total * int(kept.sum())
        cells, misses = _count(around, beams, hopeful[kept], heads[kept], total - least, bodies=True)
        ranks = total - misses
        best = max(best, int(ranks.max(initial=0)))
        least = max(least, best - question.slack if best >= question.least_rank else 0)
        found.append(np.column_stack((np.full(len(cells), heading), cells, ranks)).astype(np.int32))
    if best < question.least_rank:
        return replace(PoseSet.nothing(max(1, question.least_rank - question.slack)), is_all=is_complete)
    return _limited(np.concatenate(found), best, least, question, is_complete=is_complete)


def _limited(poses: NDArray[np.int32], best: int, least: int, question: Question, *, is_complete: bool) -> PoseSet:
    """Return the poses of a rank, or of the least higher one that leaves few enough."""
    while (poses[:, 3] >= least).sum() > question.limit:
        least += 1
    poses = poses[poses[:, 3] >= least]
    in_order = poses[np.lexsort((poses[:, 2], poses[:, 1], poses[:, 0]))]
    return PoseSet.of_rows(in_order, best, least, slack=question.slack, is_complete=is_complete)


def _asked_for(free: NDArray[np.bool_], question: Question) -> NDArray[np.bool_]:
    wanted = np.zeros_like(free)
    cols = np.arange(free.shape[1])
    wanted[question.window.slices[0]] = (question.spans[:, :1] <= cols) & (cols < question.spans[:, 1:])
    return wanted & free


Beam = tuple[NDArray[np.int64], NDArray[np.int64] | None, int]
"""The cells of the body, ``int64[n, 2]``, the head, None for a miss, and the level."""


def _beams(ground: Ground, question: Question, heading: int) -> list[Beam]:
    """Draw all readings at one heading."""
    at = turned(question.headings_rad[heading : heading + 1])
    drawn = Drawn.of(Readings(question.readings), at, question.resolution_m)
    levels = ground.radii.levels(drawn.range_cells)
    lengths = drawn.body_lengths(np.array(ground.radii.cells)[levels], question.reach_cells)
    cells, _ = drawn.bodies(lengths)
    bodies = np.split(cells, np.cumsum(lengths)[:-1])
    return [
        (body, None if is_miss else head, level)
        for body, head, is_miss, level in zip(bodies, drawn.head_cells, drawn.is_miss, levels.tolist(), strict=True)
    ]


@dataclass(frozen=True, slots=True, eq=False)
class _Around:
    """A map with what lies outside around it, so that looking somewhere is looking up one number."""

    grown: NDArray[np.bool_]
    """``bool[levels, rows * cols]`` of the padded map."""
    blocking: NDArray[np.bool_]
    """``bool[rows * cols]`` of it."""
    margin: tuple[int, int]
    cols: int
    blocked_by: int

    @classmethod
    def of(cls, ground: Ground) -> "_Around":
        rows, cols = ground.free.shape
        margin = ((rows, rows), (cols, cols))
        grown = np.pad(ground.grown, ((0, 0), *margin), constant_values=ground.outside_ends)
        blocking = np.pad(ground.blocking, margin, constant_values=ground.outside_blocks)
        return cls(grown.reshape(len(grown), -1), blocking.ravel(), (rows, cols), 3 * cols, ground.blocked_by)

    def places(self, cells: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return where cells ``intp[n, 2]`` of the map lie, ``intp[n]``."""
        places: NDArray[np.intp] = (cells + self.margin) @ np.array([self.cols, 1])
        return places

    def steps(self, offsets: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return how far the places at offsets ``int64[..., 2]`` lie; what is out of sight is outside."""
        steps: NDArray[np.int64] = np.clip(offsets, np.negative(self.margin), self.margin) @ np.array([self.cols, 1])
        return steps


def _count(
    around: _Around,
    beams: list[Beam],
    cells: NDArray[np.intp],
    misses: NDArray[np.int64],
    allowed: int,
    *,
    bodies: bool,
) -> tuple[NDArray[np.intp], NDArray[np.int64]]:
    """Return the cells that miss no more than is allowed, and what they missed so far.

    Args:
        around: the map.
        beams: to be counted.
        cells: ``intp[n, 2]``.
        misses: ``int64[n]``, what they missed before.
        allowed: how many each may miss.
        bodies: whether beams count that meet their head and are blocked, or those that do not meet their head.
    """
    places, kept = around.places(cells), np.arange(len(cells))
    for body, head, level in beams:
        # A miss has no head to be missed.
        if head is None and not bodies:
            continue
        meets = np.ones(len(places), np.bool_) if head is None else around.grown[level][places + around.steps(head)]
        misses = misses + (_blocked(around, places, body, meets) if bodies else ~meets)
        good = misses <= allowed
        if not good.all():
            places, kept, misses = places[good], kept[good], misses[good]
        if len(places) == 0:
            break
    return cells[kept], misses


def _blocked(
    around: _Around, places: NDArray[np.intp], body: NDArray[np.int64], asked: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Return from which of some places a body meets too many cells that block, ``bool[n]``."""
    blocked = np.zeros(len(places), np.bool_)
    some = np.flatnonzero(asked)
    met = np.zeros(len(some), np.int64)
    for step in around.steps(body).tolist():
        met += around.blocking[places[some] + step]
    blocked[some] = met >= around.blocked_by
    return blocked
