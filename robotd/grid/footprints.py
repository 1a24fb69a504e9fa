"""Shapes to grow obstacles by, and the growing: the Minkowski sum on a grid ([BrownDonald2000]_ sec. 2.3.2)."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray


def disk_footprint(radius_cells: float) -> NDArray[np.bool_]:
    """Return the L2 disk B_eps: the cells whose centre is at most ``radius_cells`` from the centre of the middle one.

    >>> disk_footprint(1).astype(int).tolist()
    [[0, 1, 0], [1, 1, 1], [0, 1, 0]]
    """
    if radius_cells < 0.0:
        raise ValueError(f"radius_cells must not be negative, got {radius_cells}")
    reach = np.arange(-int(radius_cells), int(radius_cells) + 1)
    disk: NDArray[np.bool_] = reach[:, None] ** 2 + reach**2 <= radius_cells**2
    return disk


def touching_footprint(radius_cells: float) -> NDArray[np.bool_]:
    """Return the cells whose square comes nearer than ``radius_cells`` to the centre of the middle one.

    >>> touching_footprint(0.6).astype(int).tolist()
    [[0, 1, 0], [1, 1, 1], [0, 1, 0]]
    """
    if radius_cells < 0.0:
        raise ValueError(f"radius_cells must not be negative, got {radius_cells}")
    most = max(0, int(np.ceil(radius_cells + 0.5)) - 1)
    nearest = np.maximum(np.abs(np.arange(-most, most + 1)) - 0.5, 0.0)
    # Strictly: a disk that only touches a square from outside does not meet it.
    touching: NDArray[np.bool_] = nearest[:, None] ** 2 + nearest**2 < radius_cells**2
    return touching


def dilate(mask: NDArray[np.bool_], footprint: NDArray[np.bool_], *, outside: bool = False) -> NDArray[np.bool_]:
    """Return the Minkowski sum of a set of cells and a footprint centred on its middle cell.

    Cells outside the mask count as ``outside``. Every run of cells in a row of the footprint costs one shifted OR
    of the whole mask (a disk has one run a row), and every power of two up to its width one more.

    Args:
        mask: ``bool[rows, cols]``.
        footprint: ``bool[2h + 1, 2w + 1]``.
        outside: what lies beyond the mask.
    """
    height, width = footprint.shape
    padded = np.pad(mask, ((height // 2,) * 2, (width // 2,) * 2), constant_values=outside)
    windows = _RunWindows(padded)
    grown = np.zeros_like(mask)
    for row, col, length in _runs(footprint):
        # The cells from which this run reaches (r, c) are one run of the padded mask, mirrored.
        top, left = height - 1 - row, width - col - length
        grown |= windows.any_of(length)[top : top + mask.shape[0], left : left + mask.shape[1]]
    return grown


class _RunWindows:
    """Per run length, whether any of that many cells from a cell to the right is set; built by doubling."""

    def __init__(self, mask: NDArray[np.bool_]) -> None:
        self._by_length = {1: mask}

    def any_of(self, length: int) -> NDArray[np.bool_]:
        if length not in self._by_length:
            half = 1 << ((length - 1).bit_length() - 1)
            # Two windows of a power of two, overlapping, cover any length between: an OR may count a cell twice.
            window = self.any_of(half)
            width = window.shape[1] - (length - half)
            self._by_length[length] = window[:, :width] | window[:, length - half :]
        return self._by_length[length]


def _runs(footprint: NDArray[np.bool_]) -> Iterator[tuple[int, int, int]]:
    """Yield ``(row, col, length)`` of every horizontal run of a footprint."""
    for row, line in enumerate(footprint):
        edges = np.flatnonzero(np.diff(line, prepend=False, append=False))
        for start, end in zip(edges[::2], edges[1::2], strict=True):
            yield row, int(start), int(end - start)
