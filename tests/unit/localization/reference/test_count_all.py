"""Counted batch by batch, the best poses are those of one rank grid."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.core.grid_spec import GridSpec
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.readings import Readings
from robotd.localization.count.rank_grid import RankGrid
from robotd.localization.even_headings import even_headings
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.obstacles.prepared_map import PreparedMap
from robotd.localization.reference.count_all import count_all


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32), st.integers(0, 5), st.sampled_from([0, 1, 7000, 30000, 1 << 28]))
def test_whatever_the_memory_the_poses_are_those_of_a_rank_grid(seed: int, slack: int, memory_bytes: int) -> None:
    random = np.random.default_rng(seed)
    occupied = random.random((40, 90)) < random.choice([0.02, 0.2, 1.0])
    the_map = PreparedMap.of(Obstacles.of(occupied, 1.5), GridSpec(0.5, 0.0, 0.0, (40, 90)), 1.5)
    sweep = [
        RangeReading(0, math.tau * k / 9, random.choice([ReadingStatus.OK, ReadingStatus.MISS]), length)
        for k, length in enumerate(random.uniform(0.1, 12.0, int(random.integers(0, 9))).tolist())
    ]
    ranks = RankGrid(the_map, even_headings(9))
    ranks.add(Readings.of(sweep))
    found = count_all(the_map, Readings.of(sweep), even_headings(9), slack=slack, memory_bytes=memory_bytes)
    expected = ranks.cells_of_rank(max(1, ranks.best_rank - slack))
    assert found.best_rank == ranks.best_rank
    assert np.array_equal(found.poses, expected)
    assert np.array_equal(found.ranks, ranks.rank_at(expected))
