"""The smallest error radius of every cell, in one pass and by search."""

from collections.abc import Iterator
from functools import partial

from robotd.grid.binary import BinaryMap
from robotd.localization.smallest_error import (
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
