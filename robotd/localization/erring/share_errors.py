"""The smallest error radius at which a share of the readings agree, of every cell, in one pass over a map."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robotd.core.reading import RangeReading
from robotd.grid import kernels
from robotd.grid.readings import Readings
from robotd.localization.erring.bodies import draw_bodies
from robotd.localization.erring.error_map import NEVER, ErrorMap


def errors_on(
    the_map: ErrorMap, readings: Sequence[RangeReading], heading_rad: float, share: float = 1.0, *, threads: int = 1
) -> NDArray[np.float32]:
    """Return, for every cell, the smallest whole eps at which a share of the readings are feasible there.

    O(n^2 / 64) for every cell of a body and O(n^2) for every reading and binary digit of the errors; memory
    O(n^2 + 4 KiB m) for each thread.

    Args:
        the_map: prepared, however it reads unknown cells and grazing beams.
        readings: hits and misses, at least one.
        heading_rad: of the robot, in the map frame.
        share: of the readings that must agree, in (0, 1].
        threads: how many threads share the work; the errors do not depend on it.

    Returns:
        ``float32[rows, cols]``, whole numbers, ``inf`` where no eps is great enough.

    Raises:
        ValueError: there is no reading, one of them measured nothing or is longer than 32 000 cells, or the share is
            none.
    """
    wanted = readings_wanted(readings, share)
    bodies = draw_bodies(Readings.of(readings), heading_rad, the_map.spec)
    shared = kernels.in_use().error_radius.share_errors(
        the_map.packed, the_map.distances, the_map.outside, bodies, wanted, threads=threads
    )
    errors = shared.astype(np.float32)
    errors[shared == NEVER] = np.inf
    return errors


def readings_wanted(readings: Sequence[RangeReading], share: float) -> int:
    """Return how many readings a share of them is, at least one.

    Raises:
        ValueError: there is no reading, or the share is none.
    """
    if not readings:
        raise ValueError("expected at least one reading")
    if not 0.0 < share <= 1.0:
        raise ValueError(f"share must lie in (0, 1], got {share}")
    # A share such as 0.55 of 100 comes out just above 55 as a float, and must not ask for one reading more.
    return max(1, math.ceil(share * len(readings) - 1e-9))
