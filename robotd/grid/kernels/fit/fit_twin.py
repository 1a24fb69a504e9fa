"""Fitting poses to walls, in NumPy: the twin of the kernel in C, sums in the same order, so with the same roundings."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.cast.cast_kernel import FAR_CODE, REACH_CELLS
from robotd.grid.kernels.fit.fit_kernel import (
    HEADS_MIN,
    LAGS,
    LEAST_SPREAD_CELLS,
    UNKNOWN_CELLS,
    UNKNOWN_RAD,
    Fits,
    Lattice,
)

_ROUNDS_MAX = 32
_NARROWING = 0.7
"""A biweight that begins wide lets far heads pull; narrowed step by step, it ends at the outlier's width."""
_CLOSE = 1e-4
_PRIOR = 0.1


def fit_poses(
    codes: NDArray[np.int8],
    distances: NDArray[np.float64],
    heads: NDArray[np.float64],
    boxes: NDArray[np.float64],
    outlier_cells: float,
) -> Fits:
    """See :class:`.FitKernel`."""
    count, beams = len(boxes), len(heads)
    fits = Fits(np.empty((count, 3)), np.empty((count, 3, 3)), np.empty((count, 3)), np.empty((count, beams)))
    for number, box in enumerate(boxes):
        pose = _fit(codes, distances, heads, box, outlier_cells)
        fits.poses[number] = pose
        found = _look(codes, distances, heads, pose.tolist(), outlier_cells)
        fits.beyond[number] = found.beyond
        fits.quality[number], fits.covariances[number] = _judge(found)
    return fits


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    """Where the heads lie at one pose."""

    cost: float
    weight: float
    squares: float
    normal: NDArray[np.float64]
    """``float64[3, 3]``."""
    gradient: NDArray[np.float64]
    beyond: NDArray[np.float64]
    weights: NDArray[np.float64]


def _look(
    codes: NDArray[np.int8],
    distances: NDArray[np.float64],
    heads: NDArray[np.float64],
    pose: list[float],
    width: float,
) -> _Found:
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    to_x, to_y = cos * heads[:, 0] - sin * heads[:, 1], sin * heads[:, 0] + cos * heads[:, 1]
    distance, slope_x, slope_y = _interpolated(codes, distances, pose[0] + to_x - 0.5, pose[1] + to_y - 0.5)
    slopes = (slope_x, slope_y, to_x * slope_y - to_y * slope_x)
    ratio = distance / width
    left = np.maximum(1.0 - ratio * ratio, 0.0)
    weights = left * left
    normal, gradient = np.empty((3, 3)), np.empty(3)
    for i in range(3):
        weighted = weights * slopes[i]
        gradient[i] = _sum(weighted * distance)
        for j in range(i, 3):
            normal[i, j] = normal[j, i] = _sum(weighted * slopes[j])
    return _Found(
        cost=_sum(1.0 - weights * left),
        weight=_sum(weights),
        squares=_sum(weights * distance * distance),
        normal=normal,
        gradient=gradient,
        beyond=np.where(to_x * slope_x + to_y * slope_y < 0.0, -distance, distance),
        weights=weights,
    )


