"""What is left open on a map: stretches of the border between seen and unseen ground that the robot could pass."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.contract.ways import Point
from robotd.core.grid_spec import GridSpec
from robotd.core.rectangle import Rectangle
from robotd.grid.footprints import dilate
from robotd.planning.distance_field import distance_field
from robotd.planning.line_of_sight import Cell

_SQUARE = np.ones((3, 3), np.bool_)
_AROUND = tuple((row, col) for row in (-1, 0, 1) for col in (-1, 0, 1) if (row, col) != (0, 0))


@dataclass(frozen=True, slots=True)
class Opening:
    """One stretch of the border."""

    at_m: Point
    """That of its cells which is nearest to its middle, map frame."""
    width_m: float
    """From end to end."""
    is_near: bool
    """Whether the robot can come as near as to see it from where it fits."""


def openings(
    spec: GridSpec,
    free: NDArray[np.bool_],
    unknown: NDArray[np.bool_],
    near: NDArray[np.bool_],
    *,
    robot: Cell,
    within: Rectangle,
    width_min_m: float,
) -> tuple[Opening, ...]:
    """Return the openings within bounds, the widest first.

    Args:
        spec: where the map lies.
        free: ``bool[rows, cols]``.
        unknown: ``bool[rows, cols]``.
        near: ``bool[rows, cols]``, where the robot can come near.
        robot: the cell that it stands in.
        within: what is explored.
        width_min_m: what is narrower is none.
    """
    border = _connected(free, robot) & _beside(unknown & _inside(spec, within))
    pieces = (np.array(piece) for piece in _pieces(border))
    found = [opening for piece in pieces if (opening := _opening(spec, piece, near)).width_m >= width_min_m]
    return tuple(sorted(found, key=lambda opening: (-opening.width_m, opening.at_m)))


def _connected(free: NDArray[np.bool_], robot: Cell) -> NDArray[np.bool_]:
    """Return the free cells that hang together with the robot's by more than the thickness of a beam.

    A wrong range runs through walls, and leaves a strip of free cells behind them that nobody can look into.
    """
    broad = ~dilate(~free, _SQUARE, outside=True)
    return free & dilate(np.isfinite(distance_field(broad, robot)), _SQUARE)


def _beside(cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the cells that share a side with one of some."""
    padded = np.pad(cells, 1)
    beside: NDArray[np.bool_] = padded[:-2, 1:-1] | padded[2:, 1:-1] | padded[1:-1, :-2] | padded[1:-1, 2:]
    return beside


def _inside(spec: GridSpec, within: Rectangle) -> NDArray[np.bool_]:
    west_m, south_m = spec.centre_of(0, 0)
    xs_m = west_m + np.arange(spec.cols) * spec.resolution_m
    ys_m = south_m + np.arange(spec.rows) * spec.resolution_m
    in_rows = (ys_m >= within.south_m) & (ys_m <= within.north_m)
    in_cols = (xs_m >= within.west_m) & (xs_m <= within.east_m)
    return in_rows[:, None] & in_cols


def _pieces(cells: NDArray[np.bool_]) -> list[list[tuple[int, int]]]:
    """Part cells into pieces that touch by sides or corners, each from its first cell on."""
    # A dict and not a set: it keeps its order, so pieces come out the same in every process.
    left = dict.fromkeys((row, col) for row, col in np.argwhere(cells).tolist())
    pieces = []
    while left:
        piece = [left.popitem()[0]]
        for row, col in piece:  # which grows meanwhile
            for along, aside in _AROUND:
                if (cell := (row + along, col + aside)) in left:
                    del left[cell]
                    piece.append(cell)
        pieces.append(sorted(piece))
    return pieces


def _opening(spec: GridSpec, piece: NDArray[np.intp], near: NDArray[np.bool_]) -> Opening:
    spread = np.ptp(piece, axis=0) + 1
    # A cell of it and not its mean, which of a bent stretch may lie in a wall.
    middle = np.hypot(*(piece - piece.mean(axis=0)).T).argmin()
    row, col = piece[middle].tolist()
    is_near = bool(near[piece[:, 0], piece[:, 1]].any())
    return Opening(spec.centre_of(row, col), float(np.hypot(*spread)) * spec.resolution_m, is_near)
