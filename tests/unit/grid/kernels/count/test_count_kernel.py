"""The kernels in C against their NumPy twins, and both against beams that are drawn one by one."""

import itertools
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid import kernels as kernels_in_use
from robotd.grid.drawn import FAR_CELLS
from robotd.grid.footprints import dilate, disk_footprint
from robotd.grid.kernels import Kernels
from robotd.grid.kernels.draw.draw_kernel import NO_HEAD, Beams, BeamSettings, turned
from robotd.grid.kernels.shared.packed_map import TILE_ROWS, WORD_CELLS, PackedMap, Words, pack
from robotd.grid.kernels.twins import TWINS
from robotd.grid.readings import Readings
from robotd.localization.even_headings import even_headings
from robotd.localization.reference.probe import probe_of
from tests.support.kernel_tables import NATIVE, both, needs_native, using

RADIUS = 1.5
HOW = BeamSettings(resolution_m=0.5, error_radius_cells=RADIUS, reach_cells=70)
TURN_STEPS = 12
maps = hnp.arrays(
    np.bool_,
    st.tuples(st.integers(1, 40), st.integers(1, 140)),
    elements=st.sampled_from([False] * 12 + [True]),
    fill=st.just(False),
)
any_bearing = st.floats(-4.0, 4.0)
even_bearing = st.integers(-15, 15).map(lambda k: math.tau * k / TURN_STEPS)


def readings_with(bearing: st.SearchStrategy[float]) -> st.SearchStrategy[list[RangeReading]]:
    origin = st.sampled_from([0.0, 0.0, 0.0, 0.7, -1.2])
    one = st.builds(
        RangeReading,
        st.just(0),
        bearing,
        st.sampled_from([ReadingStatus.OK, ReadingStatus.OK, ReadingStatus.MISS]),
        st.one_of(st.floats(0.01, 30.0), st.sampled_from([0.5, 3.0, 1e9])),
        origin_x_m=origin,
        origin_y_m=origin,
    )
    return st.lists(one, min_size=1, max_size=8)


work = st.one_of(
    st.tuples(readings_with(any_bearing), st.lists(any_bearing, min_size=1, max_size=4).map(np.array)),
    st.tuples(readings_with(even_bearing), st.just(np.array(even_headings(TURN_STEPS)))),
)


def packed(occupied: NDArray[np.bool_]) -> PackedMap:
    return PackedMap.of(~occupied, occupied, dilate(occupied, disk_footprint(RADIUS), outside=True))


def drawn_map(
    seed: int, shape: tuple[int, int], outside_blocks: bool, outside_ends: bool, blocked_by: int
) -> PackedMap:
    """What stops a beam and what ends it need not have to do with each other."""
    random = np.random.default_rng(seed)
    free = random.random(shape) < random.choice([0.1, 0.6, 0.95])
    blocking = (random.random(shape) < random.choice([0.01, 0.1])) & ~free
    return PackedMap.of(
        free,
        blocking,
        random.random(shape) < 0.4,
        outside_blocks=outside_blocks,
        outside_ends=outside_ends,
        blocked_by=blocked_by,
    )


packed_maps = st.builds(
    drawn_map,
    st.integers(0, 2**32),
    st.tuples(st.integers(1, 70), st.integers(1, 140)),
    st.booleans(),
    st.booleans(),
    st.sampled_from([1, 2]),
)


def listed(beams: Beams, headings: int) -> list[tuple[int, tuple[tuple[int, int], ...], tuple[int, int]]]:
    """Every beam as heading, body and head, in order."""
    found = []
    for batch, (first_group, last_group) in enumerate(itertools.pairwise(beams.batches.tolist())):
        body_of = {}
        for group in range(first_group, last_group):
            chain = beams.chains[beams.groups[group] : beams.groups[group + 1]].tolist()
            for length, (_, _, slot) in enumerate(chain, 1):
                if slot >= 0:
                    assert slot < beams.slots
                    assert slot not in body_of
                    body_of[slot] = tuple((row, col) for row, col, _ in chain[:length])
        for heading in range(headings):
            first, last = beams.lists[batch * headings + heading : batch * headings + heading + 2].tolist()
            found += [(heading, body_of[slot], (row, col)) for slot, row, col in beams.beams[first:last].tolist()]
    return sorted(found)


