"""Which cells a beam runs through: one rule, used for maps and for blocked sets alike.

The rule. A ray starts at a point and is **sampled once per cell of its dominant axis**: at ``start + k * step``
for ``k = 0, 1, 2, ...``, where ``step`` is its direction divided by ``max(|cos|, |sin|)``, so that one
coordinate changes by exactly one cell. Sample ``k`` belongs to the ray as long as it lies nearer than its
length. Hence:

- the cell of the start is always in, whatever the (positive) length; the end is open;
- consecutive cells share a side or a corner, and no cell comes twice (the paper's pixelized vector, fig. 16);
- the cells of a shorter ray are a prefix of those of a longer one in the same direction;
- the last cell is the cell of the end point or a neighbour of it.

Lengths and positions are in cells, positions as ``(row, col)`` with cell ``(r, c)`` covering
``[r, r+1) x [c, c+1)``; bearings run counter-clockwise from +col. [BrownDonald2000]_ sec. 2.3.2, 2.3.3.
"""

import numpy as np
from numpy.typing import NDArray


def ray_cells(
    starts: NDArray[np.float64],
    bearings_rad: NDArray[np.float64],
    lengths_cells: NDArray[np.float64],
    shape: tuple[int, int],
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the cells of many rays, clipped to a grid.

    Args:
        starts: ``float64[n, 2]``, ``(row, col)``, inside the grid or not.
        bearings_rad: ``float64[n]``.
        lengths_cells: ``float64[n]``.
        shape: ``(rows, cols)`` of the grid.

    Returns:
        ``ray: intp[m]``, ascending, which ray each cell belongs to, and ``cell: intp[m]``, flat indices
        ``row * cols + col``, from start to end. Time and memory are O(m), however long the rays are.
    """
    steps = ray_steps(bearings_rad)
    # Clipped before the samples are made: else a long miss would take memory for every cell beyond the grid.
    first, last = _inside_along_dominant_axis(starts, steps, sample_counts(bearings_rad, lengths_cells), shape)
    counts = last - first
    ray = np.repeat(np.arange(len(counts)), counts)
    k = np.arange(len(ray)) - np.repeat(np.cumsum(counts) - counts - first, counts)
    cells = np.floor(starts[ray] + k[:, None] * steps[ray]).astype(np.intp)
    # Looked at again: the bounds above have a sample to spare, and say nothing of the other axis.
    inside = ((cells >= 0) & (cells < shape)).all(axis=1)
    return ray[inside], cells[inside] @ np.array([shape[1], 1])


def ray_steps(bearings_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``float64[n, 2]``: the ``(row, col)`` step from one sample to the next; one of them is 1 or -1."""
    directions = np.stack((np.sin(bearings_rad), np.cos(bearings_rad)), axis=1)
    steps: NDArray[np.float64] = directions / np.abs(directions).max(axis=1, keepdims=True)
    return steps


def sample_counts(bearings_rad: NDArray[np.float64], lengths_cells: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how many samples lie nearer than the length, whole numbers as floats so that no length overflows."""
    per_cell = np.maximum(np.abs(np.cos(bearings_rad)), np.abs(np.sin(bearings_rad)))
    counts: NDArray[np.float64] = np.ceil(np.maximum(lengths_cells, 0.0) * per_cell)
    return counts


def _inside_along_dominant_axis(
    starts: NDArray[np.float64], steps: NDArray[np.float64], counts: NDArray[np.float64], shape: tuple[int, int]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Bound the samples ``first <= k < last`` that can lie in the grid, one to spare at either end."""
    axis = np.abs(steps).argmax(axis=1)
    rays = np.arange(len(axis))
    start, forward, size = starts[rays, axis], steps[rays, axis] > 0.0, np.array(shape)[axis]
    first = np.clip(np.floor(np.where(forward, -start, start - size)) - 1, 0, counts)
    last = np.clip(np.ceil(np.where(forward, size - start, start)) + 1, first, counts)
    return first.astype(np.intp), last.astype(np.intp)
