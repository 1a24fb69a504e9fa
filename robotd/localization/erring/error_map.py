"""A map made ready for the smallest error: what stops beams, and how far it is to what ends them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.grid.binary import BinaryMap
from robotd.grid.distance import distance_transform
from robotd.grid.kernels.shared.packed_map import PackedMap
from robotd.localization.obstacles.beam_obstacles import Obstacles

NEVER = int(np.iinfo(np.uint16).max)
"""In place of an error radius: none is large enough."""


@dataclass(frozen=True, slots=True, eq=False)
class ErrorMap:
    """Obstacles, where they are, and what is derived from them once for all readings and headings."""

    spec: GridSpec
    packed: PackedMap
    distances: NDArray[np.uint16]
    """``uint16[rows, cols]``: how far it is to the nearest cell that can end a beam, in whole cells, rounded up; 65535
    if there is none."""
    outside: int
    """The same for what lies outside: 0 or 65535."""

    @classmethod
    def of(cls, obstacles: Obstacles, spec: GridSpec) -> "ErrorMap":
        """Prepare obstacles, read from a map in whatever way, but grown by an error radius of 0."""
        # Rounded up: of all whole error radii, the least that reaches.
        distances = np.ceil(distance_transform(obstacles.grown, outside=obstacles.outside_ends))
        packed = PackedMap.of(
            obstacles.free,
            obstacles.blocking,
            obstacles.grown,
            outside_blocks=obstacles.outside_blocks,
            outside_ends=obstacles.outside_ends,
            blocked_by=obstacles.blocked_by,
        )
        never = np.minimum(distances, NEVER).astype(np.uint16)
        return cls(spec, packed, never, 0 if obstacles.outside_ends else NEVER)

    @classmethod
    def of_binary(cls, binary: BinaryMap) -> "ErrorMap":
        """Prepare a map as the paper reads it: unknown cells are obstacles."""
        return cls.of(Obstacles.of(binary.occupied, 0.0), binary.spec)