def expected_beams(
    readings: list[RangeReading], headings: NDArray[np.float64]
) -> list[tuple[int, tuple[tuple[int, int], ...], tuple[int, int]]]:
    found = []
    for reading, (heading, heading_rad) in itertools.product(readings, enumerate(headings.tolist())):
        probe = probe_of(reading, heading_rad, resolution_m=0.5, error_radius_cells=RADIUS, reach_cells=70)
        far = [max(-FAR_CELLS, min(FAR_CELLS, at)) for at in probe.head or ()]
        head = (far[0], far[1]) if far else (NO_HEAD, NO_HEAD)
        found.append((heading, tuple(map(tuple, probe.body.tolist())), head))
    return sorted(found)


@both
@settings(max_examples=40, deadline=None)
@given(work)
def test_beams_are_the_probes_one_by_one(
    kernels: Kernels, drawn: tuple[list[RangeReading], NDArray[np.float64]]
) -> None:
    readings, headings = drawn
    assert listed(
        kernels.draw.draw_beams(Readings.of(readings).rows, turned(headings), HOW), len(headings)
    ) == expected_beams(readings, headings)


@both
def test_even_headings_and_bearings_share_one_chain_for_each_direction(kernels: Kernels) -> None:
    readings = [RangeReading(0, math.tau * k / 60, ReadingStatus.OK, 3.0 + k) for k in range(60)]
    beams = kernels.draw.draw_beams(Readings.of(readings).rows, turned(np.array(even_headings(60))), HOW)
    assert len(beams.groups) - 1 == 60


@both
def test_directions_that_differ_by_a_hair_share_a_chain_only_as_far_as_it_is_the_same(kernels: Kernels) -> None:
    """Where a slope is one half, every other cell is a tie, and a hair decides it."""
    ties = [RangeReading(0, math.atan2(1, 2) + hair, ReadingStatus.OK, 9.0) for hair in (0.0, 1e-12, -1e-12)]
    plain = [RangeReading(0, 0.3 + hair, ReadingStatus.OK, 9.0) for hair in (0.0, 1e-12, -1e-12)]
    for readings, least, most in ((ties, 2, 3), (plain, 1, 1)):
        beams = kernels.draw.draw_beams(Readings.of(readings).rows, turned(np.zeros(1)), HOW)
        assert listed(beams, 1) == expected_beams(readings, np.zeros(1))
        used = len(np.unique(beams.groups)) - 1  # a group that was split up is left without cells
        assert least <= used <= most


@both
def test_a_sweep_too_large_for_one_batch_is_taken_in_several(kernels: Kernels) -> None:
    readings = [RangeReading(0, 0.01 * k, ReadingStatus.OK, 0.3 + 0.01 * k) for k in range(1200)]
    headings = np.array([0.0, 0.5, 1.1, 2.2])
    beams = kernels.draw.draw_beams(Readings.of(readings).rows, turned(headings), HOW)
    assert len(beams.batches) > 2
    assert listed(beams, 4) == expected_beams(readings, headings)


