"""What collectors of metrics are told of the robot: its status and what was counted, as families. Pure.

Names are of base units, counters end with ``_total``, and no free text is in a label: there are some hundred series.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby
from typing import Literal

from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.contract.estimate import PoseState
from robotd.contract.events import Status
from robotd.contract.metrics import Buckets, Metrics, Sample
from robotd.contract.modes import MODE_WORDS

Labels = tuple[tuple[str, str], ...]
_NS_PER_S, _US_PER_S = 1e9, 1e6
_CLOCK = {"clock_round_trip_us", "clock_fast_ppb"}
"""Counters that are none: what a board's clock does now."""


@dataclass(frozen=True, slots=True)
class MetricFamily:
    """Series of one name."""

    name: str
    """Without a prefix, and without the ``_total`` of a counter."""
    kind: Literal["gauge", "counter", "info", "histogram"]
    meaning: str
    samples: tuple[tuple[Labels, float], ...]
    distributions: tuple[Buckets, ...] = ()
    """Of a histogram; then there are no samples."""


def of_status(status: Status) -> Iterator[MetricFamily]:
    """Yield what a status says."""
    devices = status.devices
    yield _gauge("mode", "Whether it is at this.", ((_(mode=one), float(one == status.mode)) for one in MODE_WORDS))
    yield _gauge("held", "Whether the mission under way is held.", [((), float(status.held is not None))])
    yield _gauge("map_unsaved", "Whether the map has changes that nobody saved.", [((), float(status.map_unsaved))])
    yield _gauge("recording", "Whether a recording is under way.", [((), float(status.recording is not None))])
    if status.battery_v is not None:
        yield _gauge("battery_volts", "Of the base.", [((), status.battery_v)])
    if status.started_ns is not None:
        up_s = (status.time_ns - status.started_ns) / _NS_PER_S
        yield _gauge("uptime_seconds", "Since the daemon was started.", [((), up_s)])
    yield _gauge("device_ready", "Whether there is a device to talk to.", _each(devices, _is_ready))
    yield _gauge("device_armed", "Whether it may move.", _each(devices, lambda one: one.armed))
    yield _gauge("device_faults", "Latched faults.", _each(devices, lambda one: len(one.faults)))
    yield from _of_lines(devices)


def of_pose(state: str | None) -> MetricFamily:
    """Return what is known of where the robot is."""
    return _gauge("pose_state", "Whether it is this.", ((_(state=one), float(one == state)) for one in PoseState))


def of_metrics(metrics: Metrics) -> Iterator[MetricFamily]:
    """Yield what was counted since the daemon was started."""
    for name, alike in groupby(metrics.counters, key=_name):
        yield MetricFamily(name.removesuffix("_total"), "counter", _meaning(name), tuple(map(_sample, alike)))
    for name, alike in groupby(metrics.gauges, key=_name):
        yield MetricFamily(name, "gauge", _meaning(name), tuple(map(_sample, alike)))
    for name, distributions in groupby(metrics.histograms, key=_name):
        yield MetricFamily(name, "histogram", _meaning(name), (), tuple(distributions))


def _name(one: Sample | Buckets) -> str:
    return one.name


def _sample(one: Sample) -> tuple[Labels, float]:
    return tuple(one.labels.items()), one.value


def _meaning(name: str) -> str:
    return f"{name.removesuffix('_total').replace('_', ' ').capitalize()}, counted by the daemon."


def _of_lines(devices: tuple[DeviceStatus, ...]) -> Iterator[MetricFamily]:
    counted = [(one.name, dict(one.counters)) for one in devices]
    frames = [(_(line=line), float(found["frames"])) for line, found in counted if "frames" in found]
    yield MetricFamily("line_frames", "counter", "Frames that came on a line.", tuple(frames))
    events = [
        (_(line=line, event=what), float(count))
        for line, found in counted
        for what, count in found.items()
        if what != "frames" and what not in _CLOCK
    ]
    yield MetricFamily("line_events", "counter", "What else was counted on a line.", tuple(events))
    trips_us = [(line, found["clock_round_trip_us"]) for line, found in counted if "clock_round_trip_us" in found]
    trips = ((_(line=line), us / _US_PER_S) for line, us in trips_us)
    yield _gauge("line_round_trip_seconds", "To a board and back.", trips)


def _is_ready(device: DeviceStatus) -> bool:
    return device.link is LinkState.READY


def _each(devices: tuple[DeviceStatus, ...], value: Callable[[DeviceStatus], float]) -> Iterator[tuple[Labels, float]]:
    return ((_(device=one.name), float(value(one))) for one in devices)


def _gauge(name: str, meaning: str, samples: Iterable[tuple[Labels, float]]) -> MetricFamily:
    return MetricFamily(name, "gauge", meaning, tuple(samples))


def _(**labels: str) -> Labels:
    return tuple(labels.items())
