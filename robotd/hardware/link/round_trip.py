"""How long to wait for an answer before asking again."""

TIMEOUT_MIN_S = 0.025
"""A board answers within 10 ms: to ask again much sooner than this only fills the line."""
TIMEOUT_MAX_S = 0.5
"""Both bounds are those of PROTOCOL.md, and so is the start."""
_TIMEOUT_START_S = 0.05
_MEAN_GAIN = 1 / 8
_DEVIATION_GAIN = 1 / 4
"""Both gains, and the four deviations of the timeout, are those of the RFC."""


class RoundTrip:
    """Smoothed round-trip time of one kind of request (the estimator of RFC 6298).

    A sample is measured from the first try, so after a loss it is too long rather than too short.
    """

    def __init__(self) -> None:
        self._mean_s: float | None = None
        self._deviation_s = 0.0

    def add(self, sample_s: float) -> None:
        """Learn from an answer that took ``sample_s``."""
        if self._mean_s is None:
            self._mean_s, self._deviation_s = sample_s, sample_s / 2
            return
        # The deviation first, from the mean as it was before this sample: the order of the RFC.
        self._deviation_s += _DEVIATION_GAIN * (abs(sample_s - self._mean_s) - self._deviation_s)
        self._mean_s += _MEAN_GAIN * (sample_s - self._mean_s)

    def timeout_s(self, attempt: int) -> float:
        """Return how long to wait on this try, counted from 0: each waits twice as long as the one before."""
        first_s = _TIMEOUT_START_S if self._mean_s is None else self._mean_s + 4 * self._deviation_s
        return min(max(first_s, TIMEOUT_MIN_S) * (1 << attempt), TIMEOUT_MAX_S)
