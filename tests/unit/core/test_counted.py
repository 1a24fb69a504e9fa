"""What is counted, and how it is told."""

from robotd.contract.metrics import Metrics, Sample
from robotd.core.counted import BOUNDS_S, Counted


def test_counters_are_told_by_name_and_labels() -> None:
    counted = Counted()
    counted.count("missions_total", kind="map", end="done")
    counted.count("missions_total", kind="map", end="done")
    counted.count("missions_total", kind="map", end="failed")
    counted.count("leases_total", 5)
    assert Metrics.of(counted).counters == (
        Sample("leases_total", {}, 5),
        Sample("missions_total", {"kind": "map", "end": "done"}, 2),
        Sample("missions_total", {"kind": "map", "end": "failed"}, 1),
    )


def test_buckets_are_told_as_how_many_were_no_more_than_each_bound() -> None:
    counted = Counted()
    values_s = (0.0, 0.001, 0.0011, 59.0, 60.0, 61.0)
    for seconds in values_s:
        counted.observe("job_seconds", seconds, job="narrow")
    (told,) = Metrics.of(counted).histograms
    assert (told.name, told.labels, told.bounds) == ("job_seconds", {"job": "narrow"}, BOUNDS_S)
    assert told.counts == (*(sum(seconds <= bound for seconds in values_s) for bound in BOUNDS_S), 6)
    assert told.sum == sum(values_s)


def test_gauges_are_read_when_they_are_told() -> None:
    counted, waiting = Counted(), [1.0]
    counted.show("compute_queue", lambda: waiting[0])
    waiting[0] = 4.0
    assert Metrics.of(counted).gauges == (Sample("compute_queue", {}, 4.0),)


def test_what_two_processes_counted_is_told_together() -> None:
    heart, front = Counted(), Counted()
    heart.count("stops_total", cause="stop")
    front.count("requests_total", code="ok")
    together = Metrics.of(heart).joined(Metrics.of(front))
    assert [one.name for one in together.counters] == ["stops_total", "requests_total"]
