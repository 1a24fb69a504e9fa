"""Update tables: exact to the rounding, never trapped, never back to 'no information'."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from robotd.grid.tables import lower_table, raise_table

alphas = st.floats(0.0, 1.0, exclude_max=True)


@given(alphas)
@example(0.5)
@example(0.999999)
def test_updates_arrive_at_certainty_from_every_state(alpha: float) -> None:
    for table, end in ((lower_table(alpha), 0), (raise_table(alpha), 255)):
        states = np.arange(256, dtype=np.uint8)
        for _ in range(255):
            states = table[states]
        assert (states == end).all()


@given(alphas)
@example(0.5)
def test_no_update_arrives_at_no_information(alpha: float) -> None:
    assert 128 not in lower_table(alpha)
    assert 128 not in raise_table(alpha)


@given(alphas)
def test_tables_follow_the_rule_to_the_nearest_state_that_makes_progress(alpha: float) -> None:
    states = np.arange(256)
    lower, upper = lower_table(alpha).astype(int), raise_table(alpha).astype(int)
    assert (np.abs(lower - alpha * states) <= 2).all()
    assert (np.abs(upper - (255 - alpha * (255 - states))) <= 2).all()
    assert (lower[1:] < states[1:]).all()
    assert (upper[:-1] > states[:-1]).all()


@given(alphas)
def test_more_evidence_before_is_never_less_after(alpha: float) -> None:
    assert (np.diff(lower_table(alpha).astype(int)) >= 0).all()
    assert (np.diff(raise_table(alpha).astype(int)) >= 0).all()


def test_lilys_tables() -> None:
    assert lower_table(0.15)[[255, 128, 19, 3, 1]].tolist() == [38, 19, 3, 0, 0]
    assert raise_table(0.3)[[0, 128, 217, 254]].tolist() == [179, 217, 244, 255]


@pytest.mark.parametrize("alpha", [-0.1, 1.0, float("nan")])
def test_an_alpha_that_would_never_learn_is_refused(alpha: float) -> None:
    with pytest.raises(ValueError, match="alpha"):
        lower_table(alpha)
