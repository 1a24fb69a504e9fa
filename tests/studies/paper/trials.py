"""One localization: probes on a robot-made map, heading known, as [BrownDonald2000]_ sec. 2.2.1 defines it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.pose_set import PoseSet
from robotd.grid.readings import Readings
from robotd.grid.settings import BetweenBeams, GridSettings, OverRange, UpdatePolicy
from robotd.localization.obstacles.error_radius import ErrorRadius
from robotd.localization.obstacles.thick_walls import ThickWalls
from robotd.localization.obstacles.unknown_cells import UnknownCells
from robotd.localization.places.pieces import pieces_of
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings
from tests.studies.paper.robot import ROBOT_RADIUS_M

ERROR_M = 0.075
"""The paper's eps, which it does not tell."""
AS_DEFINED = LocalizationSettings(
    range_error_m=ERROR_M,
    error_radius=ErrorRadius.CONSTANT,
    unknown=UnknownCells.OCCUPIED,
    blocked_by=1,
    thick_walls=ThickWalls.AS_DRAWN,
    # The paper's loc: the cells that explain the most, however few that is, and no others.
    rival_share=0.0,
    localized_share=0.01,
)
"""The daemon's own localizer, set to what the paper defines."""


@dataclass(frozen=True, slots=True)
class Manner:
    """How a map is made, and which readings count."""

    name: str
    grid: GridSettings
    misses_count: bool
    """Whether over-range readings count too: nothing must be in their way."""

    def counted(self, readings: Sequence[RangeReading]) -> tuple[RangeReading, ...]:
        """Return the readings that count."""
        wanted = {ReadingStatus.OK, ReadingStatus.MISS} if self.misses_count else {ReadingStatus.OK}
        return tuple(reading for reading in readings if reading.status in wanted)


PAPERS = Manner(
    "the paper's own runs",
    GridSettings(policy=UpdatePolicy.PER_READING, over_range=OverRange.DISCARD, between_beams=BetweenBeams.UNSEEN),
    False,
)
CLEARED = Manner("over-range readings clear the map", GridSettings(), False)
OURS = Manner("our defaults: they clear the map, and count", GridSettings(), True)


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What came of it."""

    probes: int
    in_range: int
    counted: int
    consistent: int
    """The paper's kappa: the readings that the best cells explain."""
    cells: int
    """Size of the paper's loc: how many cells are best."""
    centres_m: tuple[tuple[float, float], ...]
    """Mean ``(x, y)`` of the cells of each region of loc, the largest first."""
    errors_m: tuple[float, ...]
    """How far they are from the truth."""
    within_robot: float
    """Share of loc within the circle of the robot."""
    rank: NDArray[np.uint16]
    """``uint16[rows, cols]``."""

    @property
    def largest_off_m(self) -> float:
        """Error of the largest region."""
        return self.errors_m[0]

    @property
    def nearest_off_m(self) -> float:
        """Error of the nearest region."""
        return min(self.errors_m)

    @property
    def farthest_off_m(self) -> float:
        """Error of the farthest region."""
        return max(self.errors_m)


def outcome_of(manner: Manner, grid: OccupancyGrid, readings: Sequence[RangeReading], truth: Pose2) -> Outcome:
    """Localize on a map and compare with the truth."""
    counted = manner.counted(readings)
    stop = ReadyMap.of(grid, AS_DEFINED).stop((truth.heading_rad,))
    stop.add(Readings.of(counted))
    # One heading is few, so readings are counted as they come.
    assert stop.counted is not None
    loc = stop.best_poses()
    best, pieces = loc.poses, pieces_of(loc, stop.headings_rad, most=len(loc)).best
    centres_m = tuple(_centre_m(piece, grid) for piece in pieces)
    cells_m = np.array([grid.spec.centre_of(row, col) for _, row, col in best.tolist()])
    return Outcome(
        probes=len(readings),
        in_range=sum(reading.status is ReadingStatus.OK for reading in readings),
        counted=len(counted),
        consistent=loc.best_rank,
        cells=len(best),
        centres_m=centres_m,
        errors_m=tuple(math.dist(centre_m, (truth.x_m, truth.y_m)) for centre_m in centres_m),
        within_robot=float((np.hypot(*(cells_m - (truth.x_m, truth.y_m)).T) <= ROBOT_RADIUS_M).mean()),
        rank=stop.counted.rank[0],
    )


def _centre_m(piece: PoseSet, grid: OccupancyGrid) -> tuple[float, float]:
    _, row, col = piece.poses.mean(axis=0).tolist()
    return grid.spec.centre_of(row, col)
