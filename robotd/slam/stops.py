"""Stops: what was seen at each, and how the robot came there."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.motion_error import Travel
from robotd.grid.readings import Readings
from robotd.localization.outcome import Outcome


@dataclass(frozen=True, slots=True, eq=False)
class PlacedStop:
    """One stop; where it lies on the map is another matter, and may change as long as the map is made."""

    readings: Readings
    """Hits and misses, robot frame."""
    travel: Travel
    """Since the stop before, as odometry tells it."""
    outcome: Outcome
    """What came of placing it."""
    segment: int = 0
    """Stops of one segment were placed on each other; segments hang together by odometry and by loops."""

    is_laid: bool = True
    """Whether maps are made of it: what speaks against the map is held back."""


Poses = NDArray[np.float64]
"""``float64[n, 3]``: x, y [m] and heading [rad], map frame, of all stops in their order."""
