"""The board's clock as seen from ours: offset and drift from pings.

A ping that left at ``sent`` and was answered at ``received`` met the board's clock somewhere between; the
middle is wrong by half the round trip at most. So samples with short round trips count most, and once
they span enough time a weighted line through them gives the drift too.

A board may lie, or slip a digit: each sample bounds the offset from both sides, and only those count whose bounds have
most of the others' company (the rule by which NTP finds its falsetickers). One liar among honest pings moves nothing.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

_NS_PER_US = 1000
_SAMPLES = 32
"""Half a minute of pings: a clock that really jumped is believed again once most of these say so (decision 19)."""
_DRIFT_SPAN_NS = 5_000_000_000
"""Over a shorter span a fitted slope is mostly the jitter of the round trips."""
_DRIFT_MAX = 1e-3
"""Several times what any crystal is off: a steeper slope is noise, or a lie."""
_JITTER_NS = 50_000
"""Keeps the weight of the quickest ping finite, and gives the bounds of each some slack."""
_ROUND_TRIP_MAX_NS = 1_000_000_000
"""A slower answer bounds the offset no better than to half a second: no evidence."""
AHEAD_MAX_NS = _ROUND_TRIP_MAX_NS // 2
"""How far a true time can lie ahead of when it was heard: the offset is wrong by half a round trip at most."""


@dataclass(frozen=True, slots=True)
class ClockSample:
    """One answered ping."""

    board_ns: int
    host_ns: int
    """The middle between sending and receiving."""
    round_trip_ns: int
    """Half of it is how far ``host_ns`` may be off."""


@dataclass(frozen=True, slots=True)
class ClockFit:
    """``host = host_ns + (board - board_ns) * rate``."""

    board_ns: int
    """Weighted middle of the samples: there a fitted line is known best."""
    host_ns: int
    rate: float
    """Host nanoseconds per board nanosecond."""
    round_trip_us: int = 0
    """The shortest seen lately; the offset is wrong by half of it at most."""

    def at(self, board_us: int) -> int:
        """Return the host's time at a time of the board [ns]."""
        elapsed_ns = board_us * _NS_PER_US - self.board_ns
        # Whole nanoseconds stay whole; only the small part that drifted goes through a float.
        return self.host_ns + elapsed_ns + round(elapsed_ns * (self.rate - 1.0))


def fit(samples: tuple[ClockSample, ...]) -> ClockFit:
    """Fit a line through samples in the order of time, each weighted by how near its round trip is to the shortest.

    O(n). Until the samples span five seconds the clocks are taken to run alike.

    Raises:
        ValueError: there is no sample.
    """
    if not samples:
        raise ValueError("the board's clock was never seen")
    first = samples[0]
    shortest_ns = min(sample.round_trip_ns for sample in samples)
    # What a round trip has over the shortest is how far its middle may be off: the weight is that of a variance.
    weights = [(sample.round_trip_ns - shortest_ns + _JITTER_NS) ** -2.0 for sample in samples]
    elapsed = [sample.board_ns - first.board_ns for sample in samples]
    # The line goes through what one clock gained on the other: small numbers, of which a double loses no digits.
    gained = [sample.host_ns - first.host_ns - since for sample, since in zip(samples, elapsed, strict=True)]
    middle = _mean(weights, elapsed)
    drift = _drift(weights, elapsed, gained) if elapsed[-1] >= _DRIFT_SPAN_NS else 0.0
    return ClockFit(
        board_ns=first.board_ns + round(middle),
        host_ns=first.host_ns + round(middle) + round(_mean(weights, gained)),
        rate=1.0 + drift,
        round_trip_us=shortest_ns // _NS_PER_US,
    )


def _mean(weights: list[float], values: Sequence[float]) -> float:
    return sum(weight * value for weight, value in zip(weights, values, strict=True)) / sum(weights)


def _drift(weights: list[float], elapsed: list[int], gained: list[int]) -> float:
    middle = _mean(weights, elapsed)
    arms = [since - middle for since in elapsed]
    slope = _mean(weights, [arm * gain for arm, gain in zip(arms, gained, strict=True)])
    return max(-_DRIFT_MAX, min(slope / _mean(weights, [arm * arm for arm in arms]), _DRIFT_MAX))


def agreeing(samples: tuple[ClockSample, ...]) -> tuple[ClockSample, ...]:
    """Return the largest group of samples that one offset can explain, the oldest such group, in their order.

    O(n^2). Clocks are taken to run apart by a thousandth at most.
    """
    bounds = [_offset_bounds(sample, samples[-1].host_ns) for sample in samples]
    # Where most intervals overlap, one of them begins, so their lower ends are the only offsets to try.
    groups = [[low <= at <= high for low, high in bounds] for at, _ in bounds]
    best = max(groups, key=sum, default=[])
    return tuple(sample for sample, is_in in zip(samples, best, strict=True) if is_in)


def _offset_bounds(sample: ClockSample, now_ns: int) -> tuple[int, int]:
    """Return what the host's time less the board's can be now, at least and at most [ns]."""
    # An old sample says less about now: the clocks may have run apart since.
    slack_ns = sample.round_trip_ns // 2 + _JITTER_NS + round(abs(now_ns - sample.host_ns) * _DRIFT_MAX)
    offset_ns = sample.host_ns - sample.board_ns
    return offset_ns - slack_ns, offset_ns + slack_ns


class ClockSync:
    """Learns from pings; translates times of the board, never backwards."""

    def __init__(self) -> None:
        self._samples: deque[ClockSample] = deque(maxlen=_SAMPLES)
        self._fit: ClockFit | None = None
        self._last: tuple[int, int] | None = None

    @property
    def best(self) -> ClockFit | None:
        """The present fit; None until the first sample."""
        return self._fit

    def add(self, sent_us: int, board_us: int, received_ns: int) -> bool:
        """Learn from an answered ping; return whether it agrees with most of the others.

        One that took a second, or none, is no evidence, and disagrees with nobody.
        """
        sent_ns = sent_us * _NS_PER_US
        round_trip_ns = received_ns - sent_ns
        # Negative is an answer to what was not asked yet: an echo of another session.
        if not 0 <= round_trip_ns <= _ROUND_TRIP_MAX_NS:
            return True
        sample = ClockSample(board_us * _NS_PER_US, sent_ns + round_trip_ns // 2, round_trip_ns)
        self._samples.append(sample)
        believed = agreeing(tuple(self._samples))
        self._fit = fit(believed)
        return believed[-1] is sample

    def ahead_ns(self, board_us: int, heard_ns: int) -> int:
        """Return how far a time of the board lies ahead of when it was heard [ns]; 0 if no ping was answered yet."""
        return 0 if self._fit is None else self._fit.at(board_us) - heard_ns

    def host_ns(self, board_us: int) -> int:
        """Return the host's time at a time of the board [ns].

        A better fit never turns the order of two events round: a later time of the board than the last one
        asked for gets no earlier time of the host, and the other way about.

        Raises:
            ValueError: no ping was answered yet.
        """
        if self._fit is None:
            raise ValueError("the board's clock was never seen")
        host_ns = self._fit.at(board_us)
        if self._last is not None:
            last_board_us, last_host_ns = self._last
            # Held, not corrected: two events that change places would be a map drawn the wrong way round.
            host_ns = max(host_ns, last_host_ns) if board_us >= last_board_us else min(host_ns, last_host_ns)
        self._last = (board_us, host_ns)
        return host_ns
