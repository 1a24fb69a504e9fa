"""The robot's state and counters in the text format of Prometheus, for a collector of files.

The daemon has no network and serves no pages. Anyone who watches many robots lets a timer run this into a file::

    robotctl status --metrics > /var/lib/prometheus/node-exporter/robotd.prom
"""

from collections.abc import Callable, Iterable, Iterator
from itertools import groupby

from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.contract.events import Status
from robotd.contract.metrics import Buckets, Metrics
from robotd.contract.modes import MODE_WORDS

_Sample = tuple[dict[str, str], float]


def exposition(status: Status) -> str:
    """Return the lines that say what a status says."""
    devices = status.devices
    families = (
        _family("mode", "gauge", "What the robot is at: 1 for that mode.", _modes(status)),
        _family("device_ready", "gauge", "Whether there is a device to talk to.", _each(devices, _is_ready)),
        _family("device_armed", "gauge", "Whether it may move.", _each(devices, lambda one: one.armed)),
        _family("device_faults", "gauge", "Latched faults.", _each(devices, lambda one: len(one.faults))),
        _family(
            "line", "gauge", "What was counted on the line since start, and what its clock does.", _counters(devices)
        ),
        _family("battery_volts", "gauge", "Of the base.", [] if status.battery_v is None else [({}, status.battery_v)]),
    )
    return "".join(families)


def counted(metrics: Metrics) -> str:
    """Return the lines that say what was counted since the start."""
    lines: list[str] = []
    for kind, samples in (("counter", metrics.counters), ("gauge", metrics.gauges)):
        for name, alike in groupby(samples, key=lambda one: one.name):
            lines.append(f"# TYPE robotd_{name} {kind}\n")
            lines += [f"robotd_{name}{_labels(one.labels)} {one.value:.12g}\n" for one in alike]
    for name, distributions in groupby(metrics.histograms, key=lambda one: one.name):
        lines.append(f"# TYPE robotd_{name} histogram\n")
        for one in distributions:
            lines += _buckets(one)
    return "".join(lines)


def _buckets(one: Buckets) -> Iterator[str]:
    bounds = [*(f"{bound:g}" for bound in one.bounds), "+Inf"]
    for bound, count in zip(bounds, one.counts, strict=True):
        yield f"robotd_{one.name}_bucket{_labels({**one.labels, 'le': bound})} {count}\n"
    yield f"robotd_{one.name}_sum{_labels(one.labels)} {one.sum:.12g}\n"
    yield f"robotd_{one.name}_count{_labels(one.labels)} {one.counts[-1]}\n"


def _family(name: str, kind: str, meaning: str, samples: Iterable[_Sample]) -> str:
    lines = [f"robotd_{name}{_labels(labels)} {value:.12g}\n" for labels, value in samples]
    head = f"# HELP robotd_{name} {meaning}\n# TYPE robotd_{name} {kind}\n"
    return head + "".join(lines) if lines else ""


def _labels(labels: dict[str, str]) -> str:
    return "{" + ",".join(f'{name}="{value}"' for name, value in labels.items()) + "}" if labels else ""


def _modes(status: Status) -> Iterator[_Sample]:
    return (({"mode": word}, float(word == status.mode)) for word in MODE_WORDS)


def _each(devices: tuple[DeviceStatus, ...], value: Callable[[DeviceStatus], float]) -> Iterator[_Sample]:
    return (({"device": one.name}, float(value(one))) for one in devices)


def _is_ready(device: DeviceStatus) -> bool:
    return device.link is LinkState.READY


def _counters(devices: tuple[DeviceStatus, ...]) -> Iterator[_Sample]:
    return (({"device": one.name, "what": what}, float(count)) for one in devices for what, count in one.counters)
