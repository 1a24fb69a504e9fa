"""How far must the readings be trusted? The smallest error radius at which some pose explains enough of them.

The varying-epsilon method of [BrownDonald2000]_ sec. 2.2.1: instead of counting readings for one eps, ask for the
smallest whole eps at which all readings, or a share of them, agree somewhere. There are two ways, with one result:

- **search** (sec. 2.3.3): feasible poses only become more as eps grows, so the smallest eps is found by binary search,
  a rank over all readings at each step;
- **one pass**: a cell p and a reading z have a smallest eps of their own::

      e(p, z) = max( distance from the end of z to the nearest obstacle,      which D_eps asks for
                     length of z - way along z to the first obstacle )        which E_eps asks for

  so the smallest eps for a share of the readings is, cell by cell, a quantile of e, and the smallest of all is its
  least value.

The two agree exactly because e is taken from the very cells that D and E are made of. The distance is that between the
centre of the cell of the probe's head and the centres of obstacle cells, rounded up. The way to the first obstacle is
the number of samples of the body before it; of all whole eps, the one is taken at which :mod:`robotd.grid.ray` draws no
more samples than that. A pose whose own cell, or whose cell where the beam begins, is occupied is feasible at no eps.

At 256 x 256, 300 readings, heading known (``make bench ONLY=erring``, other programs running): every cell in 51 ms on
one thread, 8.7 s by floods in NumPy; the best cell alone, by search, 3.4 s.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.reading import RangeReading
from robotd.grid.binary import BinaryMap
from robotd.grid.distance import distance_transform
from robotd.grid.translation import translated
from robotd.localization.erring.bodies import RANGE_CELLS_MAX, errors_by_samples, reach_cells
from robotd.localization.erring.error_map import ErrorMap
from robotd.localization.erring.share_errors import errors_on, readings_wanted
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.reference.directional_flood import directional_flood
from robotd.localization.reference.feasible_poses import feasible_poses
from robotd.localization.reference.floods import UNREACHED
from robotd.localization.reference.probe import Probe, probe_of


@dataclass(frozen=True, slots=True, eq=False)
class SmallestError:
    """The smallest eps at which enough readings agree on some pose, and those poses."""

    error_cells: int
    cells: NDArray[np.intp]
    """``intp[n, 2]`` as ``(row, col)``, in order."""


def smallest_error(
    binary: BinaryMap, readings: Sequence[RangeReading], heading_rad: float, share: float = 1.0
) -> SmallestError | None:
    """Return the smallest eps in one pass, None if no pose explains enough readings at any.

    What only the one pass gives is the smallest eps of every cell. Arguments as of :func:`errors_for_share`.
    """
    errors = errors_for_share(binary, readings, heading_rad, share)
    least = float(errors.min())
    return None if math.isinf(least) else SmallestError(int(least), np.argwhere(errors == least))


def smallest_error_by_search(
    binary: BinaryMap, readings: Sequence[RangeReading], heading_rad: float, share: float = 1.0
) -> SmallestError | None:
    """Return the smallest eps by binary search over whole numbers ([BrownDonald2000]_ sec. 2.3.3); the reference.

    O(log eps) ranks by convolution, O(n^2 m r) each. Arguments as of :func:`errors_for_share`.
    """
    wanted = readings_wanted(readings, share)
    most = max(math.ceil(_range_cells(reading, binary)) for reading in readings) + sum(binary.spec.shape)
    too_small, enough = -1, 0
    found = _agreeing(binary, readings, heading_rad, enough, wanted)
    # Doubled until it is enough: so the number of ranks is that of the digits of eps, however great it could be.
    while not found.size and enough < most:
        too_small, enough = enough, min(most, 2 * enough + 1)
        found = _agreeing(binary, readings, heading_rad, enough, wanted)
    if not found.size:
        return None
    while enough - too_small > 1:
        middle = (too_small + enough) // 2
        cells = _agreeing(binary, readings, heading_rad, middle, wanted)
        if cells.size:
            enough, found = middle, cells
        else:
            too_small = middle
    return SmallestError(enough, found)


def errors_for_share(
    binary: BinaryMap, readings: Sequence[RangeReading], heading_rad: float, share: float = 1.0, *, threads: int = 1
) -> NDArray[np.float32]:
    """Return, for every cell, the smallest whole eps at which a share of the readings are feasible there.

    A quantile of :func:`errors_needed`, worked out tile by tile: O(n^2 / 64) for every cell of a body and O(n^2) for
    every reading and binary digit of the errors; memory O(n^2 + 4 KiB m) for each thread.

    Args:
        binary: the map.
        readings: hits and misses, at least one.
        heading_rad: of the robot, in the map frame.
        share: of the readings that must agree, in (0, 1].
        threads: how many threads share the work; the errors do not depend on it.

    Returns:
        ``float32[rows, cols]``, whole numbers, ``inf`` where no eps is great enough.

    Raises:
        ValueError: there is no reading, one of them measured nothing, or the share is none.
    """
    # The kernel keeps errors in sixteen bits; floats take what does not fit.
    if any(_range_cells(reading, binary) > RANGE_CELLS_MAX for reading in readings):
        return errors_for_share_reading_by_reading(binary, readings, heading_rad, share)
    return errors_on(ErrorMap.of_binary(binary), readings, heading_rad, share, threads=threads)


def errors_for_share_reading_by_reading(
    binary: BinaryMap, readings: Sequence[RangeReading], heading_rad: float, share: float = 1.0
) -> NDArray[np.float32]:
    """Return the same as :func:`errors_for_share`: the reference, and for readings of any length.

    O(n^2 m) time and memory.
    """
    wanted = readings_wanted(readings, share)
    distances = distance_transform(binary.occupied, outside=True)
    free = ~binary.occupied
    needed = np.empty((len(readings), int(free.sum())), np.float32)
    for number, reading in enumerate(readings):
        needed[number] = errors_needed(binary, distances, reading, heading_rad)[free]
    errors = np.full(binary.spec.shape, np.inf, np.float32)
    errors[free] = np.partition(needed, wanted - 1, axis=0)[wanted - 1]
    return errors


def errors_over_headings(
    the_map: ErrorMap,
    readings: Sequence[RangeReading],
    headings_rad: Sequence[float],
    share: float = 1.0,
    *,
    threads: int = 1,
) -> tuple[NDArray[np.float32], NDArray[np.intp]]:
    """Return, for every cell, the least of :func:`errors_on` over theta slices, and the first slice with it.

    [BrownDonald2000]_ sec. 2.2.3. Both ``[rows, cols]``; arguments as there, at least one heading. Every heading takes
    as long as the first: where only the least eps of all matters, counting all poses
    (:class:`~robotd.localization.count.rank_grid.RankGrid`) at a few eps is faster.
    """
    best = errors_on(the_map, readings, headings_rad[0], share, threads=threads)
    which = np.zeros(best.shape, np.intp)
    for number, heading_rad in enumerate(headings_rad[1:], start=1):
        errors = errors_on(the_map, readings, heading_rad, share, threads=threads)
        # Strictly, so that of equal slices the first stays.
        better = errors < best
        best[better], which[better] = errors[better], number
    return best, which


def errors_needed(
    binary: BinaryMap, distances: NDArray[np.float64], reading: RangeReading, heading_rad: float
) -> NDArray[np.float64]:
    """Return e(p, z), the smallest whole eps at which a reading is feasible, for every cell.

    O(n^2), whatever the reading's length is.

    Args:
        binary: the map.
        distances: ``float64[rows, cols]``, :func:`~robotd.grid.distance.distance_transform` of its obstacles and of
            what lies outside.
        reading: a hit or a miss; a miss has no end, so only its body counts.
        heading_rad: of the robot, in the map frame.

    Returns:
        ``float64[rows, cols]``, whole numbers, ``inf`` where the robot cannot be at all.

    Raises:
        ValueError: the reading measured nothing.
    """
    probe = _probe(reading, heading_rad, binary, 0)
    needed = _errors_for_body(binary, reading, heading_rad, probe)
    if probe.head is not None:
        np.maximum(needed, translated(np.ceil(distances), *probe.head, outside=0.0), out=needed)
    needed[binary.occupied] = np.inf
    return needed


def _errors_for_body(binary: BinaryMap, reading: RangeReading, heading_rad: float, probe: Probe) -> NDArray[np.float64]:
    """Return the smallest whole eps at which the body is short enough, ``float64[rows, cols]``."""
    for_first_hit = _errors_by_samples(reading, heading_rad, binary)
    chain = probe.body[-(len(for_first_hit)) :]
    row, col = chain[0].tolist()
    first_hits = translated(directional_flood(binary.occupied, chain - chain[0], outside=True), row, col, outside=0)
    return np.where(first_hits == UNREACHED, 0.0, for_first_hit[first_hits])


def _errors_by_samples(reading: RangeReading, heading_rad: float, binary: BinaryMap) -> NDArray[np.float64]:
    """Return the smallest whole eps that leaves a ray no more than 0, 1, 2, ... samples; no eps leaves it none."""
    bearing, range_cells = np.array([heading_rad + reading.bearing_rad]), np.array([_range_cells(reading, binary)])
    return errors_by_samples(bearing, range_cells, reach_cells(binary.spec))[0]


def _agreeing(
    binary: BinaryMap, readings: Sequence[RangeReading], heading_rad: float, error_cells: int, wanted: int
) -> NDArray[np.intp]:
    """Return the free cells where that many readings are feasible, ``intp[n, 2]``."""
    # Grown by more cells than it has, a map is full, and the disk need not be any larger.
    obstacles = Obstacles.of(binary.occupied, min(error_cells, sum(binary.spec.shape)))
    rank = np.zeros(binary.spec.shape, np.intp)
    for reading in readings:
        rank += feasible_poses(obstacles, _probe(reading, heading_rad, binary, error_cells))
    return np.argwhere(rank >= wanted)


def _probe(reading: RangeReading, heading_rad: float, binary: BinaryMap, error_cells: int) -> Probe:
    return probe_of(
        reading,
        heading_rad,
        resolution_m=binary.spec.resolution_m,
        error_radius_cells=error_cells,
        reach_cells=reach_cells(binary.spec),
    )


def _range_cells(reading: RangeReading, binary: BinaryMap) -> float:
    if reading.range_m is None:
        raise ValueError(f"a {reading.status} reading has no range")
    return reading.range_m / binary.spec.resolution_m
