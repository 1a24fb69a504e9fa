"""Counted as they come or searched when asked: the same poses, with the same ranks."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.contract.area import Area
from robotd.core.grid_spec import GridSpec
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.occupancy import OccupancyGrid
from robotd.localization.count.rank_grid import even_headings
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings
from robotd.localization.stop import Count

SPEC = GridSpec(0.1, -0.5, 0.3, (14, 17))
readings = st.builds(
    RangeReading,
    st.just(0),
    st.floats(-math.pi, math.pi),
    st.sampled_from([ReadingStatus.OK, ReadingStatus.OK, ReadingStatus.MISS]),
    st.floats(0.05, 1.5),
)
maps = hnp.arrays(np.uint8, SPEC.shape, elements=st.sampled_from([0, 0, 0, 1, 2]))


def ready(cells: NDArray[np.uint8]) -> ReadyMap:
    evidence = np.choose(cells, (np.uint8(0), np.uint8(255), np.uint8(128)))
    return ReadyMap.of(OccupancyGrid(SPEC, evidence), LocalizationSettings(range_error_m=0.1))


@settings(max_examples=60, deadline=None)
@given(maps, st.lists(readings, min_size=1, max_size=8), st.integers(0, 3), st.integers(1, 8))
def test_both_ways_find_the_same(
    cells: NDArray[np.uint8], taken: list[RangeReading], slack: int, least_rank: int
) -> None:
    the_map = ready(cells)
    counted = Count(the_map, even_headings(8), None, threads=1)
    everywhere = Area(0.0, 0.0, 100.0)
    searched = Count(the_map, even_headings(8), everywhere, threads=1)
    for count in (counted, searched):
        count.add(*taken)
    one, other = counted.best(slack, least_rank), searched.best(slack, least_rank)
    assert (one.best_rank, one.is_all) == (other.best_rank, other.is_all)
    assert one.poses.tolist() == other.poses.tolist()
    assert one.ranks.tolist() == other.ranks.tolist()


@settings(max_examples=40, deadline=None)
@given(maps, st.lists(readings, min_size=1, max_size=6), st.floats(0.05, 1.2))
def test_within_an_area_it_finds_what_is_there_and_nothing_else(
    cells: NDArray[np.uint8], taken: list[RangeReading], radius_m: float
) -> None:
    area = Area(0.2, 0.9, radius_m)
    inside, anywhere = (
        Count(ready(cells), (0.0, 0.3), area, threads=1),
        Count(ready(cells), (0.0, 0.3), None, threads=1),
    )
    for count in (inside, anywhere):
        count.add(*taken)
    poses = anywhere.best(99, 1)
    near = [math.dist(SPEC.centre_of(row, col), (0.2, 0.9)) <= radius_m for _, row, col in poses.poses.tolist()]
    assert inside.best(99, 1).poses.tolist() == poses.poses[near].tolist()


def test_a_reading_that_measured_nothing_is_refused_either_way() -> None:
    nothing = RangeReading(0, 0.0, ReadingStatus.WEAK, None)
    for headings in (even_headings(4), even_headings(99)):
        count = Count(ready(np.zeros(SPEC.shape, np.uint8)), headings, None, threads=1)
        with pytest.raises(ValueError, match="weak"):
            count.add(nothing)
        assert count.readings == []


def test_more_poses_than_can_be_told_are_said_to_be_not_all(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robotd.localization.stop.POSES_MAX", 10)
    count = Count(ready(np.zeros(SPEC.shape, np.uint8)), even_headings(99), None, threads=1)
    count.add(RangeReading(0, 0.0, ReadingStatus.MISS, 0.3))
    found = count.best(0, 1)
    assert (found.is_all, found.best_rank) == (False, 1)


@pytest.mark.parametrize("bad", [(math.nan, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, math.inf)])
def test_an_area_that_holds_nothing_is_refused(bad: tuple[float, float, float]) -> None:
    with pytest.raises(ValueError, match="must be"):
        Area(*bad)
