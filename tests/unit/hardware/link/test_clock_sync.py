"""Offset and drift of a board's clock, found from pings alone."""

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.hardware.link.clock_sync import ClockSample, ClockSync, fit

S = 1_000_000_000


def board_us(host_ns: int, offset_us: int, skew_ppm: float) -> int:
    return offset_us + round(host_ns / 1000 * (1 + skew_ppm * 1e-6))


def pinged(offset_us: int, skew_ppm: float, seconds: int, randomness: random.Random) -> ClockSync:
    """Eight quick pings, then one a second, over a line whose delays vary and that sometimes stutters."""
    sync = ClockSync()
    times_ns = [50 * S + index * 3_000_000 for index in range(8)] + [(51 + second) * S for second in range(seconds)]
    for sent_ns in times_ns:
        out_ns, back_ns = (round(1_000_000 + randomness.expovariate(1 / 100_000)) for _ in range(2))
        if randomness.random() < 0.2:
            back_ns += randomness.randrange(30_000_000)
        sync.add(sent_ns // 1000, board_us(sent_ns + out_ns, offset_us, skew_ppm), sent_ns + out_ns + back_ns)
    return sync


@settings(max_examples=60, deadline=None)
@given(
    offset_us=st.integers(0, 2**60),
    skew_ppm=st.floats(-100, 100),
    seconds=st.integers(20, 120),
    seed=st.integers(0, 2**32),
)
def test_offset_and_drift_are_found_through_a_stuttering_line(
    offset_us: int, skew_ppm: float, seconds: int, seed: int
) -> None:
    # A clock that has counted to 2**60 us ran for 36,000 years; the arithmetic must not lose its microseconds.
    sync = pinged(0, skew_ppm, seconds, random.Random(seed))
    shifted = ClockSync()
    for sample in sync._samples:
        half_ns = sample.round_trip_ns // 2
        sent_us = (sample.host_ns - half_ns) // 1000
        shifted.add(sent_us, sample.board_ns // 1000 + offset_us, sample.host_ns - half_ns + sample.round_trip_ns)
    event_ns = (52 + seconds) * S
    assert abs(shifted.host_ns(board_us(event_ns, 0, skew_ppm) + offset_us) - event_ns) < 300_000
    assert shifted.best is not None
    assert abs(shifted.best.rate - 1 / (1 + skew_ppm * 1e-6)) < 40e-6


def test_eight_quick_pings_fix_the_offset_before_the_drift_can_be_known() -> None:
    sync = pinged(123_456_789, 40.0, 0, random.Random(1))
    event_ns = 51 * S
    assert abs(sync.host_ns(board_us(event_ns, 123_456_789, 40.0)) - event_ns) < 300_000
    assert sync.best is not None
    assert sync.best.rate == 1.0


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32))
def test_times_never_run_backwards_however_the_fit_improves(seed: int) -> None:
    randomness = random.Random(seed)
    sync = ClockSync()
    mapped: list[tuple[int, int]] = []
    for second in range(20):
        sent_ns = second * S
        delay_ns = randomness.randrange(1_000_000, 40_000_000)
        sync.add(sent_ns // 1000, board_us(sent_ns + delay_ns // randomness.randint(2, 9), 7, 60.0), sent_ns + delay_ns)
        for _ in range(5):
            last_us = mapped[-1][0] if mapped else second * 1_000_000
            asked_us = last_us + randomness.randrange(0, 300_000)
            mapped.append((asked_us, sync.host_ns(asked_us)))
    assert mapped == sorted(mapped, key=lambda pair: pair[1])


def test_a_time_before_the_last_one_is_not_mapped_after_it() -> None:
    sync = ClockSync()
    sync.add(0, 1_000, 2_000_000)
    later = sync.host_ns(10_000)
    assert sync.host_ns(9_000) < later


@pytest.mark.parametrize("received_ns", [-1, 1_000_000_001])
def test_an_impossible_round_trip_teaches_nothing(received_ns: int) -> None:
    sync = ClockSync()
    sync.add(0, 500, received_ns)
    assert sync.best is None


def test_without_a_ping_there_is_no_time() -> None:
    with pytest.raises(ValueError, match="never seen"):
        ClockSync().host_ns(1)
    with pytest.raises(ValueError, match="never seen"):
        fit(())


def test_the_shortest_round_trip_decides() -> None:
    good = ClockSample(board_ns=1_000_000, host_ns=5_000_000, round_trip_ns=2_000_000)
    bad = ClockSample(board_ns=2_000_000, host_ns=26_000_000, round_trip_ns=42_000_000)
    assert abs(fit((good, bad)).at(1_000) - 5_000_000) < 1_000


@pytest.mark.parametrize("lie_us", [3_600_000_000, -3_600_000_000, 200_000, -(2**40), 2**63])
@pytest.mark.parametrize("which", [0, 5, 20])
def test_one_liar_among_honest_pings_moves_nothing(lie_us: int, which: int) -> None:
    sync = ClockSync()
    believed = []
    for second in range(40):
        sent_us = (50 + second) * 1_000_000
        honest_us = sent_us + 1_000 + 2**50
        believed.append(sync.add(sent_us, honest_us + lie_us * (second == which), sent_us * 1000 + 2_000_000))
        if second >= 2:
            assert abs(sync.host_ns(honest_us) - (sent_us + 1000) * 1000) < 100_000
    assert believed.index(False) in {which, which + 1}  # of two that disagree either may lie
    assert believed.count(False) == 1


def test_a_clock_that_jumped_for_good_is_followed_when_most_pings_say_so() -> None:
    sync = ClockSync()
    for second in range(60):
        sent_us = second * 1_000_000
        board_us = sent_us + 1_000 + 3_600_000_000 * (second >= 20)
        sync.add(sent_us, board_us, sent_us * 1000 + 2_000_000)
    assert abs(sync.host_ns(59_001_000 + 3_600_000_000) - 59_001_000_000) < 100_000