def _interpolated(
    codes: NDArray[np.int8], distances: NDArray[np.float64], x: NDArray[np.float64], y: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return distance and slopes at points given from the centre of cell (0, 0); outside it is far, and level."""
    rows, cols = codes.shape
    inside = (x >= 0.0) & (y >= 0.0) & (x < cols - 1) & (y < rows - 1)
    col, row = (np.where(inside, np.floor(at), 0.0).astype(np.intp) for at in (x, y))
    a, b = x - col, y - row
    corner = distances[codes[row, col].astype(np.intp) + 128]
    right, up = (0, 1) if cols > 1 else (0, 0), (1, 0) if rows > 1 else (0, 0)
    across = distances[codes[row + right[0], col + right[1]].astype(np.intp) + 128] - corner
    above = distances[codes[row + up[0], col + up[1]].astype(np.intp) + 128]
    opposite = distances[codes[row + up[0], col + right[1]].astype(np.intp) + 128] - above
    low, high = corner + a * across, above + a * opposite
    slope_y = high - low
    distance, slope_x = low + b * slope_y, across + b * (opposite - across)
    far = float(distances[FAR_CODE + 128])
    return np.where(inside, distance, far), np.where(inside, slope_x, 0.0), np.where(inside, slope_y, 0.0)


def _fit(
    codes: NDArray[np.int8],
    distances: NDArray[np.float64],
    heads: NDArray[np.float64],
    box: NDArray[np.float64],
    outlier_cells: float,
) -> NDArray[np.float64]:
    start, low, high = box[:3], box[3:6], box[6:]
    # A side without width would be believed without end.
    half = np.maximum((high - low) / 2, 1e-9)
    belief = _PRIOR / (half * half)
    at = best = np.minimum(np.maximum(start, low), high)
    step, least, width = np.zeros(3), math.inf, float(REACH_CELLS)
    for _ in range(_ROUNDS_MAX):
        found = _look(codes, distances, heads, at.tolist(), width)
        moved = at - start
        cost = found.cost + 3.0 * _sum(belief * moved * moved) / (width * width)
        if cost < least:
            best, least = at, cost
            step = _bounded_step(
                found.normal + np.diag(belief), found.gradient + belief * moved, low - best, high - best
            )
        else:
            # Too far: less of the same step, from the best so far.
            step = step / 4
        if width > outlier_cells:
            # Costs of different widths cannot be compared, so every narrowing begins with no least cost.
            width, least = max(outlier_cells, width * _NARROWING), math.inf
        elif np.abs(step).max() < _CLOSE:
            break
        at = np.minimum(np.maximum(best + step, low), high)
    return best


def _bounded_step(
    normal: NDArray[np.float64], gradient: NDArray[np.float64], low: NDArray[np.float64], high: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return Newton's step; the unknown that would leave its bounds by most stops there, and the others go again."""
    step, free = np.zeros(3), [0, 1, 2]
    while free:
        rest = [-gradient[i] - sum((normal[i, j] * step[j] for j in range(3) if j not in free), 0.0) for i in free]
        found = _solved([[float(normal[i, j]) for j in free] for i in free], [float(value) for value in rest])
        # As shares of the bounds: cells and radians cannot be compared.
        over = [
            max(low[i] - value, value - high[i]) / max(high[i] - low[i], 1e-12)
            for i, value in zip(free, found, strict=True)
        ]
        worst = over.index(max(over))
        if over[worst] <= 0.0:
            step[free] = found
            break
        stopped = free.pop(worst)
        step[stopped] = low[stopped] if found[worst] < low[stopped] else high[stopped]
    return step


def _solved(matrix: list[list[float]], right: list[float]) -> list[float]:
    """Solve a positive definite system of up to three unknowns, by elimination."""
    size = len(right)
    for pivot in range(size):
        for row in range(pivot + 1, size):
            factor = matrix[row][pivot] / matrix[pivot][pivot]
            for col in range(pivot, size):
                matrix[row][col] -= factor * matrix[pivot][col]
            right[row] -= factor * right[pivot]
    for row in reversed(range(size)):
        for col in range(row + 1, size):
            right[row] -= matrix[row][col] * right[col]
        right[row] /= matrix[row][row]
    return right


def _judge(found: _Found) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return quality and covariance."""
    spread = max(found.squares / max(found.weight - HEADS_MIN, 1.0), LEAST_SPREAD_CELLS * LEAST_SPREAD_CELLS)
    together = _together(found.weights * found.beyond)
    known = found.normal / (spread * together)
    # Where the readings say nothing the matrix would have no inverse.
    known = known + np.diag([1 / (sigma * sigma) for sigma in (UNKNOWN_CELLS, UNKNOWN_CELLS, UNKNOWN_RAD)])
    unit = np.eye(3).tolist()
    columns = [_solved(known.tolist(), column) for column in unit]
    mean = found.squares / found.weight if found.weight > 0.0 else 0.0
    return np.array([found.weight, mean, together]), np.array(columns).T


def _together(errors: NDArray[np.float64]) -> float:
    """Return how much neighbours' errors add up, from their correlations over some lags, nearer ones counting more."""
    own = _sum(errors * errors)
    if own <= 0.0:
        return 1.0
    factor = 1.0
    for lag in range(1, min(LAGS, len(errors) - 1) + 1):
        factor += 2.0 * (1.0 - lag / (LAGS + 1)) * _sum(errors[lag:] * errors[:-lag]) / own
    return max(factor, 1.0)


def _sum(values: NDArray[np.float64]) -> float:
    """Add up one after the other, as C does."""
    return float(np.add.accumulate(values)[-1]) if len(values) else 0.0


def scan_poses(
    codes: NDArray[np.int8], costs: NDArray[np.int32], heads: NDArray[np.float64], lattice: Lattice
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """See :class:`.FitKernel`."""
    x_first, x_last, y_first, y_last, first, last = lattice.steps.tolist()
    cols = lattice.step_cells * np.arange(x_first, x_last + 1)
    rows = lattice.step_cells * np.arange(y_first, y_last + 1)[:, None]
    start_x, start_y, start_rad = lattice.start.tolist()
    totals = np.empty((last - first + 1, *lattice.shape), np.int32)
    for turn in range(first, last + 1):
        heading_rad = start_rad + turn * lattice.step_rad
        cos, sin = math.cos(heading_rad), math.sin(heading_rad)
        x = np.floor(start_x + (cos * heads[:, 0] - sin * heads[:, 1]))[:, None, None] + cols
        y = np.floor(start_y + (sin * heads[:, 0] + cos * heads[:, 1]))[:, None, None] + rows
        inside = (x >= 0) & (y >= 0) & (x < codes.shape[1]) & (y < codes.shape[0])
        met = codes[np.where(inside, y, 0).astype(np.intp), np.where(inside, x, 0).astype(np.intp)]
        totals[turn - first] = costs[np.where(inside, met, FAR_CODE).astype(np.intp) + 128].sum(axis=0)
    return totals.min(axis=0), (totals.argmin(axis=0) + first).astype(np.int32)
