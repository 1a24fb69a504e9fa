"""How far a place reaches: bounds in order, whatever the headings are."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from robotd.core.grid_spec import GridSpec
from robotd.localization.places.shapes import extent_of


@given(heading_rad=st.floats(-math.pi, math.pi))
def test_of_a_single_heading_it_is_no_wider_than_nothing(heading_rad: float) -> None:
    extent = extent_of(np.array([[0, 3, 4]]), GridSpec(0.05, 0.0, 0.0, (10, 10)), (heading_rad,))
    assert 0.0 <= extent.heading_max_rad - extent.heading_min_rad < 1e-9
