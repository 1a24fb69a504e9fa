"""What a map means to a range reading: where the robot may stand, what stops a beam, what can end it.

[BrownDonald2000]_ sec. 2.2.1 has one set of obstacles M for all three. Two facts about real maps part them:

- A cell that was never seen is an obstacle in the paper. It may rather stop beams without ever ending one ("nothing is
  known behind it"), or not be there at all; :class:`UnknownCells` names the three readings.
- A beam that grazes along a wall meets a cell of it by rounding. A body may therefore count as blocked only if it
  meets ``blocked_by`` obstacle cells, 1 being the paper's definition.

A head may lie outside the grid and within the error radius of a wall at its border, as on a map that was cropped there.
So where nothing ends outside, the cells of a rim as wide as that radius are kept all round.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from robotd.grid.growth import grown_by_disk, grown_by_disk_updated
from robotd.grid.ternary import TernaryMap
from robotd.grid.window import CellWindow
from robotd.localization.obstacles.unknown_cells import UnknownCells


@dataclass(frozen=True, slots=True, eq=False)
class Obstacles:
    """A map as localization needs it, made once for all readings; ``rows`` and ``cols`` are its own and two rims."""

    free: NDArray[np.bool_]
    """``bool[rows, cols]``: the cells where the robot may stand; elsewhere nothing is feasible."""
    blocking: NDArray[np.bool_]
    """``bool[rows, cols]``: the cells that stop a beam, the M of E_eps. Never free ones."""
    grown: NDArray[np.bool_]
    """``bool[rows, cols]``: the cells that can end a beam, grown by the error radius: the M (+) B_eps of D_eps."""
    outside_blocks: bool = True
    """Whether what lies outside the grid stops a beam."""
    outside_ends: bool = True
    """Whether a reading can end outside the grid."""
    blocked_by: int = 1
    """How many blocking cells a body must meet to be blocked, 1 or 2."""
    rim: int = 0
    """How many cells of what lies outside are kept on each side of the map, for heads to end in."""

    def __post_init__(self) -> None:
        """Refuse what contradicts itself."""
        if not self.free.shape == self.blocking.shape == self.grown.shape:
            raise ValueError(f"shapes differ: {self.free.shape}, {self.blocking.shape}, {self.grown.shape}")
        if (self.free & self.blocking).any():
            raise ValueError("a cell cannot be both free and blocking")
        if self.blocked_by not in (1, 2):
            raise ValueError(f"blocked_by must be 1 or 2, got {self.blocked_by}")

    @classmethod
    def of(cls, occupied: NDArray[np.bool_], error_radius_cells: float) -> "Obstacles":
        """Return the paper's: ``bool[rows, cols]`` is all obstacle or free, and what lies outside is obstacle."""
        return cls(~occupied, occupied, grown_by_disk(occupied, error_radius_cells, outside=True))

    @classmethod
    def of_map(
        cls,
        ternary: TernaryMap,
        unknown: UnknownCells,
        error_radius_cells: float,
        *,
        blocked_by: int = 1,
        before_cores: NDArray[np.bool_] | None = None,
        rim: int = 0,
    ) -> "Obstacles":
        """Read a three-valued map; ``OCCUPIED`` with ``blocked_by = 1`` is the paper's.

        ``before_cores``, ``bool[rows, cols]``, are cells of thick walls that stop no beam, but may end one. ``rim`` is
        as wide as the error radius where nothing ends outside; elsewhere nothing is gained by one.
        """
        unseen_ends, unseen_blocks = unknown is UnknownCells.OCCUPIED, unknown is not UnknownCells.FREE
        # What lies outside the grid was never seen: it is padded with what the unknown is taken for.
        ending = np.pad(_ending(ternary, unknown), rim, constant_values=unseen_ends)
        return cls(
            free=np.pad(ternary.vacant, rim),
            blocking=np.pad(_blocking(ternary, unknown, before_cores), rim, constant_values=unseen_blocks),
            grown=grown_by_disk(ending, error_radius_cells, outside=unseen_ends),
            outside_blocks=unseen_blocks,
            outside_ends=unseen_ends,
            blocked_by=blocked_by,
            rim=rim,
        )

    @property
    def shape(self) -> tuple[int, int]:
        """``(rows, cols)`` of the map, without the rim."""
        rows, cols = self.free.shape
        return rows - 2 * self.rim, cols - 2 * self.rim

    def on_map(self, mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return a mask of these without its rim: one cell for each of the map's; a view."""
        rows, cols = self.shape
        on_map: NDArray[np.bool_] = mask[self.rim : self.rim + rows, self.rim : self.rim + cols]
        return on_map

    def updated(
        self,
        ternary: TernaryMap,
        unknown: UnknownCells,
        error_radius_cells: float,
        changed: CellWindow,
        before_cores: NDArray[np.bool_] | None = None,
    ) -> "Obstacles":
        """Read a map that differs from the one these are of in a window alone, in the same way as that one.

        The obstacles differ in no cell that is farther than the error radius from the window.
        """
        ending = np.pad(_ending(ternary, unknown), self.rim, constant_values=self.outside_ends)
        blocking = _blocking(ternary, unknown, before_cores)
        return replace(
            self,
            free=np.pad(ternary.vacant, self.rim),
            blocking=np.pad(blocking, self.rim, constant_values=self.outside_blocks),
            grown=grown_by_disk_updated(
                self.grown, ending, changed.moved(self.rim), error_radius_cells, outside=self.outside_ends
            ),
        )


def _blocking(ternary: TernaryMap, unknown: UnknownCells, before_cores: NDArray[np.bool_] | None) -> NDArray[np.bool_]:
    # What lies in the unknown stops a beam even where it cannot end one: nobody saw through it.
    blocking = ternary.occupied if unknown is UnknownCells.FREE else ~ternary.vacant
    return blocking if before_cores is None else blocking & ~before_cores


def _ending(ternary: TernaryMap, unknown: UnknownCells) -> NDArray[np.bool_]:
    return ~ternary.vacant if unknown is UnknownCells.OCCUPIED else ternary.occupied
