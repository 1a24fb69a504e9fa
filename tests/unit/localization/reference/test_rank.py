"""rnk and loc as the paper says them: what counting and searching answer, for any readings on any map."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.pose_set import PoseSet
from robotd.grid.readings import Readings
from robotd.localization.count.rank_grid import RankGrid
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.obstacles.levels import Levels
from robotd.localization.obstacles.prepared_map import PreparedMap
from robotd.localization.reference.count_all import count_all
from robotd.localization.reference.rank import loc_of, rank_of
from robotd.localization.search.bounded_search import SearchMap, best_poses

RADIUS, RESOLUTION_M = 1.5, 0.5
maps = hnp.arrays(np.bool_, (11, 17), elements=st.sampled_from([False] * 4 + [True]))
origins = st.sampled_from([0.0, 0.0, 0.7, -1.2])
sweeps = st.lists(
    st.builds(
        RangeReading,
        st.just(0),
        st.floats(-math.pi, math.pi),
        st.sampled_from([ReadingStatus.OK, ReadingStatus.OK, ReadingStatus.MISS]),
        st.floats(0.1, 6.0),
        origin_x_m=origins,
        origin_y_m=origins,
    ),
    min_size=1,
    max_size=8,
)


def assert_same(one: PoseSet, other: PoseSet) -> None:
    assert one.best_rank == other.best_rank
    assert one.poses.tolist() == other.poses.tolist()
    assert one.ranks.tolist() == other.ranks.tolist()


@settings(max_examples=60, deadline=None)
@given(maps, sweeps, st.lists(st.floats(-math.pi, math.pi), min_size=1, max_size=4), st.integers(0, 3))
def test_counted_all_at_once_in_batches_or_searched_loc_is_the_papers(
    occupied: NDArray[np.bool_], sweep: list[RangeReading], headings_rad: list[float], slack: int
) -> None:
    spec, obstacles = GridSpec(RESOLUTION_M, -1.0, 2.0, occupied.shape), Obstacles.of(occupied, RADIUS)
    rank = rank_of(obstacles, sweep, headings_rad, resolution_m=RESOLUTION_M, error_radius_cells=RADIUS)
    expected, prepared = loc_of(rank, slack), PreparedMap.of(obstacles, spec, RADIUS)
    ranks = RankGrid(prepared, headings_rad)
    ranks.add(Readings.of(sweep))
    assert np.array_equal(ranks.rank, rank)
    assert_same(ranks.best_poses(slack), expected)
    assert_same(count_all(prepared, Readings.of(sweep), headings_rad, slack=slack, memory_bytes=0), expected)
    searched = SearchMap.of(Levels.of(obstacles, spec, RADIUS))
    assert_same(best_poses(searched, Readings.of(sweep), np.array(headings_rad), slack=slack), expected)


def test_one_reading_more_changes_a_rank_by_one_at_most_and_order_changes_nothing() -> None:
    occupied = np.zeros((9, 9), np.bool_)
    occupied[0] = occupied[:, 8] = True
    obstacles = Obstacles.of(occupied, RADIUS)
    sweep = [RangeReading(0, 0.7 * k, ReadingStatus.OK, 0.4 + 0.3 * k) for k in range(7)]
    ranks = [
        rank_of(obstacles, readings, [0.3], resolution_m=RESOLUTION_M, error_radius_cells=RADIUS).astype(int)
        for readings in (sweep[:-1], sweep, sweep[::-1])
    ]
    assert set(np.unique(ranks[1] - ranks[0]).tolist()) == {0, 1}
    assert np.array_equal(ranks[1], ranks[2])
    assert not ranks[1][:, occupied].any()


def test_where_nothing_is_explained_loc_is_empty() -> None:
    nothing = loc_of(np.zeros((1, 3, 4), np.uint16))
    assert (len(nothing), nothing.best_rank) == (0, 0)
