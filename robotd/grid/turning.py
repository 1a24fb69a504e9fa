"""Cells turned by any angle, on a grid along the axes again."""

import math

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import MAX_SIDE_CELLS, GridSpec
from robotd.grid.tables import NO_INFORMATION


def turned(cells: NDArray[np.uint8], spec: GridSpec, yaw_rad: float) -> tuple[NDArray[np.uint8], GridSpec]:
    """Return cells turned about the lower-left corner, on a grid along the axes that holds all of them.

    Each new cell is what lies at its centre, and unknown where nothing does; a turn by quarters loses nothing.

    Args:
        cells: ``uint8[rows, cols]``, row 0 at the smallest y.
        spec: where they would lie without the turn.
        yaw_rad: counter-clockwise.

    Raises:
        ValueError: it would be larger than any map.
    """
    cos, sin = _quarters(math.cos(yaw_rad)), _quarters(math.sin(yaw_rad))
    rows, cols = spec.shape
    corners = np.array([(0, 0), (cols, 0), (0, rows), (cols, rows)]) @ np.array([[cos, sin], [-sin, cos]])
    low, high = np.floor(corners.min(axis=0) + 1e-9), np.ceil(corners.max(axis=0) - 1e-9)
    width, height = (high - low).astype(int).tolist()
    if max(width, height) > MAX_SIDE_CELLS:
        raise ValueError(f"turned it would have {width} x {height} cells; at most {MAX_SIDE_CELLS} a side")
    x, y = np.meshgrid(low[0] + np.arange(width) + 0.5, low[1] + np.arange(height) + 0.5)
    row, col = np.floor(-sin * x + cos * y).astype(int), np.floor(cos * x + sin * y).astype(int)
    inside = (row >= 0) & (row < rows) & (col >= 0) & (col < cols)
    found = np.full((height, width), NO_INFORMATION, np.uint8)
    found[inside] = cells[row[inside], col[inside]]
    origin = low * spec.resolution_m
    return found, GridSpec(
        spec.resolution_m, spec.origin_x_m + float(origin[0]), spec.origin_y_m + float(origin[1]), (height, width)
    )


def _quarters(value: float) -> float:
    """Return a sine or cosine; that of a quarter turn exactly, as yaws are written with a few decimals."""
    nearest = round(value)
    return float(nearest) if abs(value - nearest) < 1e-9 else value
