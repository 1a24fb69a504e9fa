"""The directional flood against walking every ray, and the look-ahead as the paper describes it against both."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.localization.reference import directional_flood as module
from robotd.localization.reference.directional_flood import directional_flood, is_ray
from robotd.localization.reference.pixelized_vector import ray_offsets

sources_of_any_shape = hnp.arrays(
    np.bool_,
    st.tuples(st.integers(1, 14), st.integers(1, 14)),
    elements=st.sampled_from([False] * 7 + [True]),
)
wide_sources = st.builds(
    lambda seed, rows, cols, share: np.random.default_rng(seed).random((rows, cols)) < share,
    st.integers(0, 2**32),
    st.integers(1, 9),
    st.integers(60, 200),
    st.sampled_from([0.003, 0.03, 0.3]),
)
edges_between_cells = st.builds(math.atan2, st.integers(-6, 6), st.integers(-6, 6))
bearings = st.one_of(st.floats(-7.0, 7.0), edges_between_cells)


def slow_flood(sources: NDArray[np.bool_], chain: NDArray[np.intp], *, outside: bool) -> NDArray[np.int32]:
    """Walk every ray from its cell on."""
    rows, cols = sources.shape
    numbers = np.full(sources.shape, -1, np.int32)
    for row, col in np.ndindex(sources.shape):
        for k, (i, j) in enumerate(chain.tolist()):
            inside = 0 <= row + i < rows and 0 <= col + j < cols
            if sources[row + i, col + j] if inside else outside:
                numbers[row, col] = k
                break
    return numbers


@settings(max_examples=200)
@given(sources_of_any_shape, bearings, st.floats(0.0, 25.0), st.booleans())
def test_each_cell_gets_the_index_of_the_first_source_on_its_ray_200_cases(
    sources: NDArray[np.bool_], bearing_rad: float, length_cells: float, outside: bool
) -> None:
    chain = ray_offsets(bearing_rad, length_cells)
    numbers = directional_flood(sources, chain, outside=outside)
    assert numbers.dtype == np.int32
    assert np.array_equal(numbers, slow_flood(sources, chain, outside=outside))


@settings(max_examples=40)
@given(wide_sources, bearings, st.floats(0.0, 250.0), st.booleans(), st.booleans())
def test_grids_of_several_words_are_flooded_the_same_40_cases(
    sources: NDArray[np.bool_], bearing_rad: float, length_cells: float, outside: bool, tall: bool
) -> None:
    grid = sources.T if tall else sources
    chain = ray_offsets(bearing_rad, length_cells)
    assert np.array_equal(directional_flood(grid, chain, outside=outside), slow_flood(grid, chain, outside=outside))


@settings(max_examples=60)
@given(sources_of_any_shape, st.lists(st.integers(-1, 1), max_size=20), st.booleans())
def test_even_a_chain_that_is_no_straight_line_is_followed_exactly(
    sources: NDArray[np.bool_], turns: list[int], outside: bool
) -> None:
    aside = np.concatenate(([0], np.cumsum(turns, dtype=np.intp)))
    chain = np.stack((aside, np.arange(len(aside))), axis=1)
    assert np.array_equal(
        directional_flood(sources, chain, outside=outside), slow_flood(sources, chain, outside=outside)
    )


@settings(max_examples=60)
@given(wide_sources, st.lists(st.tuples(st.integers(-1, 1), st.integers(1, 90)), max_size=5), st.booleans())
def test_a_chain_that_bends_far_out_leaves_all_lines_and_is_followed_exactly(
    sources: NDArray[np.bool_], bends: list[tuple[int, int]], outside: bool
) -> None:
    turns = [turn for turn, times in bends for _ in range(times)]
    aside = np.concatenate(([0], np.cumsum(turns, dtype=np.intp)))
    chain = np.stack((aside, np.arange(len(aside))), axis=1)
    assert np.array_equal(
        directional_flood(sources, chain, outside=outside), slow_flood(sources, chain, outside=outside)
    )


def test_a_chain_that_bends_away_from_a_low_wide_grid() -> None:
    """It was refused by an error about shapes: its far end lies many rows beyond all lines of the grid."""
    aside = np.concatenate((np.zeros(40, np.intp), -np.arange(1, 60)))
    chain = np.stack((aside, np.arange(len(aside))), axis=1)
    sources = np.zeros((2, 100), np.bool_)
    sources[0, 50] = True
    expected = slow_flood(sources, chain, outside=False)
    assert np.array_equal(directional_flood(sources, chain), expected)
    assert (expected >= 0).sum() > 40


@pytest.mark.parametrize("length_cells", [9.0, 120.0, 1e4])
@pytest.mark.parametrize("bearing_rad", [0.0, 0.1, 0.7, 1.0, math.pi / 4, math.atan2(1, 2), math.atan2(5, 6)])
def test_the_work_does_not_grow_with_the_length(
    bearing_rad: float, length_cells: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Counts the column moves, the only part of the sweep whose number is not fixed: some a column, not some a cell."""
    moves = []
    set_column = module._Lines._set_column

    def counted(lines: module._Lines, col: int, shift: int) -> None:
        moves.append(col)
        set_column(lines, col, shift)

    monkeypatch.setattr(module._Lines, "_set_column", counted)
    directional_flood(np.zeros((256, 256), np.bool_), ray_offsets(bearing_rad, min(length_cells, 600.0)))
    assert len(moves) <= 9 * 256


