"""Fans: every beam that the bounds allow runs through the windows, line by line, and steps no farther aside."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.grid.fans import WINDOW_CELLS_MAX, Fans, direction_keys, draw_fans, start_keys

bearings = st.one_of(st.floats(-4.0, 4.0), st.integers(-8, 8).map(lambda k: k * math.pi / 8))
offsets = st.one_of(st.just(0.0), st.floats(-3.0, 3.0))
shares = st.one_of(st.sampled_from([-1.0, 1.0]), st.floats(-1.0, 1.0))
turns = st.sampled_from([0.0, 0.001, 0.0105, 0.1, math.pi / 8])


def fan_of(bearing: float, start: tuple[float, float], turn: float, count: int = 40) -> Fans:
    return draw_fans(direction_keys(np.array([bearing])), start_keys(np.array([start])), turn, count)


@settings(max_examples=300)
@given(bearings, offsets, offsets, turns, shares, shares, shares, st.floats(0.0, 50.0))
def test_every_beam_within_the_bounds_is_met_in_the_windows_before_it_is_so_long_300_cases(
    bearing: float, row: float, col: float, turn: float, up: float, right: float, turned: float, length: float
) -> None:
    fans = fan_of(bearing, (row, col), turn)
    axis, forward, first, least, greatest, _, _ = fans.lines[0].tolist()
    delta = turned * turn
    sin, cos = math.sin(delta), math.cos(delta)
    start = (0.5 * up + cos * row + sin * col, 0.5 * right + cos * col - sin * row)
    ahead = (math.sin(bearing + delta), math.cos(bearing + delta))
    before = None
    crossed = int(fans.lines_crossed(np.zeros(1, np.intp), np.array([length]))[0])
    for number, (low, high) in enumerate(fans.windows[:crossed].tolist()):
        way = (forward * (first + number) - start[axis]) / ahead[axis]
        assert 0.0 <= way < length
        cell = math.floor(start[1 - axis] + way * ahead[1 - axis] + 0.5)
        assert low <= cell <= high
        assert before is None or least <= cell - before <= greatest
        before = cell


def test_a_beam_that_is_not_turned_is_met_in_two_cells_of_a_line_or_three() -> None:
    for bearing in np.linspace(-3.0, 3.0, 50).tolist():
        fans = fan_of(bearing, (0.0, 0.0), 0.0)
        widths = fans.windows[:, 1] - fans.windows[:, 0] + 1
        assert set(widths.tolist()) <= {2, 3, 4}
        assert fans.lines[0, 2] == 1


def test_a_fan_ends_where_it_gets_too_wide() -> None:
    windows = fan_of(0.3, (0.0, 0.0), math.pi / 8, 200).windows
    assert (windows[:, 1] - windows[:, 0] < WINDOW_CELLS_MAX).all()
    assert 10 < len(windows) < 200


def test_directions_a_turn_apart_are_one_and_robots_are_small() -> None:
    assert direction_keys(np.array([1.0])) == direction_keys(np.array([1.0 - math.tau]))
    with pytest.raises(ValueError, match="thousand cells"):
        start_keys(np.array([[0.0, 2000.0]]))
