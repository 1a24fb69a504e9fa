"""A map made ready again after a sweep changed it is the map made ready from nothing."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.kernels.shared.packed_map import pack, planes_of, tiles_of
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.readings import Readings
from robotd.grid.ternary import TernaryMap
from robotd.grid.window import CellWindow
from robotd.localization.count.rank_grid import RankGrid
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.obstacles.prepared_map import PreparedMap
from robotd.localization.obstacles.unknown_cells import UnknownCells

SPEC = GridSpec(0.1, -2.0, -1.0, (70, 150))
RADIUS = 1.5


def sweep_of(seed: int) -> tuple[Sweep, Pose2]:
    random = np.random.default_rng(seed)
    readings = tuple(
        RangeReading(0, bearing, random.choice([ReadingStatus.OK, ReadingStatus.MISS]), float(random.uniform(0.1, 3.0)))
        for bearing in random.uniform(-math.pi, math.pi, int(random.integers(0, 12))).tolist()
    )
    pose = Pose2(float(random.uniform(-3.0, 14.0)), float(random.uniform(-2.0, 7.0)), float(random.uniform(-3.0, 3.0)))
    return Sweep(0, IDENTITY, readings), pose


@settings(max_examples=60, deadline=None)
@given(st.lists(st.integers(0, 2**32), min_size=2, max_size=5), st.sampled_from(UnknownCells), st.sampled_from([1, 2]))
def test_updated_sweep_by_sweep_it_is_what_it_is_made_anew(
    seeds: list[int], unknown: UnknownCells, blocked_by: int
) -> None:
    grid = OccupancyGrid(SPEC)
    grid.insert(*sweep_of(seeds[0]))
    ternary = TernaryMap.from_grid(grid)
    obstacles = Obstacles.of_map(ternary, unknown, RADIUS, blocked_by=blocked_by)
    the_map = PreparedMap.of(obstacles, SPEC, RADIUS)
    origin = the_map.packed.origin
    for seed in seeds[1:]:
        changed = CellWindow.bounding(grid.insert(*sweep_of(seed)), SPEC.shape)
        ternary = ternary.updated(grid, changed)
        obstacles = obstacles.updated(ternary, unknown, RADIUS, changed)
        the_map = the_map.updated(obstacles, changed.grown(math.ceil(RADIUS), SPEC.shape))
    expected = Obstacles.of_map(TernaryMap.from_grid(grid), unknown, RADIUS, blocked_by=blocked_by)
    for name, outside in (("free", False), ("blocking", expected.outside_blocks), ("grown", expected.outside_ends)):
        mask = getattr(expected, name)
        assert np.array_equal(getattr(the_map.obstacles, name), mask)
        assert np.array_equal(getattr(the_map.packed, name), pack(mask, origin, outside=outside))
    packed = the_map.packed
    assert np.array_equal(packed.planes, planes_of(packed.free, packed.blocking, packed.grown))
    assert np.array_equal(packed.tiles, tiles_of(packed.free))
    one, other = (RankGrid(each, [0.3, 2.0]) for each in (the_map, PreparedMap.of(expected, SPEC, RADIUS)))
    for ranks in (one, other):
        ranks.add(Readings.of(sweep_of(seeds[0])[0].readings))
    assert np.array_equal(one.rank, other.rank)


def test_what_was_prepared_before_stays_as_it_was() -> None:
    grid = OccupancyGrid(SPEC)
    ternary = TernaryMap.from_grid(grid)
    obstacles = Obstacles.of_map(ternary, UnknownCells.OCCUPIED, RADIUS)
    before = PreparedMap.of(obstacles, SPEC, RADIUS)
    grid.cells[10:20, 30:40] = 0
    changed = CellWindow(10, 20, 30, 40)
    ternary_now = ternary.updated(grid, changed)
    now = before.updated(
        obstacles.updated(ternary_now, UnknownCells.OCCUPIED, RADIUS, changed), changed.grown(2, SPEC.shape)
    )
    assert ternary_now.vacant.sum() == 100
    assert now.packed.tiles.size > 0
    assert before.packed.tiles.size == 0
    assert not ternary.vacant.any()
    assert not before.packed.free.any()


def test_obstacles_are_prepared_only_where_they_fit() -> None:
    with pytest.raises(ValueError, match="expected obstacles of shape"):
        PreparedMap.of(Obstacles.of(np.zeros((3, 4), np.bool_), 1.0), GridSpec(0.5, 0.0, 0.0, (4, 3)), 1.0)
