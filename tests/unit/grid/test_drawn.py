"""Readings drawn all at once against one drawn by hand."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.drawn import FAR_CELLS, Drawn
from robotd.grid.kernels.draw.draw_kernel import turned
from robotd.grid.readings import Readings
from robotd.localization.reference.pixelized_vector import ray_offsets

RESOLUTION_M, RADIUS, REACH = 0.05, 1.5, 300
readings = st.builds(
    RangeReading,
    st.just(0),
    st.one_of(st.floats(-4.0, 4.0), st.integers(0, 8).map(lambda k: math.tau * k / 8)),
    st.sampled_from([ReadingStatus.OK, ReadingStatus.MISS]),
    st.one_of(st.floats(0.001, 12.0), st.sampled_from([0.05, 3.0, 3.025, 1e9])),
    origin_x_m=st.sampled_from([0.0, 0.0, 0.07, -0.12]),
    origin_y_m=st.sampled_from([0.0, 0.0, 0.03]),
)
headings = st.lists(st.floats(-4.0, 4.0), min_size=1, max_size=3)

Cell = tuple[int, int]


def by_hand(reading: RangeReading, heading_rad: float) -> tuple[list[Cell], Cell]:
    """Return the cells of the body, from the start on, and the head."""
    assert reading.range_m is not None
    bearing_rad, range_cells = heading_rad + reading.bearing_rad, reading.range_m / RESOLUTION_M
    cos, sin = float(np.cos(heading_rad)), float(np.sin(heading_rad))
    row = (sin * reading.origin_x_m + cos * reading.origin_y_m) / RESOLUTION_M
    col = (cos * reading.origin_x_m - sin * reading.origin_y_m) / RESOLUTION_M
    body = [
        (nearest(row) + ahead, nearest(col) + aside)
        for ahead, aside in ray_offsets(bearing_rad, min(range_cells - RADIUS, REACH)).tolist()
    ]
    head = row + range_cells * float(np.sin(bearing_rad)), col + range_cells * float(np.cos(bearing_rad))
    return body, (nearest(head[0]), nearest(head[1]))


def nearest(cells: float) -> int:
    return math.floor(max(-FAR_CELLS, min(FAR_CELLS, cells)) + 0.5)


@settings(max_examples=200, deadline=None)
@given(st.lists(readings, max_size=6), headings)
def test_beams_are_drawn_as_by_hand_one_by_one(several: list[RangeReading], headings_rad: list[float]) -> None:
    drawn = Drawn.of(Readings.of(several), turned(np.array(headings_rad)), RESOLUTION_M)
    lengths = drawn.body_lengths(RADIUS, REACH)
    cells, beam = drawn.bodies(lengths)
    expected = [by_hand(reading, heading_rad) for reading in several for heading_rad in headings_rad]
    assert len(lengths) == len(expected)
    for number, (body, head) in enumerate(expected):
        assert [tuple(cell) for cell in cells[beam == number].tolist()] == body
        assert tuple(drawn.start_cells[number].tolist()) == body[0]
        assert tuple(drawn.head_cells[number].tolist()) == head
    assert drawn.is_miss.tolist() == [r.status is ReadingStatus.MISS for r in several for _ in headings_rad]


def test_a_reading_shorter_than_the_error_radius_has_the_cell_of_its_start() -> None:
    short = RangeReading(0, 0.3, ReadingStatus.OK, 0.01, origin_x_m=0.5)
    drawn = Drawn.of(Readings.of((short,)), turned(np.zeros(1)), RESOLUTION_M)
    cells, _ = drawn.bodies(drawn.body_lengths(RADIUS, REACH))
    assert cells.tolist() == [[0, 10]]
