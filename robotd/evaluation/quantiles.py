"""Percentiles of a stream of numbers in bounded memory."""

import math
from array import array
from collections import Counter
from dataclasses import dataclass, field

import numpy as np

PERCENTILES = (50, 90, 99, 100)
EXACT_MAX = 4096
"""Up to here every number is kept; beyond, only how many lie in each bin."""
_BIN = math.log(1.005)


@dataclass(slots=True, eq=False)
class Quantiles:
    """Numbers that are not negative: exact percentiles of the first 4096, of more to half a percent.

    Theory of operation: bins are as wide as half a percent of what they hold, so a number is known to that share
    whatever its size, and from a nanometre to a thousand kilometres there are seven thousand of them. Least and
    greatest are always exact.
    """

    values: "array[float]" = field(default_factory=lambda: array("d"))
    """All numbers, as long as they are few."""
    bins: Counter[int] | None = None
    """How many lie in each bin, once they are many."""
    least: float = math.inf
    most: float = 0.0

    def __len__(self) -> int:
        """Return how many numbers were added."""
        return len(self.values) if self.bins is None else self.bins.total()

    def add(self, value: float) -> None:
        """Take one more; O(1).

        Raises:
            ValueError: it is negative or not finite.
        """
        if not (math.isfinite(value) and value >= 0.0):
            raise ValueError(f"expected a finite number that is not negative, got {value}")
        self.least, self.most = min(self.least, value), max(self.most, value)
        if self.bins is not None:
            self.bins[_bin_of(value)] += 1
            return
        self.values.append(value)
        if len(self.values) > EXACT_MAX:
            self.bins = Counter(map(_bin_of, self.values))
            self.values = array("d")

    def merge(self, other: "Quantiles") -> None:
        """Take all that another has seen."""
        if other.bins is None:
            for value in other.values:
                self.add(value)
            return
        self.least, self.most = min(self.least, other.least), max(self.most, other.most)
        mine = Counter(map(_bin_of, self.values)) if self.bins is None else self.bins
        self.bins, self.values = mine + other.bins, array("d")

    def percentile(self, percent: float) -> float:
        """Return a percentile, interpolated between neighbours as long as all numbers are kept.

        Raises:
            ValueError: there are no numbers.
        """
        if not len(self):
            raise ValueError("no numbers have no percentiles")
        if self.bins is None:
            return float(np.percentile(np.frombuffer(self.values), percent))
        wanted = round(percent / 100 * (len(self) - 1))
        if wanted == 0:
            return self.least
        if wanted == len(self) - 1:
            return self.most
        passed = 0
        for index in sorted(self.bins):
            passed += self.bins[index]
            if passed > wanted:
                return min(max(_middle_of(index), self.least), self.most)
        raise AssertionError("bins hold as many numbers as were counted")

    def told(self) -> dict[str, float] | None:
        """Return the percentiles that are told, by name; None if there are no numbers."""
        return {f"p{percent}": self.percentile(percent) for percent in PERCENTILES} if len(self) else None


_ZERO = -(1 << 30)
"""The bin of zero, whose logarithm has none."""


def _bin_of(value: float) -> int:
    return math.floor(math.log(value) / _BIN) if value > 0.0 else _ZERO


def _middle_of(index: int) -> float:
    return 0.0 if index == _ZERO else math.exp((index + 0.5) * _BIN)
