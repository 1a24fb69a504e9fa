"""What a measured loop notes, and what is made of it."""

from array import array
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

NS_PER_MS = 1e6


@dataclass(frozen=True, slots=True)
class Figures:
    """Of one piece of work [ms]."""

    lag_p50_ms: float
    lag_p999_ms: float
    lag_max_ms: float
    callback_p999_ms: float
    callback_max_ms: float
    over_s: float

    def row(self, *names: str) -> str:
        """Return a line of the table."""
        numbers = (self.lag_p50_ms, self.lag_p999_ms, self.lag_max_ms, self.callback_p999_ms, self.callback_max_ms)
        return "| " + " | ".join((*names, *(f"{number:.2f}" for number in numbers), f"{self.over_s:.1f}")) + " |"


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """Of one daemon, from its start to its end."""

    callbacks: NDArray[np.int64]
    """``int64[n, 2]``: when a callback began on the monotonic clock, and how long it took [ns]."""
    beats: NDArray[np.int64]
    """``int64[m, 2]``: when a timer was due, and how late it was [ns]."""

    @classmethod
    def of(cls, callbacks: "array[int]", beats: "array[int]") -> "Samples":
        """Take what was noted in pairs."""
        return cls(np.array(callbacks, np.int64).reshape(-1, 2), np.array(beats, np.int64).reshape(-1, 2))

    def write(self, file: Path) -> None:
        """Write all of it."""
        np.savez(file, callbacks=self.callbacks, beats=self.beats)

    @classmethod
    def read(cls, file: Path) -> "Samples":
        """Read what :meth:`write` wrote."""
        with np.load(file) as found:
            return cls(found["callbacks"], found["beats"])

    def between(self, began_ns: int, ended_ns: int) -> Figures:
        """Return the figures of what began within a time."""
        lag_ms, callback_ms = (
            np.sort(pairs[(pairs[:, 0] >= began_ns) & (pairs[:, 0] < ended_ns), 1]) / NS_PER_MS
            for pairs in (self.beats, self.callbacks)
        )
        return Figures(
            lag_p50_ms=at_share(lag_ms, 0.5),
            lag_p999_ms=at_share(lag_ms, 0.999),
            lag_max_ms=float(lag_ms[-1]),
            callback_p999_ms=at_share(callback_ms, 0.999),
            callback_max_ms=float(callback_ms[-1]),
            over_s=(ended_ns - began_ns) / 1e9,
        )


def at_share(ascending: NDArray[np.float64], share: float) -> float:
    """Return the least of the numbers that at least this share of them does not exceed."""
    return float(ascending[int(np.ceil(share * len(ascending))) - 1])
