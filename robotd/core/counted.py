"""What is counted while a program runs: counters, gauges and distributions, by name and labels. Pure.

Names and labels are as Prometheus wants them, but without a prefix: base units, counters end in ``_total``. A label is
a word of a list that somebody can write down, never text of others: there are never more of them than that.
"""

from bisect import bisect_left
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

BOUNDS_S = (0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0, 60.0)
"""Upper bounds of the buckets of every distribution, which are all of seconds: from a turn of a loop to a search."""

Labels = tuple[tuple[str, str], ...]
Key = tuple[str, Labels]


@dataclass(slots=True)
class Distribution:
    """How often a value fell into each bucket."""

    counts: list[int] = field(default_factory=lambda: [0] * (len(BOUNDS_S) + 1))
    """Of each bucket alone, the last one without bound."""
    total: float = 0.0

    def take(self, value: float) -> None:
        """Count a value; one that is a bound belongs below it."""
        self.counts[bisect_left(BOUNDS_S, value)] += 1
        self.total += value


class Counted:
    """Everything that one process counts."""

    def __init__(self) -> None:
        self.counters: Counter[Key] = Counter()
        self.distributions: dict[Key, Distribution] = {}
        self.gauges: dict[Key, Callable[[], float]] = {}
        """Read when they are told."""

    def count(self, name: str, by: int = 1, **labels: str) -> None:
        """Add to a counter."""
        # In the order of the call: each place that counts a name writes its labels alike, so nothing need be
        # sorted each time.
        self.counters[name, tuple(labels.items())] += by

    def observe(self, name: str, seconds: float, **labels: str) -> None:
        """Add to a distribution."""
        self.distributions.setdefault((name, tuple(labels.items())), Distribution()).take(seconds)

    def show(self, name: str, read: Callable[[], float], **labels: str) -> None:
        """Tell what this reads, whenever somebody asks."""
        self.gauges[name, tuple(labels.items())] = read
