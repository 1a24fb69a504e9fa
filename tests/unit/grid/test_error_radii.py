"""Error radii by range, in levels."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.grid.error_radii import ErrorRadii


@given(st.floats(0.5, 5.0), st.floats(1e-4, 0.2), st.floats(1.0, 3000.0))
def test_each_reading_has_about_the_radius_of_its_range(least: float, angle_rad: float, reach: float) -> None:
    radii = ErrorRadii.growing(least, angle_rad, reach)
    ranges = np.linspace(0.0, reach, 50)
    cells = np.array(radii.cells)[radii.levels(ranges)]
    asked = np.minimum(np.hypot(least, angle_rad * ranges), radii.greatest)
    assert np.all(cells <= asked * 1.2)
    assert np.all(cells >= asked / 1.2)
    assert cells[0] == least
    assert np.all(np.diff(cells) >= 0.0)


def test_there_are_no_more_levels_than_a_reach_asks_for() -> None:
    assert len(ErrorRadii.growing(1.5, 0.01, 90.0).cells) == 1
    assert len(ErrorRadii.growing(1.5, 0.01, 1e9).cells) == 5
    assert ErrorRadii.growing(1.5, 0.0, 1e9).cells == (1.5,)
    assert ErrorRadii.growing(0.0, 0.01, 1e9).cells == (0.0,)


def test_a_range_where_a_level_begins_is_of_it() -> None:
    radii = ErrorRadii((1.0, 2.0, 3.0), (10.0, 20.0))
    assert radii.levels(np.array([0.0, 9.999, 10.0, 20.0, math.inf])).tolist() == [0, 0, 1, 2, 2]


@pytest.mark.parametrize(("cells", "begins"), [((1.0,), (2.0,)), ((2.0, 1.0), (3.0,)), ((1.0, 2.0, 3.0), (5.0, 4.0))])
def test_levels_that_are_none_are_refused(cells: tuple[float, ...], begins: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="expected"):
        ErrorRadii(cells, begins)
