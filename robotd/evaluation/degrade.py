"""A map made worse, as maps of other makers and other days are: what localization must live with, kind by kind.

Each kind takes a map and gives another, and where a pose of the old one lies on it. Pure and repeatable: what is random
comes from a seed.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import IDENTITY, Pose2
from robotd.evaluation.hand_drawn import hand_drawn
from robotd.grid.growth import grown_by_disk
from robotd.grid.image import FREE_GREY, OCCUPIED_GREY, trinary_from_cells
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION, SURELY_OCCUPIED
from robotd.grid.turning import turned

Cells = NDArray[np.uint8]


@dataclass(frozen=True, slots=True, eq=False)
class Degraded:
    """A worse map, and how its poses come from those of the map it was made of."""

    grid: OccupancyGrid
    turn: Pose2 = IDENTITY
    """About the origin of the map frame, after the scale."""
    scale: float = 1.0

    def pose(self, pose: Pose2) -> Pose2:
        """Return where a pose of the better map lies."""
        return self.turn @ Pose2(self.scale * pose.x_m, self.scale * pose.y_m, pose.heading_rad)


def degrade(kind: str, grid: OccupancyGrid, seed: int) -> Degraded:
    """Return a map made worse.

    Raises:
        KeyError: there is no such kind; :data:`KINDS` has them all.
    """
    return KINDS[kind](grid, np.random.default_rng(seed))


def _with(grid: OccupancyGrid, cells: Cells, spec: GridSpec | None = None) -> Degraded:
    return Degraded(OccupancyGrid(spec or grid.spec, cells, grid.settings))


def _thickened(cells_more: int) -> Callable[[OccupancyGrid, np.random.Generator], Degraded]:
    def thicken(grid: OccupancyGrid, _: np.random.Generator) -> Degraded:
        walls = grown_by_disk(grid.cells > NO_INFORMATION, float(cells_more))
        return _with(grid, np.where(walls, np.maximum(grid.cells, SURELY_OCCUPIED), grid.cells).astype(np.uint8))

    return thicken


def _thinned(grid: OccupancyGrid, _: np.random.Generator) -> Degraded:
    """Leave of each wall the cells whose neighbour above or to the left is no wall: a line of one cell."""
    walls = grid.cells > NO_INFORMATION
    padded = np.pad(walls, 1)
    kept = walls & ~(padded[:-2, 1:-1] & padded[1:-1, :-2])
    return _with(grid, np.where(walls & ~kept, np.uint8(NO_INFORMATION), grid.cells).astype(np.uint8))


def _blurred(grid: OccupancyGrid, _: np.random.Generator) -> Degraded:
    """Mean over 3 x 3 cells, as a picture that was scaled: soft greys beside every wall."""
    padded = np.pad(grid.cells.astype(np.float64), 1, mode="edge")
    rows, cols = grid.cells.shape
    total = sum(padded[row : row + rows, col : col + cols] for row in range(3) for col in range(3))
    return _with(grid, np.rint(np.asarray(total) / 9).astype(np.uint8))


def _coarse(resolution_m: float) -> Callable[[OccupancyGrid, np.random.Generator], Degraded]:
    def coarsen(grid: OccupancyGrid, _: np.random.Generator) -> Degraded:
        """Let the surest wall of a block speak for it, then the surest free cell."""
        by = max(1, round(resolution_m / grid.spec.resolution_m))
        rows, cols = (-(-side // by) for side in grid.spec.shape)
        padded = np.full((rows * by, cols * by), NO_INFORMATION, np.uint8)
        padded[: grid.spec.rows, : grid.spec.cols] = grid.cells
        blocks = padded.reshape(rows, by, cols, by)
        most, least = blocks.max(axis=(1, 3)), blocks.min(axis=(1, 3))
        spec = GridSpec(by * grid.spec.resolution_m, grid.spec.origin_x_m, grid.spec.origin_y_m, (int(rows), int(cols)))
        return _with(grid, np.where(most > NO_INFORMATION, most, least), spec)

    return coarsen


def _trinary(grid: OccupancyGrid, _: np.random.Generator) -> Degraded:
    """As it comes back from three greys, like most maps that are passed on."""
    values = np.full(256, NO_INFORMATION, np.uint8)
    values[[OCCUPIED_GREY, FREE_GREY]] = SURELY_OCCUPIED, 255 - FREE_GREY
    return _with(grid, values[trinary_from_cells(grid.cells)])


def _refurnished(grid: OccupancyGrid, randomness: np.random.Generator) -> Degraded:
    """Take a fifth of the wall cells away, in pieces of half a metre, and set up fifty chairs of 0.4 m."""
    cells = grid.cells.copy()
    piece = max(1, round(0.5 / grid.spec.resolution_m))
    blocks = randomness.random((-(-grid.spec.rows // piece), -(-grid.spec.cols // piece))) < 0.2
    gone = np.kron(blocks, np.ones((piece, piece), np.bool_))[: grid.spec.rows, : grid.spec.cols]
    cells[gone & (cells > NO_INFORMATION)] = 255 - FREE_GREY
    places = np.argwhere(grid.cells < NO_INFORMATION)
    side = max(1, round(0.4 / grid.spec.resolution_m))
    for row, col in places[randomness.integers(len(places), size=50)] if len(places) else ():
        cells[row : row + side, col : col + side] = SURELY_OCCUPIED
    return _with(grid, cells)


def _turned(degrees: float) -> Callable[[OccupancyGrid, np.random.Generator], Degraded]:
    def turn(grid: OccupancyGrid, _: np.random.Generator) -> Degraded:
        """Turn it about the origin of its frame."""
        by, spec = Pose2(0.0, 0.0, math.radians(degrees)), grid.spec
        corner = GridSpec(spec.resolution_m, *by.transform(spec.origin_x_m, spec.origin_y_m), spec.shape)
        # About the frame's origin, as a map that was made with another heading: poses turn with it.
        cells, to = turned(grid.cells, corner, by.heading_rad)
        return Degraded(OccupancyGrid(to, cells, grid.settings), by)

    return turn


def _scaled(by: float) -> Callable[[OccupancyGrid, np.random.Generator], Degraded]:
    def scale(grid: OccupancyGrid, _: np.random.Generator) -> Degraded:
        """Make every cell larger, as by a wheel of the wrong size."""
        spec = grid.spec
        to = GridSpec(by * spec.resolution_m, by * spec.origin_x_m, by * spec.origin_y_m, spec.shape)
        return Degraded(OccupancyGrid(to, grid.cells, grid.settings), scale=by)

    return scale


def _unknown_free(grid: OccupancyGrid, _: np.random.Generator) -> Degraded:
    """Write unknown as free, as programs do that know two values."""
    return _with(grid, np.where(grid.cells == NO_INFORMATION, np.uint8(255 - FREE_GREY), grid.cells))


def _drawn_by_hand(grid: OccupancyGrid, _: np.random.Generator) -> Degraded:
    return _with(grid, hand_drawn(grid))


KINDS: dict[str, Callable[[OccupancyGrid, np.random.Generator], Degraded]] = {
    "thicker-1": _thickened(1),
    "thicker-2": _thickened(2),
    "thicker-3": _thickened(3),
    "thinned": _thinned,
    "blurred": _blurred,
    "coarse-100mm": _coarse(0.1),
    "coarse-200mm": _coarse(0.2),
    "trinary": _trinary,
    "refurnished": _refurnished,
    "turned-30deg": _turned(30.0),
    "scaled-1percent": _scaled(1.01),
    "unknown-free": _unknown_free,
    "hand-drawn": _drawn_by_hand,
}
"""By the word for it on the command line."""
