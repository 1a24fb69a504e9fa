"""The direction in which points line up: found to a tenth of a degree, however they are turned."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.localization.orientation.sharpest_direction import sharpest_direction


@settings(max_examples=50)
@given(st.floats(0.0, math.pi / 2.0), st.floats(-0.05, 0.05), st.integers(0, 2**32))
def test_the_walls_of_a_corner_tell_their_direction_50_cases(turn_rad: float, off_rad: float, seed: int) -> None:
    random = np.random.default_rng(seed)
    along = random.uniform(0.0, 4.0, (2, 60))
    corner = np.concatenate((np.stack((along[0], along[0] * 0.0), 1), np.stack((along[1] * 0.0, along[1]), 1)))
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    points = (corner + random.normal(0.0, 0.01, corner.shape)) @ np.array([[cos, sin], [-sin, cos]])
    found = sharpest_direction(points, np.ones(len(points)), turn_rad + off_rad, 0.0873)
    assert found == pytest.approx(turn_rad, abs=math.radians(0.3))


def test_a_single_point_leaves_the_guess_as_it_is() -> None:
    assert sharpest_direction(np.zeros((1, 2)), np.ones(1), 0.7, 0.1) == pytest.approx(0.7)


def test_what_weighs_more_decides() -> None:
    line = np.linspace(0.0, 3.0, 40)
    one, other = (np.stack((line * math.cos(angle), line * math.sin(angle)), 1) for angle in (0.0, 0.08))
    points = np.concatenate((one, other + 5.0))
    for heavy, expected in ((0, 0.0), (1, 0.08)):
        weights = np.repeat([1.0, 5.0] if heavy else [5.0, 1.0], 40)
        assert sharpest_direction(points, weights, 0.04, 0.06) == pytest.approx(expected, abs=0.01)
