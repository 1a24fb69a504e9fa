"""In which order stops wait least, against all orders on a line."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.exploring.order import best_order

SWEEP_S = 5.0


def ordered(at_m: list[float], weights: list[float]) -> tuple[int, ...]:
    """Put stops on a line in order, for a robot that stands at 0 and goes one metre a second."""
    places_m = np.array([0.0, *at_m])
    return best_order(np.abs(places_m[:, None] - places_m) + SWEEP_S, weights)


@pytest.mark.parametrize(
    ("at_m", "weights", "order"),
    [
        ([4.0, 1.0, 2.0], [1.0, 1.0, 1.0], (1, 2, 0)),  # one after the other
        ([-1.0, 8.0], [1.0, 1.0], (0, 1)),  # what is near first
        ([-4.0, 5.0], [1.0, 4.0], (1, 0)),  # unless something large waits
        ([3.0, -3.0], [1.0, 1.0], (0, 1)),  # of equal ones the first
    ],
)
def test_what_comes_first(at_m: list[float], weights: list[float], order: tuple[int, ...]) -> None:
    assert ordered(at_m, weights) == order


PLACES = st.lists(st.tuples(st.integers(-20, 20), st.integers(1, 9)), min_size=1, max_size=5)


@given(PLACES)
def test_no_other_order_waits_less(places: list[tuple[int, int]]) -> None:
    at_m, weights = [float(at) for at, _ in places], [float(weight) for _, weight in places]
    best = ordered(at_m, weights)
    assert sorted(best) == list(range(len(places)))
    assert waiting(at_m, weights, best) == min(
        waiting(at_m, weights, order) for order in permutations(range(len(places)))
    )


def waiting(at_m: list[float], weights: list[float], order: tuple[int, ...]) -> float:
    """Say when each stop is over: ways on a line, added up from the start for each."""
    stops_m = [0.0, *(at_m[stop] for stop in order)]
    over_s = [sum(abs(stops_m[k + 1] - stops_m[k]) + SWEEP_S for k in range(count)) for count in range(1, len(stops_m))]
    return sum(weights[stop] * when_s for stop, when_s in zip(order, over_s, strict=True))
