"""Percentiles of streams: exact while numbers are few, and within half a percent of the sorted list for ever after."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.evaluation import quantiles
from robotd.evaluation.quantiles import PERCENTILES, Quantiles

SIZES = st.floats(0.0, 1e6) | st.just(0.0) | st.floats(1e-9, 1e-3)


def seen(values: list[float]) -> Quantiles:
    found = Quantiles()
    for value in values:
        found.add(value)
    return found


@given(values=st.lists(SIZES, min_size=1, max_size=200))
def test_few_numbers_have_the_percentiles_of_numpy(values: list[float]) -> None:
    assert seen(values).told() == {f"p{percent}": np.percentile(values, percent) for percent in PERCENTILES}


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(quantiles, "EXACT_MAX", 20)


@pytest.mark.usefixtures("few")
@given(values=st.lists(SIZES, min_size=21, max_size=300), percent=st.integers(0, 100), cut=st.integers(0, 300))
@settings(deadline=None)
def test_many_numbers_are_known_to_half_a_percent(values: list[float], percent: int, cut: int) -> None:
    wanted = sorted(values)[round(percent / 100 * (len(values) - 1))]
    parts = seen(values[:cut])
    parts.merge(seen(values[cut:]))
    for found in (seen(values), parts):
        assert len(found) == len(values)
        assert found.percentile(percent) == pytest.approx(wanted, rel=0.005, abs=0.0)


@pytest.mark.usefixtures("few")
def test_the_bins_are_bounded_by_what_sizes_there_are() -> None:
    found = seen(np.geomspace(1e-9, 1e9, 20_000).tolist())
    assert found.bins is not None
    assert len(found.bins) <= math.log(1e18) / math.log(1.005) + 2
    assert (found.percentile(0), found.percentile(100)) == pytest.approx((1e-9, 1e9))


@pytest.mark.parametrize("value", [-1.0, math.nan, math.inf])
def test_what_has_no_place_in_an_order_is_refused(value: float) -> None:
    with pytest.raises(ValueError, match="expected a finite number that is not negative"):
        Quantiles().add(value)


def test_no_numbers_have_no_percentiles() -> None:
    assert Quantiles().told() is None
    with pytest.raises(ValueError, match="no numbers"):
        Quantiles().percentile(50)
