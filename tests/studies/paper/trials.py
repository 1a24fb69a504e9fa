"""One localization: probes on a robot-made map, heading known, by the daemon's own localizer.

As [BrownDonald2000]_ sec. 2.2.1 defines it, loc is what the localizer counts (``best_poses``): the second look is left
out. As the product is set, it is the answer itself.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.contract.estimate import Region
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.pose_set import PoseSet
from robotd.grid.settings import BetweenBeams, GridSettings, OverRange, UpdatePolicy
from robotd.localization.localizer import Localizer
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
"""The localizer, set to what the paper defines."""


@dataclass(frozen=True, slots=True)
class Manner:
    """How a map is made, and which readings count."""

    name: str
    grid: GridSettings
    misses_count: bool
    """Whether over-range readings count too: nothing must be in their way."""
    localization: LocalizationSettings = AS_DEFINED
    looks_again: bool = False
    """Whether what counts is the answer, after the second look, and not the cells that explain the most."""

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
COUNTED = Manner("they clear the map, and count", GridSettings(), True)
OURS = Manner("our defaults", GridSettings(), True, LocalizationSettings(), looks_again=True)
MANNERS = (PAPERS, CLEARED, COUNTED, OURS)


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
        """Error of the largest region, of an answer the best; infinite without one."""
        return self.errors_m[0] if self.errors_m else math.inf

    @property
    def nearest_off_m(self) -> float:
        """Error of the nearest region."""
        return min(self.errors_m, default=math.inf)

    @property
    def farthest_off_m(self) -> float:
        """Error of the farthest region."""
        return max(self.errors_m, default=math.inf)


def outcome_of(manner: Manner, the_map: ReadyMap, readings: Sequence[RangeReading], truth: Pose2) -> Outcome:
    """Localize on a map, made ready as the manner has it, and compare with the truth."""
    counted = manner.counted(readings)
    headings_rad = manner.localization.headings_near(truth.heading_rad) if manner.looks_again else (truth.heading_rad,)
    localizer = Localizer.at_stop(the_map, "", headings_rad)
    localizer.add(*counted)
    # Few headings, so readings are counted as they come.
    assert localizer.stop.counted is not None
    loc = localizer.stop.best_poses()
    if manner.looks_again:
        regions = localizer.estimate(0, final=True).regions
        centres_m, cells = tuple((region.pose.x_m, region.pose.y_m) for region in regions), _cells_of(regions)
    else:
        pieces = pieces_of(loc, localizer.stop.headings_rad, most=len(loc)).best
        centres_m, cells = tuple(_centre_m(piece, the_map.spec) for piece in pieces), loc.poses[:, 1:].tolist()
    cells_m = np.array([the_map.spec.centre_of(row, col) for row, col in cells]).reshape(-1, 2)
    return Outcome(
        probes=len(readings),
        in_range=sum(reading.status is ReadingStatus.OK for reading in readings),
        counted=len(counted),
        consistent=loc.best_rank,
        cells=len(cells),
        centres_m=centres_m,
        errors_m=tuple(math.dist(centre_m, (truth.x_m, truth.y_m)) for centre_m in centres_m),
        within_robot=_share_within(cells_m, truth),
        rank=localizer.stop.counted.rank.max(axis=0),
    )


def _centre_m(piece: PoseSet, spec: GridSpec) -> tuple[float, float]:
    _, row, col = piece.poses.mean(axis=0).tolist()
    return spec.centre_of(row, col)


def _cells_of(regions: Sequence[Region]) -> list[tuple[int, int]]:
    """Return the cells of regions, each once; a few readings leave no region that is told in blocks."""
    return sorted(
        {
            (row, col)
            for region in regions
            for row, first, last in region.cover.runs
            for col in range(first, last + 1)
            if region.cover.block_cells == 1
        }
    )


def _share_within(cells_m: NDArray[np.float64], truth: Pose2) -> float:
    if not len(cells_m):
        return 0.0
    return float((np.hypot(*(cells_m - (truth.x_m, truth.y_m)).T) <= ROBOT_RADIUS_M).mean())
