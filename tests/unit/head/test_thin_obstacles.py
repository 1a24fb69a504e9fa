"""What was hit since it was last seen free is an obstacle for the planner, however thin, whatever was seen before."""

import math
from itertools import pairwise

import numpy as np
import pytest

from robotd.core.pose import IDENTITY
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.binary import FREE_MAX
from robotd.grid.latest import HIT, NOTHING, PASSED
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings, UpdatePolicy
from robotd.head.desk import Desk
from robotd.head.held import Held
from robotd.head.job_table import perform
from robotd.head.jobs import MapRef, Plan
from robotd.head.settings import HeadSettings
from robotd.planning.settings import PlanningSettings

WALLS_M = 2.5
LEG_M = 1.0
GOAL_M = (2.0, 0.0)
STEP_RAD = math.tau / 300
SLOW_TO_BELIEVE = GridSettings(rows=120, cols=120, raise_alpha=0.9)
"""One hit does not make an obstacle of what was seen free."""


ROBOT = HeadSettings(planning=PlanningSettings(robot_radius_m=0.3, clearance_m=0.0))


def blank(settings: GridSettings) -> Held:
    return Held.of(OccupancyGrid(settings.spec_covering(((0.0, 0.0),), 1.0), settings=settings), None)


def seen(here: Held, *sweeps: Sweep) -> Held:
    """Return a map with sweeps laid in that were taken at its origin."""
    for sweep in sweeps:
        here, _ = here.with_sweep(sweep, IDENTITY)
    return here


def sweep(leg_beams: int = 0) -> Sweep:
    """A round room, and a thin leg ahead that this many beams meet."""
    middle = leg_beams // 2
    met = {(number - middle) % 300 for number in range(leg_beams)}
    ranges_m = [LEG_M if number in met else WALLS_M for number in range(300)]
    readings = (RangeReading(n, n * STEP_RAD, ReadingStatus.OK, range_m) for n, range_m in enumerate(ranges_m))
    return Sweep(0, IDENTITY, tuple(readings))


def keeps_off_m(here: Held) -> float:
    """Return how near the plan comes to the leg."""
    desk = Desk(ROBOT)
    desk.hold(MapRef(1), here)
    corners_m = ((0.0, 0.0), *perform(desk, Plan(MapRef(1), IDENTITY, GOAL_M)).waypoints_m)
    assert len(corners_m) > 1
    legs = (np.array(leg) for leg in pairwise(corners_m))
    shares = np.linspace(0.0, 1.0, 500)[:, None]
    return min(float(np.hypot(*(leg[0] + shares * (leg[1] - leg[0]) - (LEG_M, 0.0)).T).min()) for leg in legs)


@pytest.mark.parametrize("beams", [1, 2])
@pytest.mark.parametrize("policy", UpdatePolicy)
@pytest.mark.parametrize("alpha", [0.3, 0.9])
def test_a_thin_leg_hit_once_is_gone_round_until_it_is_seen_through(
    beams: int, policy: UpdatePolicy, alpha: float
) -> None:
    here = blank(GridSettings(rows=120, cols=120, raise_alpha=alpha, policy=policy))
    here = seen(here, *[sweep()] * 3)
    assert keeps_off_m(here) < 0.01
    here = seen(here, sweep(beams))
    assert keeps_off_m(here) >= 0.3 - here.grid.spec.resolution_m
    assert keeps_off_m(seen(here, sweep())) < 0.01


def test_a_leg_that_was_there_from_the_beginning_is_gone_round_too() -> None:
    here = seen(blank(GridSettings(rows=120, cols=120)), sweep(1))
    assert keeps_off_m(here) >= 0.3 - here.grid.spec.resolution_m


def test_what_was_said_last_is_kept_beside_the_grid_and_every_snapshot_is_left_alone() -> None:
    here = blank(SLOW_TO_BELIEVE)
    leg, beyond = here.grid.spec.cell_at(LEG_M, 0.0), here.grid.spec.cell_at(LEG_M + 0.5, 0.0)
    assert here.latest[leg] == NOTHING
    before = seen(here, sweep(), sweep())
    assert before.latest[leg] == before.latest[beyond] == PASSED
    after = seen(before, sweep(1))
    assert (before.latest[leg], after.latest[leg], after.latest[beyond]) == (PASSED, HIT, PASSED)
    assert after.grid.cells[leg] <= FREE_MAX


def test_a_map_that_comes_from_the_store_has_its_cells_and_nothing_else() -> None:
    """One hit on unknown or free ground makes a cell an obstacle with the settings that are the default; that stays."""
    here = seen(blank(GridSettings(rows=120, cols=120)), *map(sweep, (0, 0, 1)))
    loaded = Held.of(here.grid, None)
    assert not loaded.latest.any()
    assert keeps_off_m(loaded) >= 0.3 - here.grid.spec.resolution_m
