"""The shape of a region, from its cells: how far it reaches, the circle round it, its cells in few words."""

import math

import numpy as np
from numpy.typing import NDArray

from robotd.contract.estimate import Circle, Cover, Extent
from robotd.core.angles import wrap_rad
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.pose_set import PoseSet
from robotd.localization.places.smallest_circle import smallest_circle


def best_pose(piece: PoseSet) -> tuple[int, int, int]:
    """Return ``(heading, row, col)``: of the poses of greatest rank the one nearest to the mean of their cells."""
    best = piece.best
    off = best[:, 1:] - best[:, 1:].mean(axis=0)
    heading, row, col = best[np.hypot(off[:, 0], off[:, 1]).argmin()].tolist()
    return heading, row, col


def cover_of(cells: NDArray[np.intp], runs_max: int) -> Cover:
    """Return cells ``intp[n, 2]``, ascending, as runs of the smallest blocks of which this many runs are enough."""
    block = 1
    while True:
        blocks = np.unique(cells // block, axis=0)
        starts = np.ones(len(blocks), np.bool_)
        starts[1:] = (np.diff(blocks, axis=0) != (0, 1)).any(axis=1)
        first = np.flatnonzero(starts)
        if len(first) <= runs_max:
            last = np.append(first[1:], len(blocks)) - 1
            runs = np.stack((*blocks[first].T, blocks[last, 1]), axis=1).tolist()
            return Cover(block, tuple((row, first_col, last_col) for row, first_col, last_col in runs))
        # Twice as coarse, not one cell more: few tries, however large the region is.
        block *= 2


def centre_of(piece: PoseSet, spec: GridSpec, headings_rad: tuple[float, ...]) -> Pose2:
    """Return the mean of the poses of greatest rank, map frame."""
    best = piece.best
    x_m, y_m = spec.centre_of(float(best[:, 1].mean()), float(best[:, 2].mean()))
    angles = np.array(headings_rad)[best[:, 0]]
    # Headings are averaged as directions: those on either side of half a turn would cancel as numbers.
    return Pose2(x_m, y_m, math.atan2(float(np.sin(angles).mean()), float(np.cos(angles).mean())))


def extent_of(poses: NDArray[np.intp], spec: GridSpec, headings_rad: tuple[float, ...]) -> Extent:
    """Return how far poses ``intp[n, 3]`` reach, map frame."""
    (row_min, col_min), (row_max, col_max) = poses[:, 1:].min(axis=0).tolist(), poses[:, 1:].max(axis=0).tolist()
    x_min_m, y_min_m = spec.centre_of(row_min - 0.5, col_min - 0.5)
    x_max_m, y_max_m = spec.centre_of(row_max + 0.5, col_max + 0.5)
    return Extent(x_min_m, x_max_m, y_min_m, y_max_m, *_headings_extent(np.unique(poses[:, 0]), headings_rad))


def _headings_extent(used: NDArray[np.intp], headings_rad: tuple[float, ...]) -> tuple[float, float]:
    """Return from where to where headings reach, half a step beyond the outermost: all round but the widest gap."""
    angles = np.sort(np.mod(np.array(headings_rad)[used], math.tau))
    half_step_rad = float(np.diff(headings_rad).min()) / 2 if len(headings_rad) > 1 else 0.0
    gaps = np.diff(angles, append=angles[0] + math.tau)
    # Headings go round, so the least and the greatest of them mean nothing: what is left out is the widest gap.
    widest = int(gaps.argmax())
    first = (widest + 1) % len(angles)
    # The gap of a single heading is a whole turn, or by rounding a hair more.
    width_rad = min(max(math.tau - float(gaps[widest]), 0.0) + 2 * half_step_rad, math.tau)
    least_rad = wrap_rad(float(angles[first]) - half_step_rad)
    return least_rad, least_rad + width_rad


def circle_of(cells: NDArray[np.intp], spec: GridSpec) -> Circle:
    """Return the smallest circle round cells ``intp[n, 2]``, ascending: the outermost of each row decide."""
    # Cells between the ends of a row lie inside any circle round these, and would only cost time.
    first = np.flatnonzero(np.diff(cells[:, 0], prepend=-1))
    last = np.append(first[1:], len(cells)) - 1
    outermost = np.concatenate((cells[first], cells[last])).astype(np.float64)
    corners = np.concatenate([outermost + np.array(corner) for corner in np.ndindex(2, 2)])
    row, col, radius = smallest_circle(corners)
    x_m, y_m = spec.centre_of(row - 0.5, col - 0.5)
    return Circle(x_m, y_m, radius * spec.resolution_m)
