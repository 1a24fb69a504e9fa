"""The rank grid: a sum of feasible poses, whatever the order, over free cells only."""

import math
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.core.errors import TooLarge
from robotd.core.grid_spec import GridSpec
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.binary import BinaryMap
from robotd.grid.readings import Readings
from robotd.grid.ternary import TernaryMap
from robotd.localization.count.rank_grid import RankGrid
from robotd.localization.even_headings import even_headings
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.obstacles.prepared_map import PreparedMap
from robotd.localization.obstacles.unknown_cells import UnknownCells
from robotd.localization.reference.feasible_poses import feasible_poses
from robotd.localization.reference.probe import probe_of
from robotd.localization.reference.rank import rank_of

maps = hnp.arrays(np.bool_, (9, 12), elements=st.sampled_from([False] * 3 + [True]))
readings = st.builds(
    RangeReading,
    st.just(0),
    st.floats(-4.0, 4.0),
    st.sampled_from([ReadingStatus.OK, ReadingStatus.OK, ReadingStatus.MISS]),
    st.floats(0.1, 3.0),
)


def map_of(occupied: NDArray[np.bool_], radius: float = 1.5) -> PreparedMap:
    return PreparedMap.of_binary(BinaryMap(GridSpec(0.5, -1.0, 2.0, occupied.shape), occupied), radius)


@settings(max_examples=60)
@given(maps, st.lists(readings, max_size=5), st.lists(st.floats(-4.0, 4.0), min_size=1, max_size=3))
def test_rank_is_how_many_feasible_pose_sets_hold_a_free_cell(
    occupied: NDArray[np.bool_], sweep: list[RangeReading], headings: list[float]
) -> None:
    ranks = RankGrid(map_of(occupied), headings)
    for reading in sweep:
        ranks.add(Readings.of((reading,)))
    obstacles = Obstacles.of(occupied, 1.5)
    expected = rank_of(obstacles, sweep, headings, resolution_m=0.5, error_radius_cells=1.5)
    assert ranks.readings == len(sweep)
    assert ranks.rank.dtype == np.uint16
    assert np.array_equal(ranks.rank, expected)
    assert ranks.best_rank == expected.max()
    free = np.broadcast_to(~occupied, expected.shape)
    best = ranks.cells_of_rank(ranks.best_rank)
    assert np.array_equal(best, np.argwhere((expected == expected.max()) & free))
    assert np.array_equal(ranks.rank_at(best), np.full(len(best), expected.max()))


def drawn_obstacles(seed: int, shape: tuple[int, int], outside: tuple[bool, bool], blocked_by: int) -> Obstacles:
    """Free, blocking and ending cells that have nothing to do with each other, and some that are none of it."""
    random = np.random.default_rng(seed)
    free = random.random(shape) < random.choice([0.1, 0.6, 0.95])
    blocking = (random.random(shape) < random.choice([0.02, 0.2])) & ~free
    grown = random.random(shape) < random.choice([0.1, 0.7])
    return Obstacles(free, blocking, grown, *outside, blocked_by)


any_obstacles = st.builds(
    drawn_obstacles,
    st.integers(0, 2**32),
    st.tuples(st.integers(1, 40), st.integers(1, 140)),
    st.tuples(st.booleans(), st.booleans()),
    st.sampled_from([1, 2]),
)


@settings(max_examples=100, deadline=None)
@given(
    any_obstacles, st.lists(readings, min_size=1, max_size=8), st.lists(st.floats(-4.0, 4.0), min_size=1, max_size=3)
)
def test_rank_is_the_sum_of_feasible_poses_whatever_the_obstacles_mean(
    obstacles: Obstacles, sweep: list[RangeReading], headings: list[float]
) -> None:
    rows, cols = obstacles.free.shape
    ranks = RankGrid(PreparedMap.of(obstacles, GridSpec(0.5, -1.0, 2.0, (rows, cols)), 1.5), headings)
    ranks.add(Readings.of(sweep))
    expected = rank_of(obstacles, sweep, headings, resolution_m=0.5, error_radius_cells=1.5)
    assert np.array_equal(ranks.rank, expected)
    free = np.broadcast_to(obstacles.free, expected.shape)
    for least in (0, 1, max(1, int(expected.max()))):
        poses = ranks.cells_of_rank(least)
        assert np.array_equal(poses, np.argwhere((expected >= least) & free))
        assert np.array_equal(ranks.rank_at(poses), expected[tuple(poses.T)])


@given(st.sampled_from(UnknownCells), st.sampled_from([1, 2]))
def test_a_miss_counts_by_its_body_alone_whatever_lies_outside(unknown: UnknownCells, blocked_by: int) -> None:
    vacant = np.ones((5, 9), np.bool_)
    ternary = TernaryMap(GridSpec(0.5, 0.0, 0.0, (5, 9)), ~vacant, vacant)
    obstacles = Obstacles.of_map(ternary, unknown, 1.0, blocked_by=blocked_by)
    ranks = RankGrid(PreparedMap.of(obstacles, ternary.spec, 1.0), [0.0])
    ranks.add(Readings.of((RangeReading(0, 0.0, ReadingStatus.MISS, 2.0),)))
    seen = 9 if unknown is UnknownCells.FREE else 9 - 3 + blocked_by
    assert ranks.rank[0, 0].tolist() == [1] * min(9, seen) + [0] * (9 - seen)


