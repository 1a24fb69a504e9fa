"""What was counted since the daemon started, as data: for collectors, who add what they want to call it."""

from itertools import accumulate

import msgspec

from robotd.core.counted import BOUNDS_S, Counted, Distribution


class Sample(msgspec.Struct, frozen=True):
    """A counter, or a gauge."""

    name: str
    labels: dict[str, str]
    value: float


class Buckets(msgspec.Struct, frozen=True):
    """A distribution: how many observations fell below each bound, how many there were, and their sum."""

    name: str
    labels: dict[str, str]
    bounds: tuple[float, ...]
    """Upper bounds of the buckets, ascending."""
    counts: tuple[int, ...]
    """How many values were no more than each bound, and at last how many there were."""
    sum: float

    @classmethod
    def of(cls, name: str, labels: dict[str, str], one: Distribution) -> "Buckets":
        """Return a distribution under its name."""
        return cls(name, labels, BOUNDS_S, tuple(accumulate(one.counts)), one.total)


class Metrics(msgspec.Struct, frozen=True):
    """Everything that was counted, by name and labels."""

    counters: tuple[Sample, ...]
    gauges: tuple[Sample, ...]
    histograms: tuple[Buckets, ...]

    @classmethod
    def of(cls, counted: Counted) -> "Metrics":
        """Return what one process counted."""
        return cls(
            tuple(Sample(name, dict(labels), value) for (name, labels), value in sorted(counted.counters.items())),
            tuple(Sample(name, dict(labels), read()) for (name, labels), read in counted.gauges.items()),
            tuple(
                Buckets.of(name, dict(labels), one)
                for (name, labels), one in sorted(counted.distributions.items(), key=lambda item: item[0])
            ),
        )

    def joined(self, other: "Metrics") -> "Metrics":
        """Return what two processes counted."""
        return Metrics(
            (*self.counters, *other.counters), (*self.gauges, *other.gauges), (*self.histograms, *other.histograms)
        )
