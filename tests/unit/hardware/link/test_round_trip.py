"""How long to wait for an answer."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.hardware.link.round_trip import TIMEOUT_MAX_S, TIMEOUT_MIN_S, RoundTrip


def test_the_first_request_waits_50_ms_and_each_repeat_twice_as_long() -> None:
    trip = RoundTrip()
    assert [trip.timeout_s(attempt) for attempt in range(3)] == pytest.approx([0.05, 0.1, 0.2])


def test_a_quick_board_is_asked_again_after_25_ms() -> None:
    trip = RoundTrip()
    for _ in range(20):
        trip.add(0.002)
    assert trip.timeout_s(0) == TIMEOUT_MIN_S


def test_a_slow_line_is_given_the_time_it_takes() -> None:
    trip = RoundTrip()
    for _ in range(20):
        trip.add(0.2)
    assert 0.2 < trip.timeout_s(0) <= TIMEOUT_MAX_S


@settings(max_examples=50)
@given(st.lists(st.floats(0, 10), max_size=30), st.integers(0, 5))
def test_the_timeout_stays_between_its_bounds(samples: list[float], attempt: int) -> None:
    trip = RoundTrip()
    for sample in samples:
        trip.add(sample)
    assert TIMEOUT_MIN_S <= trip.timeout_s(attempt) <= TIMEOUT_MAX_S
