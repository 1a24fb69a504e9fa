"""From poses of high rank to regions: the connected pieces of loc, each an answer to *where*.

[BrownDonald2000]_ sec. 2.2.1: loc may be several separate regions, and all of them are the answer.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.grid.pose_set import PoseSet

_NEIGHBOUR_LINES = ((0, 1), (1, -1), (1, 0), (1, 1))
"""Steps ``(heading, row)`` to half of the neighbouring lines; the other half see this one as theirs."""


@dataclass(frozen=True, slots=True, eq=False)
class Pieces:
    """The best regions, and how many more there are."""

    best: tuple[PoseSet, ...]
    left_out: int


def pieces_of(
    found: PoseSet, headings_rad: tuple[float, ...], most: int, first: NDArray[np.intp] | None = None
) -> Pieces:
    """Part poses into connected regions.

    Args:
        found: the poses.
        headings_rad: the headings, ascending; the first is next to the last if they go all round.
        most: how many regions to return.
        first: ``intp[k]``, poses whose regions come before all others, in this order.

    Returns:
        Those, and those of greatest rank, then of most poses, then of the first place.
    """
    if len(found) == 0:
        return Pieces((), 0)
    labels = connected_components(found.poses, headings=len(headings_rad), wrap=_go_round(headings_rad))
    sizes = np.bincount(labels)
    best_ranks = np.zeros(len(sizes), np.uint16)
    np.maximum.at(best_ranks, labels, found.ranks)
    urgency = np.full(len(sizes), len(found))
    if first is not None:
        np.minimum.at(urgency, labels[first], np.arange(len(first)))
    # The last key decides first. The label comes last of all, so that the order is the same in every replay.
    order = np.lexsort((np.arange(len(sizes)), -sizes, -best_ranks.astype(np.intp), urgency))
    # One sort for all regions: a mask for each would be read once per region.
    members = np.argsort(labels, kind="stable")
    ends = np.cumsum(sizes)
    chosen = (members[ends[label] - sizes[label] : ends[label]] for label in order[:most])
    best = tuple(found.part(which) for which in chosen)
    return Pieces(best, len(sizes) - len(best))


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
        # Chains are cut short at once: else joining a long corridor could take a round for each of its runs.
        while (root != root[root]).any():
            root = root[root]


def _go_round(headings_rad: tuple[float, ...]) -> bool:
    """Whether the step from the last heading to the first, once round, is no longer than those between."""
    if len(headings_rad) < 3:
        return False
    steps = np.diff(headings_rad, append=headings_rad[0] + math.tau)
    # Half a step to spare for rounding: a single heading left out would make it two steps.
    return bool(steps[-1] <= steps[:-1].max() * 1.5 and (steps > 0).all())