@settings(max_examples=25)
@given(maps, st.lists(readings, min_size=2, max_size=5), st.randoms())
def test_the_order_of_readings_does_not_matter(
    occupied: NDArray[np.bool_], sweep: list[RangeReading], random: Random
) -> None:
    one, other = (RankGrid(map_of(occupied, 1.0), [0.2]) for _ in range(2))
    for reading in sweep:
        one.add(Readings.of((reading,)))
    random.shuffle(sweep)
    for reading in sweep:
        other.add(Readings.of((reading,)))
    assert np.array_equal(one.rank, other.rank)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32), st.lists(readings, min_size=1, max_size=6), st.data())
def test_readings_can_be_added_together_and_taken_back_in_any_order(
    seed: int, sweep: list[RangeReading], data: st.DataObject
) -> None:
    the_map = map_of(np.random.default_rng(seed).random((75, 140)) < 0.05)
    gone = data.draw(st.lists(st.sampled_from(range(len(sweep))), unique=True))
    grid, expected = (RankGrid(the_map, even_headings(8)) for _ in range(2))
    grid.add(Readings.of(sweep))
    for number in gone:
        grid.remove(Readings.of((sweep[number],)))
    for number in set(range(len(sweep))) - set(gone):
        expected.add(Readings.of((sweep[number],)))
    assert grid.readings == len(sweep) - len(gone)
    assert np.array_equal(grid.rank, expected.rank)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32), st.integers(0, 40))
def test_all_poses_of_a_map_of_many_tiles_are_the_reference_at_samples(seed: int, turned: int) -> None:
    """Headings and bearings are multiples of one step, so directions are shared; slices are compared whole."""
    random = np.random.default_rng(seed)
    occupied = np.kron(random.random((7, 20)) < 0.1, np.ones((12, 9), np.bool_)).astype(np.bool_)
    sweep = [
        RangeReading(0, math.tau * (k + turned) / 40, random.choice([ReadingStatus.OK, ReadingStatus.MISS]), length)
        for k, length in enumerate(random.uniform(0.1, 25.0, 40).tolist())
    ]
    ranks = RankGrid(map_of(occupied), even_headings(40), threads=2)
    ranks.add(Readings.of(sweep))
    obstacles = Obstacles.of(occupied, 1.5)
    rank = ranks.rank
    for number in random.integers(0, 40, 2).tolist():
        probes = (
            probe_of(reading, ranks.headings_rad[number], resolution_m=0.5, error_radius_cells=1.5, reach_cells=400)
            for reading in sweep
        )
        assert np.array_equal(rank[number], sum(feasible_poses(obstacles, probe).astype(int) for probe in probes))
    assert np.array_equal(ranks.rank_at(ranks.cells_of_rank(3)), rank[rank >= 3])
    assert np.array_equal(ranks.cells_of_rank(3), np.argwhere(rank >= 3))


@settings(max_examples=40, deadline=None)
@given(maps, st.lists(readings, min_size=1, max_size=5), st.integers(1, 4), st.sampled_from([1, 2, 5]))
def test_heat_is_the_greatest_rank_over_headings(
    occupied: NDArray[np.bool_], some: list[RangeReading], headings: int, block: int
) -> None:
    ranks = RankGrid(map_of(occupied), even_headings(headings))
    ranks.add(Readings.of(some))
    levels = ranks.rank.max(axis=0).astype(int) * 255 // len(some)
    rows, cols = levels.shape
    slow = [
        [levels[row : row + block, col : col + block].max() for col in range(0, cols, block)]
        for row in range(0, rows, block)
    ]
    assert ranks.heat(block).tolist() == slow


def test_counters_grow_with_what_they_count() -> None:
    ranks = RankGrid(map_of(np.zeros((3, 3), np.bool_)), [0.0])
    one = RangeReading(0, 0.0, ReadingStatus.MISS, 0.1)
    ranks.add(Readings.of([one] * 511))
    ranks.add(Readings.of((one,)))
    assert ranks.best_rank == 512
    ranks.remove(Readings.of([one] * 512))
    assert ranks.best_rank == 0
    with pytest.raises(ValueError, match="taken back"):
        ranks.remove(Readings.of((one,)))
    with pytest.raises(ValueError, match="65535"):
        ranks.add(Readings.of([one] * 65536))


def test_counts_that_would_not_fit_are_refused_with_how_much_they_need() -> None:
    the_map = map_of(np.zeros((4096, 4096), np.bool_))
    with pytest.raises(TooLarge, match=r"511 readings at 300 headings on a map of 4096 x 4096 cells takes 5\.3 GiB"):
        RankGrid(the_map, even_headings(300))
    ranks = RankGrid(the_map, even_headings(50))
    reading = RangeReading(0, 0.0, ReadingStatus.OK, 1.0)
    with pytest.raises(TooLarge, match="65535 readings at 50 headings"):
        ranks.add(Readings.of([reading] * 40000))
    assert ranks.readings == 0


def test_a_map_without_free_cells_has_no_poses() -> None:
    ranks = RankGrid(map_of(np.ones((4, 5), np.bool_)), [0.0])
    ranks.add(Readings.of((RangeReading(0, 0.0, ReadingStatus.OK, 1.0),)))
    assert ranks.best_rank == 0
    assert ranks.cells_of_rank(ranks.best_rank).shape == (0, 3)
    assert ranks.rank.shape == (1, 4, 5)


def test_theta_slices_go_round_evenly() -> None:
    assert even_headings(4) == pytest.approx((0.0, math.pi / 2, math.pi, 3 * math.pi / 2))


def test_a_reading_that_measured_nothing_is_refused_and_not_counted() -> None:
    ranks = RankGrid(map_of(np.zeros((4, 5), np.bool_)), [0.0])
    with pytest.raises(ValueError, match="timeout"):
        ranks.add(Readings.of((RangeReading(0, 0.0, ReadingStatus.TIMEOUT, None),)))
    assert ranks.readings == 0
