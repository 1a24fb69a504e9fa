"""What unknown cells and grazing beams mean, against walking every beam from every cell."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.ternary import TernaryMap
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.obstacles.unknown_cells import UnknownCells
from robotd.localization.reference.feasible_poses import feasible_poses
from robotd.localization.reference.probe import probe_of

VACANT, UNKNOWN, OCCUPIED = 0, 1, 2
values = hnp.arrays(
    np.int8,
    hnp.array_shapes(min_dims=2, max_dims=2, max_side=11),
    elements=st.sampled_from([VACANT] * 5 + [UNKNOWN, OCCUPIED]),
)
readings = st.builds(
    RangeReading,
    st.just(0),
    st.floats(-3.2, 3.2),
    st.sampled_from([ReadingStatus.OK, ReadingStatus.OK, ReadingStatus.MISS]),
    st.floats(0.1, 12.0),
    origin_x_m=st.sampled_from([0.0, 0.0, 1.2]),
)


def map_of(cells: NDArray[np.int8]) -> TernaryMap:
    rows, cols = cells.shape
    return TernaryMap(GridSpec(1.0, 0.0, 0.0, (rows, cols)), cells == OCCUPIED, cells == VACANT)


@settings(max_examples=150)
@given(values, readings, st.sampled_from(UnknownCells), st.sampled_from([1, 2]), st.sampled_from([0.0, 1.0, 2.3]))
def test_feasible_poses_are_those_of_the_definition(
    cells: NDArray[np.int8], reading: RangeReading, unknown: UnknownCells, blocked_by: int, radius: float
) -> None:
    probe = probe_of(reading, 0.3, resolution_m=1.0, error_radius_cells=radius, reach_cells=40)

    def value(row: int, col: int) -> int:
        inside = 0 <= row < cells.shape[0] and 0 <= col < cells.shape[1]
        return int(cells[row, col]) if inside else UNKNOWN

    def blocks(row: int, col: int) -> bool:
        return value(row, col) == OCCUPIED or (value(row, col) == UNKNOWN and unknown is not UnknownCells.FREE)

    def ends(row: int, col: int) -> bool:
        return value(row, col) == OCCUPIED or (value(row, col) == UNKNOWN and unknown is UnknownCells.OCCUPIED)

    def near(row: int, col: int) -> bool:
        if not (0 <= row < cells.shape[0] and 0 <= col < cells.shape[1]):
            return unknown is UnknownCells.OCCUPIED
        reach = range(-3, 4)
        return any(ends(row + i, col + j) for i in reach for j in reach if i * i + j * j <= radius * radius)

    expected = np.zeros(cells.shape, np.bool_)
    for row, col in np.ndindex(cells.shape):
        met = sum(blocks(row + i, col + j) for i, j in probe.body.tolist())
        at_end = probe.head is None or near(row + probe.head[0], col + probe.head[1])
        expected[row, col] = value(row, col) == VACANT and met < blocked_by and at_end
    obstacles = Obstacles.of_map(map_of(cells), unknown, radius, blocked_by=blocked_by)
    assert np.array_equal(feasible_poses(obstacles, probe), expected)


@given(values, st.sampled_from([0.0, 1.5]))
def test_unknown_cells_as_obstacles_are_the_papers_binary_map(cells: NDArray[np.int8], radius: float) -> None:
    three, two = Obstacles.of_map(map_of(cells), UnknownCells.OCCUPIED, radius), Obstacles.of(cells != VACANT, radius)
    for name in ("free", "blocking", "grown"):
        assert np.array_equal(getattr(three, name), getattr(two, name))
    assert (three.outside_blocks, three.outside_ends, three.blocked_by) == (True, True, 1)


def test_only_a_cell_that_was_never_updated_is_unknown() -> None:
    grid = OccupancyGrid(GridSpec(0.05, 0.0, 0.0, (1, 3)), np.array([[127, 128, 129]], np.uint8))
    ternary = TernaryMap.from_grid(grid)
    assert ternary.vacant.tolist() == [[True, False, False]]
    assert ternary.unknown.tolist() == [[False, True, False]]
    assert ternary.occupied.tolist() == [[False, False, True]]


def test_what_contradicts_itself_is_refused() -> None:
    spec, one, none = GridSpec(1.0, 0.0, 0.0, (1, 1)), np.ones((1, 1), np.bool_), np.zeros((1, 1), np.bool_)
    with pytest.raises(ValueError, match="both occupied and vacant"):
        TernaryMap(spec, one, one)
    with pytest.raises(ValueError, match=r"occupied: expected bool\[1, 1\]"):
        TernaryMap(spec, np.ones((1, 2), np.bool_), none)
    with pytest.raises(ValueError, match="both free and blocking"):
        Obstacles(one, one, none)
    with pytest.raises(ValueError, match="shapes differ"):
        Obstacles(one, none, np.zeros((2, 1), np.bool_))
    with pytest.raises(ValueError, match="blocked_by must be 1 or 2, got 3"):
        Obstacles(one, none, none, blocked_by=3)
