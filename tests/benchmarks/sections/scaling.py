"""How the cost grows with the cells of the map, the headings, the readings and their range, for counting and searching.

Times here are the processor's, not the clock's: the largest maps take long, and other programs would be measured too.
"""

import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.readings import Readings
from robotd.grid.wall_field import WallField
from robotd.localization.count.rank_grid import bits_of
from robotd.localization.even_headings import even_headings
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.obstacles.levels import Levels
from robotd.localization.obstacles.prepared_map import PreparedMap
from robotd.localization.reference.count_all import count_all
from robotd.localization.search.bounded_search import SearchMap, best_poses
from tests.benchmarks import workload
from tests.benchmarks.timing import Timing

SIDES = (128, 256, 512, 1024, 2048, 4096)
HEADINGS = (1, 30, 100, 300, 900)
READINGS = (12, 30, 100, 300)
CUT_OFFS_M = (0.75, 1.5, 3.0, 6.0)
_BLOCK = workload.LARGE.rows
_RIVAL_SHARE, _LEAST_SHARE = 0.15, 0.5
_LONG_S = 0.5
"""What takes longer is measured less often."""
_PEAK_SIDES = (1024, 4096)


@dataclass(frozen=True)
class Site:
    """A map, made ready for both algorithms, and sweeps on it."""

    occupied: NDArray[np.bool_]
    sweeps: tuple[tuple[RangeReading, ...], ...]

    @cached_property
    def spec(self) -> GridSpec:
        return replace(workload.SPEC, shape=self.occupied.shape)

    @cached_property
    def obstacles(self) -> Obstacles:
        return Obstacles.of(self.occupied, workload.ERROR_RADIUS_CELLS)

    @cached_property
    def prepared(self) -> PreparedMap:
        return PreparedMap.of(self.obstacles, self.spec, workload.ERROR_RADIUS_CELLS)

    @cached_property
    def search_map(self) -> SearchMap:
        return SearchMap.of(Levels.of(self.obstacles, self.spec, workload.ERROR_RADIUS_CELLS))

    @property
    def mebibytes(self) -> str:
        """What is kept of the map, and what counting all poses of 300 headings at once would take."""
        packed = self.prepared.packed
        planes = self.search_map.planes
        search = sum(part.nbytes for part in (planes.cells, planes.pooled, planes.near))
        walls = WallField.of(self.spec, self.occupied, self.occupied)
        kept = {
            "masks": 3 * self.occupied.size,
            "to count": packed.planes.nbytes + packed.tiles.nbytes,
            "to search": search,
            "to refine": walls.codes.nbytes + walls.skips.nbytes,
            "counters": packed.counter_bytes(300, bits_of(300)),
        }
        return ", ".join(f"{name} {size / 2**20:.3g}" for name, size in kept.items()) + " MiB"


def timings() -> Iterator[Timing]:
    """One quantity after the other is changed, the others are those of workload S: 256 x 256, 300, 300, 6 m."""
    for side in SIDES:
        site = site_of(side, 5)
        title = f"{side} x {side} cells"
        peak = peak_of(side) if side in _PEAK_SIDES else ""
        yield replace(_counted(title, site, 300), note=site.mebibytes)
        yield replace(_searched(title, site, 300), note=peak)
    room = _site(workload.room(), 20)
    for headings in HEADINGS:
        yield _counted(f"{headings} headings", room, headings)
        yield _searched(f"{headings} headings", room, headings)
    for readings in READINGS:
        fewer = Site(room.occupied, tuple(sweep[:: len(sweep) // readings] for sweep in room.sweeps))
        yield _counted(f"{readings} readings", fewer, 300)
        yield _searched(f"{readings} readings", fewer, 300)
    for cut_off_m in CUT_OFFS_M:
        nearer = Site(room.occupied, tuple(_cut(sweep, cut_off_m) for sweep in room.sweeps))
        yield _counted(f"cut-off {cut_off_m:g} m", nearer, 300)
        yield _searched(f"cut-off {cut_off_m:g} m", nearer, 300)


def site_of(side: int, sweeps: int) -> Site:
    """Return a map of this many cells a side, and sweeps at random places."""
    return _site(_ground(side), sweeps)


def peak_of(side: int) -> str:
    """Return how much memory both algorithms take at most, in a process of their own."""
    command = [sys.executable, "-m", "tests.benchmarks.footprint", str(side)]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def _ground(side: int) -> NDArray[np.bool_]:
    """Return the corner of a site of many different buildings, side by side."""
    blocks = -(-side // _BLOCK)
    rows = [
        np.concatenate([workload.building(row * blocks + col) for col in range(blocks)], axis=1)
        for row in range(blocks)
    ]
    return np.ascontiguousarray(np.concatenate(rows)[:side, :side])


def _site(occupied: NDArray[np.bool_], sweeps: int) -> Site:
    poses: Sequence[Pose2] = workload.poses_in(occupied, sweeps)
    return Site(occupied, tuple(workload.sweep_of(occupied, seed, pose).measured for seed, pose in enumerate(poses)))


def _cut(sweep: tuple[RangeReading, ...], cut_off_m: float) -> tuple[RangeReading, ...]:
    return tuple(
        replace(reading, status=ReadingStatus.MISS, range_m=cut_off_m)
        if (reading.range_m or 0.0) > cut_off_m
        else reading
        for reading in sweep
    )


def _counted(title: str, site: Site, headings: int) -> Timing:
    ready, headings_rad = site.prepared, even_headings(headings)
    readings = Readings.of(site.sweeps[0])
    return _repeated(f"{title}: counting all poses", [lambda: count_all(ready, readings, headings_rad)])


def _searched(title: str, site: Site, headings: int) -> Timing:
    """Search on every sweep: how long it takes depends on what is there to be seen."""
    headings_rad, ready = np.array(even_headings(headings)), site.search_map

    def search(sweep: tuple[RangeReading, ...]) -> Callable[[], object]:
        readings = Readings.of(sweep)
        slack, least = round(_RIVAL_SHARE * len(sweep)), round(_LEAST_SHARE * len(sweep))
        return lambda: best_poses(ready, readings, headings_rad, slack=slack, least_rank=least)

    return _repeated(f"{title}: searching the best", [search(sweep) for sweep in site.sweeps])


def _repeated(name: str, functions: list[Callable[[], object]]) -> Timing:
    """Run each function once, and again as long as it is short."""
    seconds: list[float] = []
    while not seconds or (sum(seconds) < _LONG_S and len(seconds) < 5 * len(functions)):
        for function in functions:
            begin = time.process_time()
            function()
            seconds.append(time.process_time() - begin)
    return Timing(name, tuple(seconds))
