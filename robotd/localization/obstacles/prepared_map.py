"""A map made ready for localization: all that is worked out once for a map, whatever the readings are."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.grid.binary import BinaryMap
from robotd.grid.kernels.shared.packed_map import PackedMap
from robotd.grid.packing import repacked
from robotd.grid.ternary import TernaryMap
from robotd.grid.window import CellWindow
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.obstacles.unknown_cells import UnknownCells


@dataclass(frozen=True, slots=True, eq=False)
class PreparedMap:
    """Obstacles, where they are, and what is derived from them; shared by all that localize on the map."""

    spec: GridSpec
    obstacles: Obstacles
    error_radius_cells: float
    """The paper's eps: bodies of readings end this much before their heads. The obstacles were grown by it."""
    packed: PackedMap
    """The obstacles as the kernels need them."""

    @classmethod
    def of(cls, obstacles: Obstacles, spec: GridSpec, error_radius_cells: float) -> "PreparedMap":
        """Prepare obstacles that lie where ``spec`` says.

        Raises:
            ValueError: they do not fit there.
        """
        if obstacles.shape != spec.shape:
            raise ValueError(f"expected obstacles of shape {spec.shape}, got {obstacles.shape}")
        packed = PackedMap.of(
            obstacles.free,
            obstacles.blocking,
            obstacles.grown,
            outside_blocks=obstacles.outside_blocks,
            outside_ends=obstacles.outside_ends,
            blocked_by=obstacles.blocked_by,
        )
        return cls(spec, obstacles, error_radius_cells, packed)

    @classmethod
    def of_binary(cls, binary: BinaryMap, error_radius_cells: float) -> "PreparedMap":
        """Prepare a map as the paper reads it: unknown cells are obstacles."""
        return cls.of(Obstacles.of(binary.occupied, error_radius_cells), binary.spec, error_radius_cells)

    def changed(
        self,
        ternary: TernaryMap,
        unknown: UnknownCells,
        changed: CellWindow,
        before_cores: NDArray[np.bool_] | None = None,
    ) -> "PreparedMap":
        """Return this map after its cells changed in a window alone; this one stays as it is."""
        radius_cells = self.error_radius_cells
        obstacles = self.obstacles.updated(ternary, unknown, radius_cells, changed, before_cores)
        # A disk reaches whole cells along a row or a column, so rounding its radius down loses none of them.
        return self.updated(obstacles, changed.moved(obstacles.rim).grown(int(radius_cells), obstacles.free.shape))

    def updated(self, obstacles: Obstacles, changed: CellWindow) -> "PreparedMap":
        """Return this map with obstacles that differ from its own in a window alone; this one stays as it is.

        Counts on it are those on the map prepared from nothing. O(cells of the window), and a copy of what is packed.

        Args:
            obstacles: the new ones, of the same map and read in the same way.
            changed: holds all cells in which they differ, counted with the rim: those that changed in the map, grown by
                the error radius.
        """
        packed = repacked(self.packed, obstacles.free, obstacles.blocking, obstacles.grown, changed)
        return replace(self, obstacles=obstacles, packed=packed)
