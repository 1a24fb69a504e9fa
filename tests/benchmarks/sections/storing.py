"""A map of 100 stops into the store, and back: read, checked, and made of its stops again."""

import math
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

from robotd.core.map_stop import MapStop
from robotd.grid.map_stops import MapStops
from robotd.grid.settings import GridSettings
from robotd.maps.stops_file import decode_stops, encode_stops
from robotd.maps.store import MapStore
from tests.benchmarks import workload
from tests.benchmarks.timing import Timing, timed

STOPS = 100


def made_of(count: int) -> MapStops:
    """Return stops all over workload S, of 300 readings each."""
    room = workload.room()
    stops = MapStops(GridSettings())
    for number, pose in enumerate(workload.poses_in(room, count)):
        sweep = workload.sweep_of(room, number, pose)
        readings = tuple(
            replace(reading, time_ns=10**12 + (300 * number + k) * 160_000_000 + k * 7919 % 100_000, strength=k % 900)
            for k, reading in enumerate(sweep.readings)
        )
        in_odom = replace(pose, heading_rad=math.remainder(pose.heading_rad + 0.01 * number, math.tau))
        stops = stops.with_stop(MapStop.of(replace(sweep, in_odom=in_odom, readings=readings), pose))
    return stops


def timings() -> Iterator[Timing]:
    """Workload S. What ``load`` takes more than its parts is reading, checksums and the exports."""
    stops = made_of(STOPS)
    data = encode_stops(stops)
    grid = stops.grid_on(workload.SPEC)
    with tempfile.TemporaryDirectory() as directory:
        store = MapStore(Path(directory), keep=1)
        save = timed(f"S, {STOPS} stops: save()", partial(store.save, "room", grid, {}, 0, stops), 10)
        yield replace(save, note=f"stops.bin has {len(data)} bytes")
        plain = partial(store.save, "plain", grid, {}, 0)
        yield timed("S, without stops: save()", plain, 10)
        yield timed(f"S, {STOPS} stops: load()", partial(store.load, "room"), 20, goal_ms=500)
        yield timed("S, without stops: load()", partial(store.load, "plain"), 20)
    yield timed(f"S, {STOPS} stops: of which the stops out of their file", partial(decode_stops, data), 20)
    yield timed(f"S, {STOPS} stops: of which laying them in", partial(stops.grid_on, workload.SPEC), 20)
