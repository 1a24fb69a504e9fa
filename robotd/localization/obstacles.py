"""What a map means to a range reading: where the robot may stand, what stops a beam, what can end it.

[BrownDonald2000]_ sec. 2.2.1 has one set of obstacles M for all three. Two facts about real maps part them:

- A cell that was never seen is an obstacle in the paper. It may rather stop beams without ever ending one ("nothing is
  known behind it"), or not be there at all; :class:`UnknownCells` names the three readings.
- A beam that grazes along a wall meets a cell of it by rounding. A body may therefore count as blocked only if it
  meets ``blocked_by`` obstacle cells, 1 being the paper's definition.
"""

import enum
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.grid.footprints import dilate, disk_footprint
from robotd.grid.ternary import TernaryMap


class UnknownCells(enum.StrEnum):
    """What a cell is taken for that nobody has seen."""

    OCCUPIED = "occupied"
    """An obstacle, as in the paper."""
    BLOCKS_ONLY = "blocks_only"
    """It stops every beam, but no reading can end in it."""
    FREE = "free"
    """No obstacle; but the robot does not stand there either."""


@dataclass(frozen=True, slots=True, eq=False)
class Obstacles:
    """A map as localization needs it, made once for all readings."""

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
        return cls(~occupied, occupied, dilate(occupied, disk_footprint(error_radius_cells), outside=True))

    @classmethod
    def of_map(
        cls, ternary: TernaryMap, unknown: UnknownCells, error_radius_cells: float, *, blocked_by: int = 1
    ) -> "Obstacles":
        """Read a three-valued map; ``OCCUPIED`` with ``blocked_by = 1`` is the paper's."""
        occupied, disk = ternary.occupied, disk_footprint(error_radius_cells)
        unseen_ends = unknown is UnknownCells.OCCUPIED
        unseen_blocks = unknown is not UnknownCells.FREE
        ending = occupied | ternary.unknown if unseen_ends else occupied
        blocking = ~ternary.vacant if unseen_blocks else occupied
        return cls(
            free=ternary.vacant,
            blocking=blocking,
            grown=dilate(ending, disk, outside=unseen_ends),
            outside_blocks=unseen_blocks,
            outside_ends=unseen_ends,
            blocked_by=blocked_by,
        )