@given(bearings, st.floats(0.0, 300.0))
def test_what_is_drawn_from_the_centre_of_a_cell_is_a_ray(bearing_rad: float, length_cells: float) -> None:
    assert is_ray(ray_offsets(bearing_rad, length_cells))


def test_what_bends_is_no_ray() -> None:
    assert not is_ray(np.array([[0, 0], [0, 1], [0, 2], [1, 3], [2, 4]]))
    assert not is_ray(np.array([[0, 0], [2, 3], [2, 4]]))


def test_what_is_no_chain_is_refused() -> None:
    sources = np.zeros((3, 3), np.bool_)
    for chain in ([], [[0, 1]], [[0, 0], [0, 2]], [[0, 0], [0, 1], [1, 1]], [[0, 0], [0, 1], [2, 2]]):
        with pytest.raises(ValueError, match="chain"):
            directional_flood(sources, np.array(chain, np.intp).reshape(-1, 2))


def test_more_cells_along_the_beam_than_two_words_can_index_are_refused() -> None:
    with pytest.raises(ValueError, match="4096"):
        directional_flood(np.zeros((1, 4097), np.bool_), ray_offsets(0.0, 3.0))
    sources = np.zeros((1, 4096), np.bool_)
    sources[0, -1] = True
    assert directional_flood(sources, ray_offsets(0.0, 1e4))[0].tolist() == list(range(4095, -1, -1))


def flood_as_described(sources: NDArray[np.bool_], chain: NDArray[np.intp]) -> NDArray[np.bool_]:
    """The directional flood of sec. 2.3.2 with its look-ahead, for chains that run along +col.

    More generous than described: it looks ahead whether or not the neighbour bears a lower number.
    """
    length, never = len(chain), len(chain)
    numbers = np.where(sources, 0, never)
    # The copy, translated by one pixel in the dominant direction, covers cell k if its cell k - 1 lies in the same row.
    uncovered = [k for k in range(1, length) if chain[k, 0] != chain[k - 1, 0]]
    for col in range(sources.shape[1] - 1, -1, -1):
        for row in range(sources.shape[0]):
            number = int(numbers[row, col])
            ahead = [k for k in uncovered if k > number + 1][:1]
            for k in [number + 1, *ahead] if number < length - 1 else []:
                i, j = (row, col) - (chain[k] - chain[number])
                if 0 <= i < sources.shape[0] and 0 <= j < sources.shape[1]:
                    numbers[i, j] = min(numbers[i, j], k)
    return numbers < never


def drawn(*rows: str, marks: str = "#") -> NDArray[np.bool_]:
    """Return the cells marked so, the first row being the top."""
    return np.array([[cell in marks for cell in row] for row in reversed(rows)])


GENTLE = ray_offsets(0.25, 6.1)
COUNTER_EXAMPLES = [
    pytest.param(
        GENTLE,
        (
            ".....o#",
            ".xxxo#.",
            "oooo...",
            ".......",
        ),
        id="two cells that touch at a corner",
    ),
    pytest.param(
        ray_offsets(0.54, 6.1),
        (
            "..........#",
            "........oo.",
            "......x#...",
            ".....oo....",
            "...oo......",
            "..o........",
        ),
        id="two cells apart",
    ),
]


def test_the_chain_of_the_drawing_is_the_one_in_the_text() -> None:
    assert GENTLE.tolist() == [[0, 0], [0, 1], [1, 2], [1, 3], [1, 4], [1, 5]]


@pytest.mark.parametrize(("chain", "picture"), COUNTER_EXAMPLES)
def test_the_look_ahead_as_described_misses_cells_that_ours_does_not(
    chain: NDArray[np.intp], picture: tuple[str, ...]
) -> None:
    sources = drawn(*picture)
    assert np.array_equal(flood_as_described(sources, chain), drawn(*picture, marks="#o"))
    assert np.array_equal(directional_flood(sources, chain) >= 0, drawn(*picture, marks="#ox"))


@pytest.mark.parametrize("bearing_rad", [0.0, 0.12, 0.25, 0.4, 0.6, 0.75])
def test_for_solid_upright_obstacles_the_look_ahead_as_described_is_right(bearing_rad: float) -> None:
    """Figure 16: so the look-ahead above is the paper's, and not a straw man."""
    chain = ray_offsets(bearing_rad, 9.0)
    for height, width in np.ndindex(4, 9):
        sources = np.zeros((16, 24), np.bool_)
        sources[9 : 10 + height, 12 : 13 + width] = True
        assert np.array_equal(flood_as_described(sources, chain), directional_flood(sources, chain) >= 0)
