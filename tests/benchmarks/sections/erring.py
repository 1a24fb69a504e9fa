"""The smallest error radius of every cell, in one pass and by search; and the conservative mode."""

import math
from collections.abc import Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray

from robotd.grid.binary import BinaryMap
from robotd.grid.readings import Readings
from robotd.localization.conservative.conservative_poses import ErrorBounds, SureObstacles
from robotd.localization.conservative.conservative_rank import ConservativeMap, ConservativeRankGrid
from robotd.localization.even_headings import even_headings
from robotd.localization.reference.smallest_error import (
    errors_for_share,
    errors_for_share_reading_by_reading,
    smallest_error_by_search,
)
from tests.benchmarks import workload
from tests.benchmarks.timing import Timing, timed

SHARE = 0.9


def timings() -> Iterator[Timing]:
    """Workload S, heading known."""
    occupied = workload.room()
    asked = (
        BinaryMap(workload.SPEC, occupied),
        workload.sweep_of(occupied).measured,
        workload.TRUTH.heading_rad,
        SHARE,
    )
    title = f"S, smallest error for {SHARE:.0%} of 300 readings, heading known"
    for threads in (1, 2):
        run = partial(errors_for_share, *asked, threads=threads)
        yield timed(f"{title}: every cell, in one pass, {threads} thread(s)", run, 10)
    yield timed(
        f"{title}: every cell, reading by reading in NumPy", partial(errors_for_share_reading_by_reading, *asked), 3
    )
    yield timed(f"{title}: the best cell, by search in NumPy", partial(smallest_error_by_search, *asked), 3)
    yield from conservative(occupied)


def conservative(occupied: NDArray[np.bool_]) -> Iterator[Timing]:
    """Every free cell and every heading, nothing known, ranges wrong by a cell."""
    headings = even_headings(300)
    bounds = ErrorBounds(workload.RESOLUTION_M, math.pi / len(headings))
    the_map = ConservativeMap.of(SureObstacles.of(occupied), workload.SPEC, bounds)
    sweep = workload.sweep_of(occupied).measured

    def count(threads: int) -> None:
        ConservativeRankGrid(the_map, headings, threads=threads).add(Readings.of(sweep))

    for threads in (1, 2):
        title = f"S, conservative, {len(headings)} headings, {len(sweep)} readings: counting, {threads} thread(s)"
        yield timed(title, partial(count, threads), 5)
