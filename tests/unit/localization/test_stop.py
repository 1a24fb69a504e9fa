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
from robotd.grid.readings import Readings
from robotd.grid.window import CellWindow
from robotd.localization.even_headings import even_headings
from robotd.localization.obstacles.error_radius import ErrorRadius
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings
from robotd.localization.stop import CountedStop, SearchedStop

SPEC = GridSpec(0.1, -0.5, 0.3, (14, 17))
readings = st.builds(
    RangeReading,
    st.just(0),
    st.floats(-math.pi, math.pi),
    st.sampled_from([ReadingStatus.OK, ReadingStatus.OK, ReadingStatus.MISS]),
    st.floats(0.05, 1.5),
)
maps = hnp.arrays(np.uint8, SPEC.shape, elements=st.sampled_from([0, 0, 0, 1, 2]))


def ready(cells: NDArray[np.uint8], rival_share: float = 0.15, localized_share: float = 0.01) -> ReadyMap:
    evidence = np.choose(cells, (np.uint8(0), np.uint8(255), np.uint8(128)))
    # An angle so wide that readings of a metre are of three levels.
    settings = LocalizationSettings(
        range_error_m=0.1,
        error_radius=ErrorRadius.BY_RANGE,
        bearing_error_rad=0.2,
        rival_share=rival_share,
        localized_share=localized_share,
    )
    return ReadyMap.of(OccupancyGrid(SPEC, evidence), settings)


@settings(max_examples=60, deadline=None)
@given(maps, st.lists(readings, min_size=1, max_size=8), st.floats(0.0, 0.5), st.floats(0.01, 1.0))
def test_both_ways_find_the_same(
    cells: NDArray[np.uint8], taken: list[RangeReading], rival_share: float, localized_share: float
) -> None:
    the_map, everywhere = ready(cells, rival_share, localized_share), Area(0.0, 0.0, 100.0)
    counted, searched = the_map.stop(even_headings(8)), the_map.stop(even_headings(8), everywhere)
    assert (type(counted), type(searched)) == (CountedStop, SearchedStop)
    for stop in (counted, searched):
        stop.add(Readings.of(taken[:3]))
        stop.add(Readings.of(taken[3:]))
    one, other = counted.best_poses(), searched.best_poses()
    assert (one.best_rank, one.is_all) == (other.best_rank, other.is_all)
    assert one.poses.tolist() == other.poses.tolist()
    assert one.ranks.tolist() == other.ranks.tolist()


@settings(max_examples=40, deadline=None)
@given(maps, st.lists(readings, min_size=1, max_size=6), st.floats(0.05, 1.2))
def test_within_an_area_it_finds_what_is_there_and_nothing_else(
    cells: NDArray[np.uint8], taken: list[RangeReading], radius_m: float
) -> None:
    area, the_map = Area(0.2, 0.9, radius_m), ready(cells, rival_share=0.99)
    inside, anywhere = the_map.stop((0.0, 0.3), area), the_map.stop((0.0, 0.3))
    for stop in (inside, anywhere):
        stop.add(Readings.of(taken))
    poses = anywhere.best_poses()
    near = [math.dist(SPEC.centre_of(row, col), (0.2, 0.9)) <= radius_m for _, row, col in poses.poses.tolist()]
    assert inside.best_poses().poses.tolist() == poses.poses[near].tolist()


def test_more_poses_than_can_be_told_are_said_to_be_not_all(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robotd.localization.stop.POSES_TOLD_MAX", 10)
    stop = ready(np.zeros(SPEC.shape, np.uint8)).stop(even_headings(99))
    stop.add(Readings.of((RangeReading(0, 0.0, ReadingStatus.MISS, 0.3),)))
    found = stop.best_poses()
    assert (found.is_all, found.best_rank) == (False, 1)


@settings(max_examples=20, deadline=None)
@given(maps, st.integers(0, 2**32), st.lists(readings, min_size=1, max_size=6))
def test_a_map_that_was_updated_stays_as_it_is(cells: NDArray[np.uint8], seed: int, taken: list[RangeReading]) -> None:
    before = ready(cells)
    changed, random = CellWindow(3, 9, 2, 12), np.random.default_rng(seed)
    grid = OccupancyGrid(SPEC, np.choose(cells, (np.uint8(0), np.uint8(255), np.uint8(128))))
    grid.cells[changed.slices] = random.choice(np.array([0, 255, 128], np.uint8), changed.shape)
    after = before.updated(grid, changed)
    for the_map, fresh in ((before, ready(cells)), (after, ReadyMap.of(grid, before.settings))):
        stop, expected = the_map.stop(even_headings(99)), fresh.stop(even_headings(99))
        for one in (stop, expected):
            one.add(Readings.of(taken))
        assert stop.best_poses().poses.tolist() == expected.best_poses().poses.tolist()
        assert stop.best_poses().ranks.tolist() == expected.best_poses().ranks.tolist()


@pytest.mark.parametrize("bad", [(math.nan, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, math.inf)])
def test_an_area_that_holds_nothing_is_refused(bad: tuple[float, float, float]) -> None:
    with pytest.raises(ValueError, match="must be"):
        Area(*bad)
