"""What the latest sweep that met a cell said of it: that a beam ran through, or that one ended in it.

An occupancy value weighs all that was ever said. Anyone who is about to drive somewhere wants to know of what was seen
there last, too: a chair that was put where ten sweeps saw nothing.
"""

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.map_stop import MapStop
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading
from robotd.grid import kernels
from robotd.grid.readings import Readings

NOTHING, PASSED, HIT = 0, 1, 2
"""Values of a cell: no sweep met it; beams ran through it and none ended in it; one ended in it."""

# Constant: whatever a cell held before, the latest sweep has the last word.
_TABLES = (np.full(256, PASSED, np.uint8), np.full(256, HIT, np.uint8))


def latest_with(
    latest: NDArray[np.uint8], readings: tuple[RangeReading, ...], map_from_robot: Pose2, spec: GridSpec
) -> NDArray[np.uint8]:
    """Return what was said last with one more sweep, ``uint8[rows, cols]``; what went in is left as it is."""
    # A copy: a mission that is stopped goes on with the generation before, and with what was seen last by then.
    found = latest.copy()
    # At once: where a beam ends and its neighbours graze by, the hit counts, whatever their order.
    kernels.in_use().insert.insert_sweep(found, Readings.of(readings).rows, map_from_robot, spec, _TABLES, at_once=True)
    return found


def seen_from(stop: MapStop, spec: GridSpec) -> NDArray[np.uint8]:
    """Return what one stop says of each cell, ``uint8[rows, cols]``."""
    seen, beams = np.full(spec.shape, NOTHING, np.uint8), stop.beams(misses=True)
    kernels.in_use().insert.insert_sweep(seen, beams, stop.map_from_robot, spec, _TABLES, at_once=True)
    return seen
