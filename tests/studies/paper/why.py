"""Why the paper's manner finds no more than it does in the laboratory: one thing changed at a time, all else alike.

Sweeps without a daemon, at the stops of the tour and then at random ones, placed where they truly were: what is left of
the errors is the map's and the localizer's.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.core.reading import Sweep
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION
from robotd.localization.obstacles.unknown_cells import UnknownCells
from robotd.localization.ready_map import ReadyMap
from robotd.sim.physics.walls import clearance_m
from tests.studies.paper.robot import probes_at
from tests.studies.paper.rooms import LABORATORY, is_inside
from tests.studies.paper.study import FOUND_WITHIN_M, PROBES
from tests.studies.paper.trials import AS_DEFINED, CLEARED, PAPERS, Manner, outcome_of

READINGS = 300
POSES = 100
_STOPS_SEED, _POSES_SEED = 77, 1000
_BESIDE_WALLS_M = 0.25


@dataclass(frozen=True, slots=True)
class Cause:
    """What is done otherwise."""

    name: str
    manner: Manner
    stops: int

    def measured(self) -> "Why":
        """Map, and localize at random poses."""
        grid = _mapped(self.manner, self.stops)
        the_map = ReadyMap.of(grid, self.manner.localization)
        off_m = []
        for trial, pose in enumerate(islice(LABORATORY.poses(_POSES_SEED), POSES)):
            readings = probes_at(LABORATORY.world, pose, PROBES, _POSES_SEED + trial)
            outcome = outcome_of(self.manner, the_map, readings, pose)
            off_m.append((outcome.largest_off_m, outcome.nearest_off_m))
        found, by_one = (np.array(off_m) <= FOUND_WITHIN_M).mean(axis=0).tolist()
        on_floor = grid.cells[_open_floor()]
        return Why(
            self, found, by_one, float((on_floor == NO_INFORMATION).mean()), int((on_floor > NO_INFORMATION).sum())
        )


@dataclass(frozen=True, slots=True)
class Why:
    """What came of it; shares."""

    cause: Cause
    found: float
    found_by_one: float
    """One of the regions is where the robot is."""
    floor_unknown: float
    """Of the open floor, what the map does not know, and so takes for obstacle."""
    wrong_obstacles: int
    """Cells of the open floor that wrong readings left occupied."""


def causes() -> Iterator[Cause]:
    """Yield the paper's manner, and what is changed of it."""
    stops = 1 + len(LABORATORY.stops_m)
    yield Cause("the paper's manner", PAPERS, stops)
    free = replace(PAPERS, localization=replace(AS_DEFINED, unknown=UnknownCells.FREE))
    yield Cause("unknown cells are free when localizing", free, stops)
    twice = replace(PAPERS, localization=replace(AS_DEFINED, blocked_by=2))
    yield Cause("a beam is blocked by two cells, not by one", twice, stops)
    for more in (60, 100, 150):
        yield Cause("more stops, at random", PAPERS, more)
    yield Cause("more stops, and unknown cells are free when localizing", free, 150)
    yield Cause("more stops, and a beam is blocked by two cells", twice, 150)
    yield Cause("over-range readings clear the map", CLEARED, stops)


def _mapped(manner: Manner, stops: int) -> OccupancyGrid:
    start, spec = LABORATORY.world.start_pose, LABORATORY.spec
    grid = OccupancyGrid(spec, settings=manner.grid)
    tour = [(start.x_m, start.y_m), *LABORATORY.stops_m]
    places = [*tour, *((pose.x_m, pose.y_m) for pose in islice(LABORATORY.poses(_STOPS_SEED), stops - len(tour)))]
    for number, (x_m, y_m) in enumerate(places):
        here = Pose2(x_m, y_m, 0.0)
        grid.insert(Sweep(number, here, probes_at(LABORATORY.world, here, READINGS, 5000 + number)), here)
    return grid


def _open_floor() -> NDArray[np.bool_]:
    """Return the cells that are floor, and not beside a wall, ``bool[rows, cols]``."""
    spec, walls = LABORATORY.spec, LABORATORY.world.walls
    low, high = walls.starts_m.min(axis=0), walls.starts_m.max(axis=0)
    floor = np.zeros(spec.shape, np.bool_)
    for row, col in np.ndindex(*spec.shape):
        point_m = spec.centre_of(row, col)
        is_within = bool(np.all((low < point_m) & (point_m < high))) and is_inside(walls, point_m)
        floor[row, col] = is_within and clearance_m(walls, point_m) >= _BESIDE_WALLS_M
    return floor
