"""One line of the benchmarks, and what this machine can do at this moment to compare it with."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class Timing:
    """How long something took, run after run."""

    name: str
    seconds: tuple[float, ...]
    goal_ms: float | None = None
    """What its median should not exceed on the reference machine."""
    note: str = ""
    """What else was measured: errors, shares, bytes."""

    @property
    def least_s(self) -> float:
        """The smallest time: other programs slow a run down, they never speed it up."""
        return min(self.seconds)

    def row(self, yardstick_s: float) -> str:
        """Return its row of the table of :func:`tests.benchmarks.run.page_of`."""
        median, low, high = (1e3 * np.percentile(self.seconds, share) for share in (50, 10, 90))
        cells = (
            self.name,
            f"{median:.3f}",
            f"{low:.3f} - {high:.3f}",
            f"{1e3 * self.least_s:.3f}",
            f"{self.least_s / yardstick_s:.3g}",
            "" if self.goal_ms is None else f"{self.goal_ms:g}",
            str(len(self.seconds)),
            self.note,
        )
        return f"| {' | '.join(cells)} |"


def timed(name: str, function: Callable[[], object], repeats: int, *, goal_ms: float | None = None) -> Timing:
    """Run a function so often, after once to warm up."""
    function()
    seconds = []
    for _ in range(repeats):
        begin = time.perf_counter()
        function()
        seconds.append(time.perf_counter() - begin)
    return Timing(name, tuple(seconds), goal_ms)


def yardstick() -> Timing:
    """OR two arrays of 1 MiB, word by word: what all ratios are to, measured again before each section."""
    words = np.random.default_rng(0).integers(0, 2**63, 1 << 17, np.uint64)
    return timed("yardstick: OR 1 MiB with 1 MiB", lambda: np.bitwise_or(words, words[::-1]), 50)


def copying() -> Timing:
    """Copy 32 MiB: the memory's bandwidth."""
    words = np.zeros(1 << 22, np.uint64)
    target = np.ones_like(words)
    return timed("yardstick: copy 32 MiB", lambda: np.copyto(target, words), 25)
