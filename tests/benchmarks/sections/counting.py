"""All poses counted, and one reading more."""

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from robotd.core.reading import RangeReading
from robotd.grid import kernels
from robotd.grid.kernels.draw.draw_kernel import BeamSettings, turned
from robotd.grid.kernels.twins import TWINS
from robotd.grid.readings import Readings
from robotd.localization.count.rank_grid import RankGrid
from robotd.localization.even_headings import even_headings
from tests.benchmarks import workload
from tests.benchmarks.timing import Timing, timed

HOW = BeamSettings(workload.RESOLUTION_M, workload.ERROR_RADIUS_CELLS, reach_cells=512)
HEADINGS = 300


def timings() -> Iterator[Timing]:
    """Workload S, and the worst case of its size."""
    for name, occupied in (("S", workload.room()), ("open 256 x 256", workload.open_square())):
        yield from all_poses(name, occupied)
        yield from one_reading(name, occupied)


def all_poses(room: str, occupied: NDArray[np.bool_]) -> Iterator[Timing]:
    """Every free cell, every heading, every reading."""
    sweep = workload.sweep_of(occupied).measured
    headings = even_headings(HEADINGS)

    def whole(threads: int) -> RankGrid:
        ranks = RankGrid(workload.map_of(occupied), headings, threads=threads)
        ranks.add(Readings.of(sweep))
        return ranks

    title = f"{room}, all poses, {HEADINGS} headings, {len(sweep)} readings"
    goal_ms = 30.0 if room == "S" else None
    yield timed(f"{title}: map to counts, one thread", lambda: whole(1), 15, goal_ms=goal_ms)
    yield timed(f"{title}: map to counts, two threads", lambda: whole(2), 15)
    ranks = whole(1)
    yield timed(f"{title}: greatest rank", lambda: ranks.best_rank, 15)
    yield timed(f"{title}: poses of greatest rank", lambda: ranks.best_poses().poses, 15)
    yield timed(f"{room}, heat map of {HEADINGS} headings: greatest over headings, a byte a cell", ranks.heat, 15)
    yield timed(f"{room}, the same from the slow counts of 5 headings", lambda: _slow_heat(occupied, sweep), 5)
    few = sweep[:: len(sweep) // 10]
    the_map = workload.map_of(occupied).packed
    ten = np.array(headings[:10])
    for name, module in (("in use", kernels.in_use()), ("NumPy twin", TWINS)):
        counters = the_map.blank_counters(10, 9)
        beams = module.draw.draw_beams(Readings.of(few).rows, turned(ten), HOW)
        run = partial(module.count.count_feasible, counters, the_map, beams)
        yield timed(f"{room}, 10 headings x {len(few)} readings, {name}", run, 5)


def _slow_heat(occupied: NDArray[np.bool_], sweep: Sequence[RangeReading]) -> NDArray[np.uint16]:
    ranks = RankGrid(workload.map_of(occupied), even_headings(5))
    ranks.add(Readings.of(sweep))
    greatest: NDArray[np.uint16] = ranks.rank.max(axis=0)
    return greatest


def one_reading(room: str, occupied: NDArray[np.bool_]) -> Iterator[Timing]:
    """One reading more, heading known."""
    ranks = RankGrid(workload.map_of(occupied), (0.0,))
    the_map = workload.map_of(occupied).packed
    counters = the_map.blank_counters(1, 16)
    sweep = sorted(workload.sweep_of(occupied).measured, key=lambda reading: reading.range_m or 0.0)
    for name, reading in (("median", sweep[len(sweep) // 2]), ("longest", sweep[-1])):
        beams = kernels.in_use().draw.draw_beams(Readings.of((reading,)).rows, turned(np.zeros(1)), HOW)
        title = f"{room}, one reading ({name} range {reading.range_m:.2f} m), heading known"
        yield timed(f"{title}: counting", partial(kernels.in_use().count.count_feasible, counters, the_map, beams), 500)
        yield timed(f"{title}: counting, NumPy twin", partial(TWINS.count.count_feasible, counters, the_map, beams), 20)
        yield timed(f"{title}: add()", partial(_add, ranks, reading), 300, goal_ms=0.015)


def _add(ranks: RankGrid, reading: RangeReading) -> None:
    ranks.add(Readings.of((reading,)))
