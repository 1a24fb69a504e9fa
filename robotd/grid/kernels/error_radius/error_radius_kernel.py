"""Readings drawn on the grid at one heading, each as long as it is."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.shared.packed_map import PackedMap


@dataclass(frozen=True, slots=True, eq=False)
class Bodies:
    """Readings drawn on the grid at one heading, each as long as it is."""

    chains: NDArray[np.int32]
    """``int32[cells, 2]``: ``(row, col)`` offsets from the robot's cell, body after body."""
    lengths: NDArray[np.uint16]
    """``uint16[cells]``: the error radius that shortens the body until this cell is not in it; 65535 if none
    does."""
    readings: NDArray[np.int32]
    """``int32[readings, 4]``: first cell of the body and end; ``(row, col)`` of the head, ``NO_HEAD`` twice for a
    miss."""


class ErrorRadiusKernel(Protocol):
    """Finding the smallest error radius of every cell."""

    def share_errors(
        self,
        the_map: PackedMap,
        distances: NDArray[np.uint16],
        outside: int,
        bodies: Bodies,
        wanted: int,
        *,
        threads: int = 1,
    ) -> NDArray[np.uint16]:
        """Return the smallest whole error radius with which this many readings are feasible, for every cell.

        Args:
            the_map: where the robot may stand, and what stops a beam; what is grown is not used.
            distances: ``uint16[rows, cols]``: how far the nearest cell is that ends a beam, rounded up.
            outside: the same for what lies outside.
            bodies: the readings, drawn at one heading with an error radius of 0; no length but 65535 is over 32767.
            wanted: how many readings must be feasible, at least 1.
            threads: how many threads share the work, where it can be shared; the result does not depend on it.

        Returns:
            ``uint16[rows, cols]``, 65535 where no radius is large enough and where the robot cannot stand.
            O(cells / 64) for every cell of a body, and O(cells) for every reading and binary digit of the errors.
        """
