"""Rays: one sample per cell of the dominant axis, against the rule spelled out."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.grid.ray import ray_cells
from robotd.localization.reference.pixelized_vector import ray_offsets

SHAPE = (12, 17)
coordinates = st.floats(-25.0, 40.0)
bearings = st.one_of(st.floats(-7.0, 7.0), st.sampled_from([k * math.pi / 4 for k in range(-8, 9)]))
lengths = st.floats(0.0, 80.0)
rays = st.tuples(coordinates, coordinates, bearings, lengths)


def slow_ray(row: float, col: float, bearing_rad: float, length_cells: float) -> list[tuple[int, int]]:
    """The rule of ``ray.py``, a step at a time and without clipping."""
    sin, cos = math.sin(bearing_rad), math.cos(bearing_rad)
    dominant = max(abs(sin), abs(cos))
    cells, k = [], 0
    while k < length_cells * dominant:
        cells.append((math.floor(row + k * (sin / dominant)), math.floor(col + k * (cos / dominant))))
        k += 1
    return cells


@settings(max_examples=150)
@given(st.lists(rays, max_size=6))
def test_many_rays_at_once_are_the_rays_one_by_one_clipped(beams: list[tuple[float, float, float, float]]) -> None:
    array = np.array(beams, np.float64).reshape(-1, 4)
    ray, cell = ray_cells(array[:, :2], array[:, 2], array[:, 3], SHAPE)
    expected = [
        (number, row * SHAPE[1] + col)
        for number, beam in enumerate(beams)
        for row, col in slow_ray(*beam)
        if 0 <= row < SHAPE[0] and 0 <= col < SHAPE[1]
    ]
    assert list(zip(ray.tolist(), cell.tolist(), strict=True)) == expected


@given(bearings, st.floats(0.01, 60.0))
def test_offsets_are_the_ray_from_the_centre_of_a_cell(bearing_rad: float, length: float) -> None:
    assert [tuple(offset) for offset in ray_offsets(bearing_rad, length)] == slow_ray(0.5, 0.5, bearing_rad, length)


@given(bearings, st.floats(0.01, 60.0))
def test_cells_are_neighbours_from_the_start_and_never_come_twice(bearing_rad: float, length: float) -> None:
    offsets = ray_offsets(bearing_rad, length)
    assert offsets[0].tolist() == [0, 0]
    assert (np.abs(np.diff(offsets, axis=0)).max(axis=1, initial=0) == 1).sum() == len(offsets) - 1
    assert len({tuple(offset) for offset in offsets}) == len(offsets)


@given(bearings, st.floats(0.0, 60.0), st.floats(0.0, 60.0))
def test_a_shorter_ray_is_a_prefix_of_a_longer_one(bearing_rad: float, one: float, other: float) -> None:
    short, long = ray_offsets(bearing_rad, min(one, other)), ray_offsets(bearing_rad, max(one, other))
    assert np.array_equal(short, long[: len(short)])


@given(bearings, st.floats(0.5, 60.0))
def test_the_last_cell_touches_the_cell_of_the_end(bearing_rad: float, length: float) -> None:
    end = (math.floor(0.5 + length * math.sin(bearing_rad)), math.floor(0.5 + length * math.cos(bearing_rad)))
    assert np.abs(ray_offsets(bearing_rad, length)[-1] - end).max() <= 1


def test_a_ray_of_no_length_is_the_robots_own_cell() -> None:
    assert ray_offsets(1.0, -3.0).tolist() == [[0, 0]]


def test_an_absurdly_long_ray_costs_no_more_than_the_grid_is_wide() -> None:
    ray, cell = ray_cells(np.array([[0.5, 0.5]]), np.array([0.0]), np.array([1e18]), SHAPE)
    assert cell.tolist() == list(range(SHAPE[1]))
    assert ray.tolist() == [0] * SHAPE[1]


def test_a_drawn_ray() -> None:
    _, cell = ray_cells(np.array([[0.5, 0.5]]), np.array([math.atan2(2, 5)]), np.array([6.0]), (4, 8))
    drawn = np.zeros((4, 8), int)
    drawn.flat[cell] = 1
    assert drawn.tolist() == [
        [1, 1, 0, 0, 0, 0, 0, 0],
        [0, 0, 1, 1, 0, 0, 0, 0],
        [0, 0, 0, 0, 1, 1, 0, 0],
        [0, 0, 0, 0, 0, 0, 0, 0],
    ]
