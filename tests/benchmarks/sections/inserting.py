"""One sweep into the map."""

from collections.abc import Iterator
from functools import partial

from robotd.grid import kernels
from robotd.grid.kernels.twins import TWINS
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.readings import Readings
from robotd.grid.settings import BetweenBeams, GridSettings, UpdatePolicy
from tests.benchmarks import workload
from tests.benchmarks.timing import Timing, timed


def timings() -> Iterator[Timing]:
    """Workload S, by both policies."""
    sweep = workload.sweep_of(workload.room())
    for policy in UpdatePolicy:
        grid = OccupancyGrid(workload.SPEC, settings=GridSettings(policy=policy))
        readings, tables = Readings.of(sweep.measured).rows, (grid._lower, grid._raise)
        at_once = policy is UpdatePolicy.PER_SWEEP
        title = f"S, one sweep into the map, {policy}"
        for name, module in (("in use", kernels.in_use()), ("NumPy twin", TWINS)):
            place = (workload.TRUTH, workload.SPEC, tables)
            run = partial(module.insert.insert_sweep, grid.cells, readings, *place, at_once=at_once)
            yield timed(f"{title}: cells, {name}", run, 50)
        blank = [OccupancyGrid(workload.SPEC, settings=GridSettings(policy=policy)) for _ in range(201)]
        first = partial(lambda grids: next(grids).insert(sweep, workload.TRUTH), iter(blank))
        yield timed(f"{title}: insert(), nothing known before", first, 200, goal_ms=0.1)
        yield timed(
            f"{title}: insert(), again and again", partial(grid.insert, sweep, workload.TRUTH), 200, goal_ms=0.1
        )
        paper = OccupancyGrid(workload.SPEC, settings=GridSettings(policy=policy, between_beams=BetweenBeams.UNSEEN))
        yield timed(f"{title}: insert(), nothing between beams", partial(paper.insert, sweep, workload.TRUTH), 200)
