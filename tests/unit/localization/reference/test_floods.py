"""Floods against the paper's queue, against the L2 disk, and against the Minkowski sum."""

import itertools
from collections import deque

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.grid.footprints import dilate, disk_footprint
from robotd.localization.reference.floods import Metric, flood, grown

shapes = hnp.array_shapes(min_dims=2, max_dims=2, max_side=12)
metrics = st.sampled_from(Metric)
limits = st.none() | st.integers(0, 9)


def masks(shape: tuple[int, ...], one_in: int) -> st.SearchStrategy[NDArray[np.bool_]]:
    return hnp.arrays(np.bool_, shape, elements=st.sampled_from([True] + [False] * (one_in - 1)))


def slow_flood(
    sources: NDArray[np.bool_], metric: Metric, limit: int | None, obstacles: NDArray[np.bool_]
) -> NDArray[np.int32]:
    """The procedure of sec. 2.3.2, word for word."""
    numbers = np.full(sources.shape, -1, np.int32)
    queue = deque((int(row), int(col)) for row, col in np.argwhere(sources & ~obstacles))
    for cell in queue:
        numbers[cell] = 0
    while queue:
        row, col = queue.popleft()
        number = int(numbers[row, col])
        if number == limit:
            continue
        for i, j in itertools.product((-1, 0, 1), repeat=2):
            across_corner = i != 0 and j != 0
            if across_corner and metric.pattern[number % len(metric.pattern)] == 4:
                continue
            inside = 0 <= row + i < sources.shape[0] and 0 <= col + j < sources.shape[1]
            if inside and not obstacles[row + i, col + j] and numbers[row + i, col + j] == -1:
                numbers[row + i, col + j] = number + 1
                queue.append((row + i, col + j))
    return numbers


@settings(max_examples=150)
@given(st.data(), shapes, metrics, limits)
def test_contours_are_those_of_the_papers_queue_with_limit_and_obstacles_150_cases(
    data: st.DataObject, shape: tuple[int, ...], metric: Metric, limit: int | None
) -> None:
    sources, obstacles = data.draw(masks(shape, 12)), data.draw(masks(shape, 3))
    numbers = flood(sources, metric, limit=limit, obstacles=obstacles)
    assert numbers.dtype == np.int32
    assert np.array_equal(numbers, slow_flood(sources, metric, limit, obstacles))


@given(shapes.flatmap(lambda shape: masks(shape, 12)), st.sampled_from([Metric.L1, Metric.L_INFINITY]))
def test_in_the_open_the_number_is_the_distance_to_the_nearest_source(
    sources: NDArray[np.bool_], metric: Metric
) -> None:
    order = 1 if metric is Metric.L1 else np.inf
    numbers = flood(sources, metric)
    for cell in np.ndindex(sources.shape):
        distances = np.linalg.norm(np.argwhere(sources) - cell, ord=order, axis=1)
        assert numbers[cell] == (distances.min() if distances.size else -1)


def octagon(steps: int) -> NDArray[np.bool_]:
    point = np.zeros((2 * steps + 5,) * 2, np.bool_)
    point[steps + 2, steps + 2] = True
    return flood(point, Metric.OCTAGON, limit=steps) >= 0


def disk(radius_cells: float, like: NDArray[np.bool_]) -> NDArray[np.bool_]:
    rows, cols = np.indices(like.shape) - like.shape[0] // 2
    inside: NDArray[np.bool_] = rows**2 + cols**2 <= radius_cells**2
    return inside


@pytest.mark.parametrize("steps", range(6))
def test_up_to_five_steps_the_octagon_is_the_l2_disk_that_reaches_as_far_beyond_the_source_cell(steps: int) -> None:
    assert np.array_equal(octagon(steps), disk(steps + 0.5, octagon(steps)))
    assert np.array_equal(octagon(steps)[2:-2, 2:-2], disk_footprint(steps + 0.5))


@pytest.mark.parametrize("steps", range(24))
def test_up_to_23_steps_the_octagons_boundary_is_within_one_cell_of_the_disks(steps: int) -> None:
    cells = octagon(steps)
    assert not (disk(max(0.0, steps - 0.5), cells) & ~cells).any()
    assert not (cells & ~disk(steps + 1.5, cells)).any()


def octagon_of(steps: int, across_corners: int) -> NDArray[np.bool_]:
    rows, cols = np.abs(np.indices((2 * steps + 5,) * 2) - steps - 2)
    cells: NDArray[np.bool_] = (np.maximum(rows, cols) <= steps) & (rows + cols <= steps + across_corners)
    return cells


def test_what_the_octagon_is_follows_from_the_count_of_steps_across_corners() -> None:
    for steps in range(24):
        assert np.array_equal(octagon(steps), octagon_of(steps, -(-steps // 3)))


def test_no_pattern_at_all_makes_the_disk_of_radius_3_or_4_round_the_centre() -> None:
    """Why the disk to compare with is the one of radius r + 1/2: for r = 3 and 4 the other is no octagon at all."""
    for steps in (3, 4):
        for across in range(steps + 1):
            cells = octagon_of(steps, across)
            assert not np.array_equal(cells, disk(steps, cells))


def test_no_shorter_pattern_equals_the_disk_up_to_four_steps() -> None:
    def made_by(pattern: tuple[int, ...], steps: int) -> NDArray[np.bool_]:
        return octagon_of(steps, sum(pattern[i % len(pattern)] == 8 for i in range(steps)))

    shorter = [pattern for length in (1, 2) for pattern in itertools.product((4, 8), repeat=length)]
    for pattern in shorter:
        assert any(
            not np.array_equal(made_by(pattern, steps), disk(steps + 0.5, octagon(steps))) for steps in range(1, 5)
        )


@settings(max_examples=60)
@given(shapes.flatmap(lambda shape: masks(shape, 9)), metrics, st.integers(0, 7), st.booleans())
def test_c_space_growth_is_the_minkowski_sum_with_the_metrics_disk(
    obstacles: NDArray[np.bool_], metric: Metric, radius: int, outside: bool
) -> None:
    point = np.zeros((2 * radius + 1,) * 2, np.bool_)
    point[radius, radius] = True
    footprint = flood(point, metric, limit=radius) >= 0
    expected = dilate(obstacles, footprint, outside=outside)
    assert np.array_equal(grown(obstacles, radius, metric, outside=outside), expected)


def test_a_closed_door_keeps_the_flood_in() -> None:
    room = np.array([[0, 0, 1, 0], [0, 0, 1, 0]], np.bool_)
    start = np.zeros_like(room)
    start[0, 0] = True
    assert flood(start, Metric.L1, obstacles=room).tolist() == [[0, 1, -1, -1], [1, 2, -1, -1]]


def test_a_negative_radius_is_refused() -> None:
    with pytest.raises(ValueError, match="radius_cells"):
        grown(np.zeros((2, 2), np.bool_), -1, Metric.L1)
