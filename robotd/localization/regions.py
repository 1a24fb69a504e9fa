"""From cells of high rank to regions: the connected pieces of loc, each an answer to *where*.

[BrownDonald2000]_ sec. 2.2.1: loc may be several separate regions, and all of them are the answer.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.grid.spec import GridSpec
from robotd.localization.estimate import Region
from robotd.localization.rank import RankGrid

_NEIGHBOUR_LINES = ((0, 1), (1, -1), (1, 0), (1, 1))
"""Steps ``(heading, row)`` to half of the neighbouring lines; the other half see this one as theirs."""


def regions_of(ranks: RankGrid, least_rank: int) -> tuple[Region, ...]:
    """Return the connected regions of all poses that explain at least ``least_rank`` readings.

    Ordered by best rank, then by size, then by place: all of them, whatever their number.
    """
    poses = ranks.cells_of_rank(least_rank)
    if len(poses) == 0:
        return ()
    labels = connected_components(poses, headings=len(ranks.headings_rad), wrap=_go_round(ranks.headings_rad))
    order = np.argsort(labels, kind="stable")
    pieces = np.split(order, np.flatnonzero(np.diff(labels[order])) + 1)
    values = ranks.rank_at(poses)
    regions = [_region(poses[piece], values[piece], ranks.spec, ranks.headings_rad) for piece in pieces]
    return tuple(sorted(regions, key=lambda region: (-region.best_rank, -region.cells)))


def connected_components(poses: NDArray[np.intp], *, headings: int, wrap: bool) -> NDArray[np.intp]:
    """Label poses that touch: by side or corner in the plane, and in the same or the next heading.

    Args:
        poses: ``intp[n, 3]``, ``(heading, row, col)``, ascending and each once.
        headings: how many headings there are.
        wrap: whether the last heading is next to the first.

    Returns:
        ``intp[n]``, equal exactly for connected poses, numbered from 0 in the order of their first pose.
        Runs of cells are joined, not cells: O(n + r log r) for r runs along the rows.
    """
    runs = _Runs.of(poses)
    links = [_touching(runs, step, headings if wrap else None) for step in _NEIGHBOUR_LINES]
    labels = _join(len(runs.first_col), np.concatenate(links, axis=1))
    _, numbered = np.unique(labels[runs.of_pose], return_inverse=True)
    return numbered.astype(np.intp)


@dataclass(frozen=True, slots=True, eq=False)
class _Runs:
    """Poses side by side along a row, ascending."""

    of_pose: NDArray[np.intp]
    """``intp[n]``, the run of each pose."""
    heading: NDArray[np.intp]
    row: NDArray[np.intp]
    first_col: NDArray[np.intp]
    last_col: NDArray[np.intp]

    @classmethod
    def of(cls, poses: NDArray[np.intp]) -> "_Runs":
        starts = np.ones(len(poses), np.bool_)
        starts[1:] = (np.diff(poses, axis=0) != (0, 0, 1)).any(axis=1)
        first = np.flatnonzero(starts)
        last = np.append(first[1:], len(poses)) - 1
        heading, row, col = poses.T
        return cls(np.cumsum(starts) - 1, heading[first], row[first], col[first], col[last])


def _touching(runs: _Runs, step: tuple[int, int], wrap_headings: int | None) -> NDArray[np.intp]:
    """Return ``intp[2, k]``: pairs of runs that touch, the second on the line one ``(heading, row)`` step further."""
    rows, width = int(runs.row.max()) + 3, int(runs.last_col.max()) + 3
    heading = runs.heading + step[0]
    if wrap_headings is not None:
        heading %= wrap_headings
    # Line after line on one axis, with a margin between them: neighbours are found by bisection.
    own = (runs.heading * rows + runs.row + 1) * width + 1
    other = (heading * rows + runs.row + 1 + step[1]) * width + 1
    first = np.searchsorted(own + runs.last_col, other + runs.first_col - 1)
    last = np.searchsorted(own + runs.first_col, other + runs.last_col + 1, side="right")
    counts = np.maximum(last - first, 0)
    run = np.repeat(np.arange(len(counts)), counts)
    return np.stack((run, np.arange(len(run)) - np.repeat(np.cumsum(counts) - counts - first, counts)))


def _join(count: int, links: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the smallest member of everybody's set: union-find, all links at a time."""
    root = np.arange(count)
    while True:
        one, other = root[links[0]], root[links[1]]
        apart = one != other
        if not apart.any():
            return root
        np.minimum.at(root, np.maximum(one, other)[apart], np.minimum(one, other)[apart])
        while (root != root[root]).any():
            root = root[root]


def _region(
    poses: NDArray[np.intp], ranks: NDArray[np.uint16], spec: GridSpec, headings_rad: tuple[float, ...]
) -> Region:
    best_rank = int(ranks.max())
    best = poses[ranks == best_rank]
    x_m, y_m = spec.centre_of(float(best[:, 1].mean()), float(best[:, 2].mean()))
    angles = np.array(headings_rad)[best[:, 0]]
    heading_rad = math.atan2(float(np.sin(angles).mean()), float(np.cos(angles).mean()))
    half_m = spec.resolution_m / 2
    x_min_m, y_min_m = spec.centre_of(*poses[:, 1:].min(axis=0).tolist())
    x_max_m, y_max_m = spec.centre_of(*poses[:, 1:].max(axis=0).tolist())
    return Region(
        centre=Pose2(x_m, y_m, heading_rad),
        x_min_m=x_min_m - half_m,
        x_max_m=x_max_m + half_m,
        y_min_m=y_min_m - half_m,
        y_max_m=y_max_m + half_m,
        cells=len(poses),
        best_rank=best_rank,
    )


def _go_round(headings_rad: tuple[float, ...]) -> bool:
    """Whether the step from the last heading to the first, once round, is no longer than those between."""
    if len(headings_rad) < 3:
        return False
    steps = np.diff(headings_rad, append=headings_rad[0] + math.tau)
    return bool(steps[-1] <= steps[:-1].max() * 1.5 and (steps > 0).all())
