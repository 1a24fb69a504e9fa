"""Maps of a few cells, drawn in letters: ``#`` is a wall, ``.`` free, a space unknown; the first line is the north."""

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.exploring.choice import ChoiceQuestion
from robotd.exploring.settings import Pace
from robotd.exploring.tried import Tried
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.grid.tables import NO_INFORMATION
from robotd.planning.settings import PlanningSettings

RESOLUTION_M = 0.1
ROBOT = PlanningSettings(robot_radius_m=0.15, clearance_m=0.0, gap_cells=0)
WALL, FREE = 250, 5


def grid_of(cells: NDArray[np.uint8]) -> OccupancyGrid:
    """Return a map whose cell (0, 0) begins at the origin."""
    return OccupancyGrid(GridSpec(RESOLUTION_M, 0.0, 0.0, (cells.shape[0], cells.shape[1])), cells, GridSettings())


def drawn(*lines: str) -> OccupancyGrid:
    """Return a map as it is drawn; every letter is three by three cells."""
    values = {"#": WALL, ".": FREE, " ": NO_INFORMATION}
    cells = np.array([[values[letter] for letter in line] for line in reversed(lines)], np.uint8)
    return grid_of(np.kron(cells, np.ones((3, 3), np.uint8)))


def at(col: int, row: int) -> tuple[float, float]:
    """Return the middle of a letter, counted from the lower left, in metres."""
    return (3 * col + 1.5) * RESOLUTION_M, (3 * row + 1.5) * RESOLUTION_M


def question(
    start_m: tuple[float, float], tried: Tried | None = None, stops_m: tuple[tuple[float, float], ...] = ()
) -> ChoiceQuestion:
    """Ask for the next stop of a robot that stands somewhere and looks along x."""
    return ChoiceQuestion(Pose2(*start_m, 0.0), stops_m, tried or Tried(), None, 3.0, Pace())