@settings(max_examples=40, deadline=None)
@given(maps, st.booleans(), st.tuples(st.integers(0, TILE_ROWS - 1), st.integers(0, WORD_CELLS - 1)))
def test_a_packed_map_holds_every_cell_with_its_outside_all_round(
    occupied: NDArray[np.bool_], outside: bool, origin: tuple[int, int]
) -> None:
    words = pack(occupied, origin, outside=outside)
    rows, cols = occupied.shape
    for row, col in itertools.product((-TILE_ROWS, -1, 0, rows // 2, rows - 1, rows), (-128, -1, 0, cols - 1, cols)):
        word, bit = divmod(col + origin[1] + 2 * WORD_CELLS, WORD_CELLS)
        inside = 0 <= row < rows and 0 <= col < cols
        assert bool(words[word, row + origin[0] + TILE_ROWS] >> np.uint64(bit) & np.uint64(1)) == (
            bool(occupied[row, col]) if inside else outside
        )


def test_tiles_without_free_cells_are_left_out() -> None:
    occupied = np.ones((100, 200), np.bool_)
    occupied[40, 70] = occupied[99, 199] = False
    the_map = packed(occupied)
    assert the_map.origin == (32 - 8, 64 - 6)
    assert the_map.tiles.tolist() == [[2, 64], [4, 96]]


def values(counters: Words) -> NDArray[np.uint64]:
    weights = (np.uint64(1) << np.arange(counters.shape[2], dtype=np.uint64))[:, None, None]
    bits = counters[..., None] >> np.arange(64, dtype=np.uint64) & np.uint64(1)
    total: NDArray[np.uint64] = (bits * weights).sum(axis=2)
    return total


random_counters = st.integers(0, 2**32).map(
    lambda seed: np.random.default_rng(seed).integers(0, 2**64, (2, 3, 4, TILE_ROWS), np.uint64)
)


@both
@settings(max_examples=20, deadline=None)
@given(random_counters, st.integers(0, 17))
def test_the_greatest_count_and_the_counts_that_reach_a_threshold(
    kernels: Kernels, counters: Words, least: int
) -> None:
    the_map = packed(np.zeros((64, 64), np.bool_))
    assert kernels.count.greatest(counters) == values(counters).max()
    reached = kernels.count.at_least(counters, the_map, least)
    bits = np.unpackbits(reached.view(np.uint8), axis=-1, bitorder="little")
    assert np.array_equal(bits, (values(counters) >= least).transpose(1, 0, 2, 3).reshape(3, 64, 64))


@both
@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**32),
    shape=st.tuples(st.integers(2, 70), st.integers(2, 150)),
    headings=st.integers(1, 4),
    bits=st.integers(1, 6),
    block=st.sampled_from([1, 1, 2, 3, 64, 200]),
    more=st.integers(0, 40),
    rim=st.integers(0, 1),
)
def test_heat_is_the_greatest_count_over_headings_and_over_blocks(  # six numbers make a case
    kernels: Kernels, seed: int, shape: tuple[int, int], headings: int, bits: int, block: int, more: int, rim: int
) -> None:
    the_map = drawn_map(seed, shape, True, True, 1)
    tiles = len(the_map.tiles)
    counters = np.random.default_rng(seed).integers(0, 2**64, (tiles, headings, bits, TILE_ROWS), np.uint64)
    readings = 2**bits - 1 + more
    counts = np.zeros((the_map.rows, the_map.words * WORD_CELLS), np.int64)
    for (word, row), of_tile in zip(the_map.tiles.tolist(), values(counters), strict=True):
        counts[row : row + TILE_ROWS, word * WORD_CELLS : (word + 1) * WORD_CELLS] = of_tile.max(axis=0)
    top, left = the_map.origin[0] + rim, the_map.origin[1] + rim
    rows, cols = shape = shape[0] - rim, shape[1] - rim
    counts = counts[top : top + rows, left : left + cols]
    slow = [
        [counts[row : row + block, col : col + block].max() * 255 // readings for col in range(0, cols, block)]
        for row in range(0, rows, block)
    ]
    assert kernels.count.heat(counters, the_map, (top, left), shape, readings=readings, block=block).tolist() == slow


@both
def test_no_count_of_the_largest_numbers_is_lost(kernels: Kernels) -> None:
    counters = np.full((1, 1, 16, TILE_ROWS), ~np.uint64(0))
    the_map = packed(np.zeros((32, 64), np.bool_))
    assert kernels.count.greatest(counters) == 65535
    assert kernels.count.at_least(counters, the_map, 65535).all()
    assert not kernels.count.at_least(counters, the_map, 65536).any()
    assert (kernels.count.heat(counters, the_map, (0, 0), (32, 64), readings=65535, block=1) == 255).all()


def counted(
    kernels: Kernels,
    readings: list[RangeReading],
    headings: NDArray[np.float64],
    the_map: PackedMap,
    counters: Words,
    **how: Any,
) -> Words:
    beams = kernels.draw.draw_beams(Readings.of(readings).rows, turned(headings), HOW)
    counters = counters.copy()
    kernels.count.count_feasible(counters, the_map, beams, **how)
    return counters


@settings(max_examples=40, deadline=None)
@given(packed_maps, work)
def test_what_is_taken_back_was_never_counted(
    the_map: PackedMap, drawn: tuple[list[RangeReading], NDArray[np.float64]]
) -> None:
    readings, headings = drawn
    blank = the_map.blank_counters(len(headings), 4)
    first = counted(TWINS, readings[:2], headings, the_map, blank)
    both_parts = counted(TWINS, readings[2:], headings, the_map, first) if readings[2:] else first
    assert np.array_equal(both_parts, counted(TWINS, readings, headings, the_map, blank))
    back = counted(TWINS, readings[:2], headings, the_map, both_parts, subtract=True)
    assert np.array_equal(back, counted(TWINS, readings[2:], headings, the_map, blank) if readings[2:] else blank)


@needs_native
@pytest.mark.parametrize("instructions", ["portable", "avx2", "avx512"])
@settings(max_examples=40, deadline=None)
@given(packed_maps, work, st.booleans())
def test_every_instruction_set_counts_what_numpy_counts(
    instructions: str, the_map: PackedMap, drawn: tuple[list[RangeReading], NDArray[np.float64]], subtract: bool
) -> None:
    readings, headings = drawn
    start = the_map.blank_counters(len(headings), 5)
    start[:, :, 3] = ~np.uint64(0)
    expected = counted(TWINS, readings, headings, the_map, start, subtract=subtract)
    try:
        found = counted(NATIVE, readings, headings, the_map, start, subtract=subtract, instructions=instructions)
    except ValueError:
        pytest.skip(f"this processor has no {instructions}")
    assert np.array_equal(found, expected)


@needs_native
@pytest.mark.parametrize("threads", [2, 3, 40])
def test_the_number_of_threads_changes_nothing(threads: int) -> None:
    random = np.random.default_rng(threads)
    the_map = packed(random.random((150, 200)) < 0.02)
    readings = [
        RangeReading(0, math.tau * k / TURN_STEPS, ReadingStatus.OK, float(random.uniform(0.2, 20.0)))
        for k in range(TURN_STEPS)
    ]
    headings = np.array(even_headings(TURN_STEPS))
    blank = the_map.blank_counters(TURN_STEPS, 5)
    alone = counted(NATIVE, readings, headings, the_map, blank)
    assert alone.any()
    assert np.array_equal(counted(NATIVE, readings, headings, the_map, blank, threads=threads), alone)


def test_the_kernels_in_use_are_named_with_a_reason() -> None:
    assert kernels_in_use.in_use().about.compiled == (NATIVE is not TWINS)
    assert kernels_in_use.in_use().about.instructions in {"numpy", "portable", "avx2", "avx512"}
    assert kernels_in_use.in_use().about.reason in str(kernels_in_use.in_use().about)


@pytest.mark.parametrize(("draws", "counts"), [(NATIVE, TWINS), (TWINS, NATIVE)], ids=["c draws", "numpy draws"])
def test_what_is_chosen_computes_until_something_else_is(draws: Kernels, counts: Kernels) -> None:
    """A table of mixed rows stands for a processor that does one thing better."""
    own, mixed = kernels_in_use.in_use(), replace(counts, draw=draws.draw)
    readings = [RangeReading(0, 0.1 * k, ReadingStatus.OK, 2.0 + k) for k in range(9)]
    headings, the_map = np.array(even_headings(5)), packed(np.eye(100, dtype=np.bool_))
    blank = the_map.blank_counters(5, 4)
    with using(mixed):
        assert kernels_in_use.in_use() is mixed
        found = counted(kernels_in_use.in_use(), readings, headings, the_map, blank)
    assert kernels_in_use.in_use() is own
    assert found.any()
    for others in kernels_in_use.AVAILABLE:
        assert np.array_equal(found, counted(others, readings, headings, the_map, blank))
