"""Feasible poses by convolution against the definition, pose by pose and cell by cell."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.core.reading import RangeReading, ReadingStatus
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.reference.feasible_poses import blocked_set, endpoint_set, feasible_poses
from robotd.localization.reference.probe import probe_of

RESOLUTION_M = 0.25
maps = hnp.arrays(
    np.bool_, hnp.array_shapes(min_dims=2, max_dims=2, max_side=11), elements=st.sampled_from([False] * 5 + [True])
)
angles = st.floats(-math.pi, math.pi)
readings = st.builds(
    RangeReading,
    st.just(0),
    angles,
    st.sampled_from([ReadingStatus.OK, ReadingStatus.OK, ReadingStatus.MISS]),
    st.floats(0.01, 4.0),
    origin_x_m=st.sampled_from([0.0, 0.0, 0.3, -0.6]),
    origin_y_m=st.sampled_from([0.0, 0.0, 0.4]),
)
radii = st.sampled_from([0.0, 1.0, 1.5, 2.0, 3.7])


def is_occupied(occupied: NDArray[np.bool_], row: int, col: int) -> bool:
    """Whatever lies outside the grid counts as occupied."""
    inside = 0 <= row < occupied.shape[0] and 0 <= col < occupied.shape[1]
    return bool(occupied[row, col]) if inside else True


def slow_feasible(
    occupied: NDArray[np.bool_], reading: RangeReading, heading: float, radius: float
) -> NDArray[np.bool_]:
    """Walk every beam from every cell."""
    assert reading.range_m is not None
    bearing, range_cells = heading + reading.bearing_rad, reading.range_m / RESOLUTION_M
    x_cells, y_cells = reading.origin_x_m / RESOLUTION_M, reading.origin_y_m / RESOLUTION_M
    ahead = math.cos(heading) * x_cells - math.sin(heading) * y_cells
    up = math.sin(heading) * x_cells + math.cos(heading) * y_cells
    sin, cos = math.sin(bearing), math.cos(bearing)
    dominant = max(abs(sin), abs(cos))
    feasible = np.zeros_like(occupied)
    for row, col in np.ndindex(occupied.shape):
        start_row, start_col = row + math.floor(up + 0.5), col + math.floor(ahead + 0.5)
        body, k = [(row, col), (start_row, start_col)], 1
        while k < (range_cells - radius) * dominant:
            body.append(
                (start_row + math.floor(0.5 + k * (sin / dominant)), start_col + math.floor(0.5 + k * (cos / dominant)))
            )
            k += 1
        head = (row + math.floor(up + range_cells * sin + 0.5), col + math.floor(ahead + range_cells * cos + 0.5))
        reach = math.ceil(radius)
        near = any(
            is_occupied(occupied, head[0] + i, head[1] + j)
            for i in range(-reach, reach + 1)
            for j in range(-reach, reach + 1)
            if i * i + j * j <= radius * radius
        )
        free = not any(is_occupied(occupied, *cell) for cell in body)
        feasible[row, col] = free and (near or reading.status is ReadingStatus.MISS)
    return feasible


@settings(max_examples=200)
@given(maps, readings, angles, radii)
def test_convolution_gives_the_poses_that_the_definition_gives(
    occupied: NDArray[np.bool_], reading: RangeReading, heading: float, radius: float
) -> None:
    probe = probe_of(
        reading, heading, resolution_m=RESOLUTION_M, error_radius_cells=radius, reach_cells=2 * max(occupied.shape)
    )
    feasible = feasible_poses(Obstacles.of(occupied, radius), probe)
    assert np.array_equal(feasible, slow_feasible(occupied, reading, heading, radius))


offsets = st.lists(st.tuples(st.integers(-13, 13), st.integers(-13, 13)), min_size=1, max_size=6)


@given(maps, offsets)
def test_whatever_the_body_a_cell_is_blocked_by_obstacles_and_by_the_edge(
    occupied: NDArray[np.bool_], body: list[tuple[int, int]]
) -> None:
    blocked = blocked_set(occupied, np.array(body))
    for row, col in np.ndindex(occupied.shape):
        assert blocked[row, col] == any(is_occupied(occupied, row + i, col + j) for i, j in body)


def drawn(*rows: str) -> NDArray[np.bool_]:
    """Return the cells marked ``#``, the first row being the top."""
    return np.array([[cell == "#" for cell in row] for row in reversed(rows)])


ROOM = drawn(
    "########",
    "#......#",
    "#..#...#",
    "#......#",
    "########",
)
EAST_3 = probe_of(
    RangeReading(0, 0.0, ReadingStatus.OK, 3.0), 0.0, resolution_m=1.0, error_radius_cells=0.0, reach_cells=20
)


def test_the_papers_figure_5_on_a_drawn_room() -> None:
    """M (-) z less M (-) l(0, z): three cells before a wall, with nothing in between."""
    obstacles = Obstacles.of(ROOM, 0.0)
    assert np.array_equal(
        feasible_poses(obstacles, EAST_3),
        drawn(
            "........",
            "....#...",
            "....#...",
            "....#...",
            "........",
        ),
    )
    assert np.array_equal(
        endpoint_set(obstacles.grown, EAST_3.head or (0, 0)) & ~ROOM,
        drawn(
            "........",
            "....###.",
            "....###.",
            "....###.",
            "........",
        ),
    )
    assert np.array_equal(
        blocked_set(ROOM, EAST_3.body) & ~ROOM,
        drawn(
            "........",
            ".....##.",
            ".##..##.",
            ".....##.",
            "........",
        ),
    )


def test_a_beam_longer_than_the_grid_is_blocked_everywhere() -> None:
    reading = RangeReading(0, 0.3, ReadingStatus.MISS, 1e9)
    probe = probe_of(reading, 0.0, resolution_m=1.0, error_radius_cells=1.0, reach_cells=20)
    assert not feasible_poses(Obstacles.of(np.zeros((5, 8), np.bool_), 1.0), probe).any()
    assert len(probe.body) <= 20


def test_a_reading_that_measured_nothing_is_no_probe() -> None:
    with pytest.raises(ValueError, match="weak"):
        probe_of(
            RangeReading(0, 0.0, ReadingStatus.WEAK, None), 0.0, resolution_m=1.0, error_radius_cells=1.0, reach_cells=9
        )


def test_turning_the_world_a_quarter_turns_the_feasible_poses() -> None:
    reading = RangeReading(0, 0.4, ReadingStatus.OK, 4.2)
    still, turned = (
        feasible_poses(
            Obstacles.of(np.ascontiguousarray(occupied), 1.0),
            probe_of(reading, heading, resolution_m=1.0, error_radius_cells=1.0, reach_cells=20),
        )
        for occupied, heading in ((ROOM, 0.0), (np.rot90(ROOM, -1), math.pi / 2))
    )
    assert still.any()
    assert np.array_equal(np.rot90(still, -1), turned)
