"""Bearings to all sides: each once, and no large gap after any number of them."""

import math

import pytest

from robotd.sensing.spread import quadrants, spread_order


@pytest.mark.parametrize("bearings", [1, 2, 7, 39, 261, 300])
def test_each_is_taken_once(bearings: int) -> None:
    assert sorted(spread_order(bearings)) == list(range(bearings))


@pytest.mark.parametrize("bearings", [100, 261, 300])
def test_after_any_number_of_them_no_gap_is_three_times_the_mean(bearings: int) -> None:
    order = spread_order(bearings)
    for count in range(4, bearings):
        taken = sorted(order[:count])
        gaps = [after - before for before, after in zip(taken, [*taken[1:], taken[0] + bearings], strict=True)]
        # One more: places between bearings are rounded to one.
        assert max(gaps) <= 3.0 * bearings / count + 1.0, count


def test_quadrants_are_counted_all_round() -> None:
    assert quadrants([]) == 0
    assert quadrants([0.1, 1.5]) == 1
    assert quadrants([0.1, 2.0, -2.0, -0.1]) == 4
    assert quadrants([math.tau + 0.1, 0.1]) == 1
