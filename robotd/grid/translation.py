"""Grid-level moves: translation ([BrownDonald2000]_ sec. 2.3.2).

The rest of the paper's grid-level operations, cell-wise arithmetic and logic, are NumPy's own operators; the
convolution (Minkowski sum) is :func:`robotd.grid.footprints.dilate`.
"""

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Scalar = TypeVar("Scalar", bound=np.generic)


def translated(
    cells: NDArray[Scalar], row: int, col: int, *, outside: float, shape: tuple[int, int] | None = None
) -> NDArray[Scalar]:
    """Return ``moved`` with ``moved[r, c] = cells[r + row, c + col]``; the contents move by ``(-row, -col)``.

    Args:
        cells: ``[rows, cols]``.
        row: how many rows up to look.
        col: how many columns on to look.
        outside: what lies beyond the grid.
        shape: of the result, that of ``cells`` if not given.
    """
    moved = np.full(shape or cells.shape, outside, cells.dtype)
    here_rows, there_rows = _overlap(moved.shape[0], cells.shape[0], row)
    here_cols, there_cols = _overlap(moved.shape[1], cells.shape[1], col)
    moved[here_rows, here_cols] = cells[there_rows, there_cols]
    return moved


def _overlap(moved_size: int, size: int, step: int) -> tuple[slice, slice]:
    """Return which indices of the moved axis look at which indices of the old one."""
    first = max(0, -step)
    # A move farther than the grid leaves no overlap: an empty slice, not one that counts from the end.
    last = max(first, min(moved_size, size - step))
    return slice(first, last), slice(first + step, last + step)
