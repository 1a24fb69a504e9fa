"""The smallest error beside the rank: the paper's, at the heading of the answer, of a whole sweep alone."""

import pytest

from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.binary import BinaryMap
from robotd.localization.at_stop import estimator_at_stop
from robotd.localization.obstacles.unknown_cells import UnknownCells
from robotd.localization.ready_map import ReadyMap
from robotd.localization.reference.smallest_error import smallest_error_by_search
from robotd.localization.settings import LocalizationSettings
from robotd.localization.smallest_error_told import AGREEING_SHARE
from tests.support.mapped_room import mapped_room

AS_THE_PAPER = LocalizationSettings(unknown=UnknownCells.OCCUPIED, blocked_by=1)


def test_it_is_what_the_search_of_the_paper_finds_at_that_heading() -> None:
    grid, readings, truth = mapped_room()
    some = readings[::6]
    estimator = estimator_at_stop(ReadyMap.of(grid, AS_THE_PAPER), "", (truth.heading_rad,), tells_smallest_error=True)
    estimator.add(*some[:10])
    assert estimator.estimate(0, final=False).smallest_error_m is None
    estimator.add(*some[10:])
    found = estimator.estimate(0, final=True)
    searched = smallest_error_by_search(BinaryMap.from_grid(grid), some, truth.heading_rad, AGREEING_SHARE)
    assert found.regions
    assert searched is not None
    assert found.smallest_error_m == pytest.approx(grid.spec.resolution_m * searched.error_cells)


def test_without_an_answer_it_is_not_told() -> None:
    grid, readings, truth = mapped_room()
    estimator = estimator_at_stop(ReadyMap.of(grid, AS_THE_PAPER), "", (truth.heading_rad,), tells_smallest_error=True)
    estimator.add(*(RangeReading(0, reading.bearing_rad, ReadingStatus.OK, 0.21) for reading in readings))
    found = estimator.estimate(0, final=True)
    assert (found.regions, found.smallest_error_m) == ((), None)
