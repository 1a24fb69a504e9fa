"""The robot's state and counters in the text format of Prometheus, for a collector of files.

Where nothing serves pages, a timer runs this into a file::

    robotctl status --metrics > /var/lib/prometheus/node-exporter/robotd.prom
"""

from collections.abc import Iterable, Iterator

from robotd.contract.metric_families import Labels, MetricFamily
from robotd.contract.metrics import Buckets

_PREFIX = "robotd_"


def exposition(families: Iterable[MetricFamily]) -> str:
    """Return families as lines; one without samples is left out."""
    return "".join(line for family in families if family.samples or family.distributions for line in _lines(family))


def _lines(family: MetricFamily) -> Iterator[str]:
    name = _PREFIX + family.name + ("_total" if family.kind == "counter" else "")
    yield f"# HELP {name} {family.meaning}\n# TYPE {name} {family.kind}\n"
    yield from (f"{name}{_labels(labels)} {value:.12g}\n" for labels, value in family.samples)
    for one in family.distributions:
        yield from _buckets(name, one)


def _buckets(name: str, one: Buckets) -> Iterator[str]:
    labels = tuple(one.labels.items())
    bounds = [*(f"{bound:g}" for bound in one.bounds), "+Inf"]
    for bound, count in zip(bounds, one.counts, strict=True):
        yield f"{name}_bucket{_labels((*labels, ('le', bound)))} {count}\n"
    yield f"{name}_sum{_labels(labels)} {one.sum:.12g}\n"
    yield f"{name}_count{_labels(labels)} {one.counts[-1]}\n"


def _labels(labels: Labels) -> str:
    return "{" + ",".join(f'{name}="{value}"' for name, value in labels) + "}" if labels else ""
