"""Stops that look behind all that is open, against every set of places there is."""

from itertools import combinations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from robotd.exploring.cover import Covering, covering
from robotd.exploring.settings import Pace

PACE = Pace(sweep_s=30.0, speed_mps=0.3)


def covered(behind_m2: list[list[float]], at_m: list[float], least_m2: float = 0.5) -> Covering:
    """Covering stretches from places on a line; the robot stands at 0."""
    places_m = np.array(at_m)
    return covering(np.array(behind_m2), np.abs(places_m), lambda one: np.abs(places_m - places_m[one]), PACE, least_m2)


def test_one_stop_that_sees_several_comes_before_one_for_each() -> None:
    assert covered([[4.0, 0.0], [0.0, 4.0], [3.0, 3.0]], [1.0, 2.0, 3.0]).places == (2,)


def test_ways_are_those_between_what_was_found() -> None:
    cover = covered([[4.0, 0.0], [0.0, 3.9], [0.1, 0.1]], [1.0, -3.0, 0.0])
    assert cover.places == (0, 1)
    assert cover.ways_m.tolist() == [[0.0, 1.0, 3.0], [1.0, 0.0, 4.0], [3.0, 4.0, 0.0]]


def test_what_adds_too_little_is_left_unless_it_is_all_there_is() -> None:
    assert covered([[4.0, 0.0], [0.0, 0.4]], [1.0, 2.0]).places == (0,)
    assert covered([[0.4, 0.0], [0.0, 0.3]], [1.0, 2.0]).places == (0,)


@st.composite
def sights(draw: st.DrawFn) -> NDArray[np.bool_]:
    """Return which of up to five places sees which of up to six stretches, ``bool[places, stretches]``."""
    shape = draw(st.tuples(st.integers(1, 5), st.integers(1, 6)))
    cells = draw(st.lists(st.booleans(), min_size=shape[0] * shape[1], max_size=shape[0] * shape[1]))
    return np.array(cells).reshape(shape)


@given(sights())
def test_it_sees_all_with_hardly_more_stops_than_the_fewest(sees: NDArray[np.bool_]) -> None:
    cover = covered((4.0 * sees).tolist(), [0.0] * len(sees))
    found = sees[list(cover.places)].any(axis=0)
    assert found.tolist() == sees.any(axis=0).tolist()
    # Greedy covers are worse than the best by no more than the harmonic number of the stretches: 2.45 of six.
    assert len(cover.places) <= max(1.0, 2.45 * _fewest(sees))


def _fewest(sees: NDArray[np.bool_]) -> int:
    for count in range(len(sees) + 1):
        for places in combinations(range(len(sees)), count):
            if sees[list(places)].any(axis=0).tolist() == sees.any(axis=0).tolist():
                return count
    raise AssertionError("all places together see what any sees")
