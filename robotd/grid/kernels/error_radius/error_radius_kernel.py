"""Readings drawn on the grid at one heading, each as long as it is."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class Bodies:
    """Readings drawn on the grid at one heading, each as long as it is."""

    chains: NDArray[np.int32]
    """``int32[cells, 2]``: ``(row, col)`` offsets from the robot's cell, body after body."""
    lengths: NDArray[np.uint16]
    """``uint16[cells]``: the error radius that shortens the body so much that this cell is not in it; 65535 if none
    does."""
    readings: NDArray[np.int32]
    """``int32[readings, 4]``: first cell of the body and end; ``(row, col)`` of the head, ``NO_HEAD`` twice for a
    miss."""
