"""Not five poses but hundreds: how often is the robot found, and what do over-range readings add?"""

from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from robotd.localization.ready_map import ReadyMap
from tests.studies.paper.robot import Tour, probes_at
from tests.studies.paper.rooms import Room, known_floor
from tests.studies.paper.trials import Manner, outcome_of

PROBES = 24
POSES_A_MAP = 50
FOUND_WITHIN_M = 0.2
_SEED = 1000


@dataclass(frozen=True, slots=True, eq=False)
class Tally:
    """Many localizations of one manner in one room."""

    room: Room
    manner: Manner
    on_known_floor: NDArray[np.bool_]
    """``bool[n]``: whether the planner would have let the robot stand there."""
    largest_off_m: NDArray[np.float64]
    nearest_off_m: NDArray[np.float64]
    farthest_off_m: NDArray[np.float64]

    @property
    def found(self) -> NDArray[np.bool_]:
        """Whether the largest region is where the robot is, ``bool[n]``."""
        return self.largest_off_m <= FOUND_WITHIN_M


def tally_of(room: Room, manner: Manner, tours: tuple[Tour, ...], poses_a_map: int = POSES_A_MAP) -> Tally:
    """Localize at random poses all over the floor, in the map of each tour."""
    known: list[bool] = []
    errors_m: list[tuple[float, float, float]] = []
    for number, tour in enumerate(tours):
        grid = tour.map_by(manner.grid, room.spec)
        floor, the_map = known_floor(grid), ReadyMap.of(grid, manner.localization)
        for trial, pose in enumerate(islice(room.poses(_SEED + number), poses_a_map)):
            readings = probes_at(room.world, pose, PROBES, _SEED * (1 + number) + trial)
            outcome = outcome_of(manner, the_map, readings, pose)
            known.append(bool(floor[grid.spec.cell_at(pose.x_m, pose.y_m)]))
            errors_m.append((outcome.largest_off_m, outcome.nearest_off_m, outcome.farthest_off_m))
    return Tally(room, manner, np.array(known), *np.array(errors_m).T)
