"""Counts per unit of way, by least squares."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.calibration.scale import fit_scale
from robotd.core.errors import CalibrationError


@given(
    per_unit=st.floats(10.0, 1e6),
    sign=st.sampled_from((-1.0, 1.0)),
    ways=st.lists(st.floats(0.5, 5.0), min_size=1, max_size=6),
)
def test_exact_legs_give_the_exact_scale(per_unit: float, sign: float, ways: list[float]) -> None:
    there = np.array(ways) * np.where(np.arange(len(ways)) % 2, -1.0, 1.0)
    scale = fit_scale(sign * per_unit * there, there, np.full(len(ways), 0.003))
    assert scale.per_unit == pytest.approx(sign * per_unit)
    assert np.abs(scale.residuals).max() < 1e-9
    expected = per_unit * 0.003 / np.sqrt((there**2).sum())
    assert scale.error == pytest.approx(expected)


def test_the_error_it_tells_is_the_error_it_makes() -> None:
    rng = np.random.default_rng(1)
    ways = np.array([1.5, -1.5, 1.5, -1.5])
    off = []
    for _ in range(300):
        scale = fit_scale(27_300.0 * ways, ways + rng.normal(0.0, 0.004, 4), np.full(4, 0.004))
        off.append((scale.per_unit - 27_300.0) / scale.error)
    assert 0.7 < np.std(off) < 1.1


def test_legs_that_disagree_widen_the_error() -> None:
    ways, errors = np.array([1.0, -1.0]), np.array([0.001, 0.001])
    agreed = fit_scale(np.array([1000.0, -1000.0]), ways, errors)
    slipped = fit_scale(np.array([1000.0, -1100.0]), ways, errors)
    assert slipped.error > 10.0 * agreed.error


def test_what_tells_nothing_is_refused() -> None:
    with pytest.raises(CalibrationError, match="far enough"):
        fit_scale(np.array([10.0]), np.array([0.001]), np.array([0.003]))
    with pytest.raises(CalibrationError, match="counted nothing"):
        fit_scale(np.zeros(2), np.ones(2), np.full(2, 0.003))
