"""``make bench``: how long the kernels take, against their NumPy twins and two yardsticks of this machine, in one run.

Every line is repeated; the smallest time and the median are given, since other programs slow a run down but never speed
it up. Nothing here passes or fails.
"""

import argparse
import platform
import subprocess
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from robotd.grid import kernels
from robotd.grid.kernels import twins
from robotd.grid.kernels.layout import BeamSettings, PackedMap
from robotd.grid.occupancy import GridSettings, OccupancyGrid, UpdatePolicy, _rays
from robotd.grid.readings import numbers_of
from robotd.localization.obstacles import Obstacles
from robotd.localization.rank import RankGrid, even_headings
from tests.benchmarks import workload

ROOT = Path(__file__).parents[2]
HOW = BeamSettings(workload.RESOLUTION_M, workload.ERROR_RADIUS_CELLS, reach_cells=512)
HEADINGS = 300


@dataclass(frozen=True, slots=True)
class Timing:
    """One line of the report."""

    name: str
    seconds: tuple[float, ...]

    @property
    def best(self) -> float:
        return min(self.seconds)

    def row(self, yardstick_s: float) -> str:
        median, spread = np.median(self.seconds), np.percentile(self.seconds, 90)
        cells = (f"{1e3 * value:.3f}" for value in (self.best, median, spread))
        return f"| {self.name} | {' | '.join(cells)} | {self.best / yardstick_s:.3g} | {len(self.seconds)} |"


def timed(name: str, function: Callable[[], object], repeats: int) -> Timing:
    """Run a function so often, after once to warm up."""
    function()
    seconds = []
    for _ in range(repeats):
        begin = time.perf_counter()
        function()
        seconds.append(time.perf_counter() - begin)
    return Timing(name, tuple(seconds))


def yardsticks() -> Iterator[Timing]:
    """What this machine can do at this moment: memory bandwidth, and counting bits."""
    words = np.random.default_rng(0).integers(0, 2**63, 1 << 22, np.uint64)
    target = np.empty_like(words)
    yield timed("yardstick: copy 32 MiB", lambda: np.copyto(target, words), 25)
    small = words[: 1 << 17]
    yield timed("yardstick: OR 1 MiB with 1 MiB", lambda: np.bitwise_or(small, small[::-1]), 50)


def all_poses(room: str, occupied: NDArray[np.bool_]) -> Iterator[Timing]:
    """Every free cell, every heading, every reading."""
    binary = workload.binary_of(occupied)
    sweep = workload.sweep_of(occupied).measured
    headings = even_headings(HEADINGS)

    def whole(threads: int) -> RankGrid:
        ranks = RankGrid(binary, headings, workload.ERROR_RADIUS_CELLS, threads=threads)
        ranks.add(*sweep)
        return ranks

    title = f"{room}, all poses, {HEADINGS} headings, {len(sweep)} readings"
    yield timed(f"{title}: map to counts, one thread", lambda: whole(1), 15)
    yield timed(f"{title}: map to counts, two threads", lambda: whole(2), 15)
    ranks = whole(1)
    yield timed(f"{title}: greatest rank", lambda: ranks.best_rank, 15)
    yield timed(f"{title}: poses of greatest rank", lambda: ranks.best_cells, 15)
    few = sweep[:: len(sweep) // 10]
    the_map = PackedMap.of(occupied, Obstacles.of(occupied, workload.ERROR_RADIUS_CELLS).grown)
    ten = np.array(headings[:10])
    for name, module in (("in use", kernels), ("NumPy twin", twins)):
        counters = the_map.blank_counters(10, 9)
        beams = module.draw_beams(numbers_of(few), ten, HOW)
        run = partial(module.count_feasible, counters, the_map, beams)
        yield timed(f"{room}, 10 headings x {len(few)} readings, {name}", run, 5)


def one_reading(room: str, occupied: NDArray[np.bool_]) -> Iterator[Timing]:
    """One reading more, heading known."""
    ranks = RankGrid(workload.binary_of(occupied), (0.0,), workload.ERROR_RADIUS_CELLS)
    the_map = PackedMap.of(occupied, Obstacles.of(occupied, workload.ERROR_RADIUS_CELLS).grown)
    counters = the_map.blank_counters(1, 16)
    sweep = sorted(workload.sweep_of(occupied).measured, key=lambda reading: reading.range_m or 0.0)
    for name, reading in (("median", sweep[len(sweep) // 2]), ("longest", sweep[-1])):
        beams = kernels.draw_beams(numbers_of((reading,)), np.zeros(1), HOW)
        title = f"{room}, one reading ({name} range {reading.range_m:.2f} m), heading known"
        yield timed(f"{title}: counting", partial(kernels.count_feasible, counters, the_map, beams), 500)
        yield timed(f"{title}: counting, NumPy twin", partial(twins.count_feasible, counters, the_map, beams), 20)
        yield timed(f"{title}: add()", partial(ranks.add, reading), 300)


def insertion() -> Iterator[Timing]:
    """One sweep into the map."""
    sweep = workload.sweep_of(workload.room())
    for policy in UpdatePolicy:
        grid = OccupancyGrid(workload.SPEC, settings=GridSettings(policy=policy))
        rays = _rays(sweep.measured, workload.TRUTH, workload.SPEC)
        tables = (grid._lower, grid._raise)
        at_once = policy is UpdatePolicy.PER_SWEEP
        title = f"S, one sweep into the map, {policy}"
        for name, module in (("in use", kernels), ("NumPy twin", twins)):
            run = partial(module.insert_rays, grid.cells, rays, *tables, at_once=at_once)
            yield timed(f"{title}: cells, {name}", run, 50)
        yield timed(f"{title}: insert()", partial(grid.insert, sweep, workload.TRUTH), 200)


def processor() -> str:
    """Return what this machine calls its processor."""
    lines = Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), platform.machine())


def commit() -> str:
    """Return the commit that is measured, ``+`` if the files are not quite its."""
    show = subprocess.run(
        ["git", "describe", "--always", "--dirty=+"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    return show.stdout.strip() or "unknown"


def report() -> str:
    """Run everything; return the page."""
    measured = list(yardsticks())
    yardstick_s = measured[1].best
    room, square = workload.room(), workload.open_square()
    for part in (
        all_poses("S", room),
        one_reading("S", room),
        all_poses("open 256 x 256", square),
        one_reading("open 256 x 256", square),
        insertion(),
    ):
        for timing in part:
            print(timing.row(yardstick_s), flush=True)
            measured.append(timing)
    head = (
        f"# Benchmarks of {datetime.now(UTC):%Y-%m-%d}\n\n"
        f"Commit {commit()}; {processor()}, Python {platform.python_version()}, NumPy {np.__version__}; "
        f"{kernels.IN_USE}.\n"
        f"Written by `make bench`. {workload.__doc__} Cut-off {workload.CUT_OFF_M} m, error radius "
        f"{workload.ERROR_RADIUS_CELLS} cells, seeds 0 and 1. Times in milliseconds; the ratio is to the second "
        "yardstick.\n"
        "Other programs may have been running: the smallest time is the one to compare.\n\n"
        "| what | least | median | 90th percentile | ratio | runs |\n|---|---|---|---|---|---|\n"
    )
    return head + "\n".join(timing.row(yardstick_s) for timing in measured) + "\n"


def main() -> None:
    """Write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--out", type=Path, default=ROOT / "docs" / "benchmarks", help="directory (default: %(default)s)"
    )
    out: Path = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    file = out / f"{datetime.now(UTC):%Y-%m-%d}.md"
    file.write_text(report())
    print(f"written to {file}")


if __name__ == "__main__":
    main()
