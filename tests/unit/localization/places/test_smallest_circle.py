"""The smallest circle against all circles that two or three points can decide."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.localization.places.smallest_circle import smallest_circle

clouds = hnp.arrays(np.float64, st.tuples(st.integers(1, 9), st.just(2)), elements=st.integers(-6, 6).map(float))


def slow_radius(points: NDArray[np.float64]) -> float:
    """The least radius of all circles on a diameter or through three points that hold all of them."""
    best = np.inf if len(np.unique(points, axis=0)) > 1 else 0.0
    for count in (2, 3):
        for chosen in combinations(points, count):
            # The centre lies as far from each chosen point, in the plane of their differences.
            sides = np.array([other - chosen[0] for other in chosen[1:]])
            centre = chosen[0] + np.linalg.pinv(sides) @ (0.5 * (sides * sides).sum(axis=1))
            radius = float(np.hypot(*(chosen[0] - centre)))
            if (np.hypot(*(points - centre).T) <= radius + 1e-6).all():
                best = min(best, radius)
    return best


@settings(max_examples=150, deadline=None)
@given(clouds)
def test_the_circle_holds_all_points_and_none_smaller_does(points: NDArray[np.float64]) -> None:
    x, y, radius = smallest_circle(points)
    assert (np.hypot(*(points - np.array([x, y])).T) <= radius + 1e-6).all()
    assert radius == pytest.approx(slow_radius(points), abs=1e-6)


def test_many_points_are_no_trouble() -> None:
    angles = np.linspace(0.0, 6.28, 20_000)
    ring = 3.0 * np.stack((np.cos(angles), np.sin(angles)), axis=1) + np.array([1e3, -1e3])
    assert smallest_circle(ring) == pytest.approx((1e3, -1e3, 3.0), abs=1e-5)
