"""Where to stop next, or why there is nowhere.

Stops cost more than metres: a sweep takes as long as ten metres of way. So candidates are judged by the ground that a
whole sweep is expected to add, over the time that it takes to get there, turn, and sweep. Before all else a sweep must
find its place on the map: candidates from which most beams end on known walls come first, however little they add.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.contract.ways import Point
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.core.rectangle import Rectangle
from robotd.exploring.openings import Opening, openings
from robotd.exploring.outlook import Outlook, Views, facing_rad
from robotd.exploring.reasons import WhyEnded, WhyLeft
from robotd.exploring.settings import ExploringSettings, Pace
from robotd.exploring.tried import Tried
from robotd.grid.distance import distance_transform
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION
from robotd.planning.settings import PlanningSettings
from robotd.planning.terrain import Terrain
from robotd.planning.traversable import lone_hits


@dataclass(frozen=True, slots=True)
class ChoiceQuestion:
    """What the choice depends on beside the map."""

    start: Pose2
    """Where the robot stands."""
    stops_m: tuple[Point, ...]
    """Where stops were made."""
    tried: Tried
    within: Rectangle | None
    """What is explored; None is all of the map."""
    cut_off_m: float
    """Farther than this the rangefinder is not asked."""
    pace: Pace


@dataclass(frozen=True, slots=True)
class Candidate:
    """A place to stop at."""

    at_m: Point
    score: float
    """Terrain that it is expected to add, over the time that it takes [m2/s]."""
    area_m2: float
    opening_m: float
    overlap: float
    way_m: float


@dataclass(frozen=True, slots=True)
class Left:
    """An opening that is left, and why."""

    opening: Opening
    why: WhyLeft


@dataclass(frozen=True, slots=True)
class Choice:
    """The next stop, or an end."""

    candidates: tuple[Candidate, ...]
    """Those that the next stop was chosen from, the best first; it is the first, unless this is the end."""
    seen_m2: float
    """Free ground that was seen."""
    ending: WhyEnded | None
    left: tuple[Left, ...]
    """What is open by now."""

    @property
    def goal_m(self) -> Point | None:
        """Where to stop next; None at an end."""
        return self.candidates[0].at_m if self.ending is None else None


def choose(
    grid: OccupancyGrid,
    hit: NDArray[np.bool_],
    question: ChoiceQuestion,
    planning: PlanningSettings,
    settings: ExploringSettings | None = None,
) -> Choice:
    """Return where to stop next, or why there is nowhere. O(candidates beams way + cells).

    Args:
        grid: the map.
        hit: ``bool[rows, cols]``, cells that are obstacles whatever the grid says of them; with what was met.
        question: the rest.
        planning: the robot.
        settings: what a stop must be worth.
    """
    settings = settings or ExploringSettings()
    lone = lone_hits(grid, hit)
    # As the planner: lone hits are gone round, and doubted only where nothing else is left.
    for doubted in (None, lone) if lone.any() else (None,):
        known = _Known.of(grid, hit, lone, Terrain.of(grid, question.start, hit, doubted, planning), question)
        choice = _chosen(known, question, settings)
        if choice.ending is None:
            return choice
    return choice


@dataclass(frozen=True, slots=True, eq=False)
class _Known:
    """What is known of a map when a choice is made."""

    spec: GridSpec
    free: NDArray[np.bool_]
    unknown: NDArray[np.bool_]
    ways: NDArray[np.float64]
    """``float64[rows, cols]``: from the robot to each cell [cells]."""
    outlook: Outlook
    seen_m2: float

    @classmethod
    def of(
        cls,
        grid: OccupancyGrid,
        hit: NDArray[np.bool_],
        lone: NDArray[np.bool_],
        ground: Terrain,
        question: ChoiceQuestion,
    ) -> "_Known":
        # A wrong range in the air hides nothing; what bumps, or the planner goes round, need not be seen through.
        walls = ((grid.cells > NO_INFORMATION) | hit) & ~lone
        unknown = ~ground.free & ~walls & ~lone
        spec, start = grid.spec, question.start
        outlook = Outlook.on(spec, walls, unknown, question.within, question.cut_off_m)
        seen_m2 = float(ground.free.sum()) * spec.resolution_m**2
        ways = ground.ways_from(spec.cell_at(start.x_m, start.y_m))
        return cls(spec, ground.free, unknown, ways, outlook, seen_m2)

    def candidates(self, settings: ExploringSettings) -> NDArray[np.intp]:
        """Return the cells of the lattice that the robot can go to and that lie within bounds, ``intp[n, 2]``."""
        step = max(1, round(settings.lattice_m / self.spec.resolution_m))
        # A lattice of the grid and not of the bounds: the same candidates come up at each choice, so that what
        # was tried is recognized.
        cells = np.argwhere(np.isfinite(self.ways[::step, ::step])) * step
        return cells[_holds(self.outlook.within, self.points_m(cells))]

    def points_m(self, cells: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return the centres of cells, ``float64[n, 2]`` of x, y in the map frame."""
        origin = np.array((self.spec.origin_x_m, self.spec.origin_y_m))
        points: NDArray[np.float64] = origin + (cells[:, ::-1] + 0.5) * self.spec.resolution_m
        return points


def _chosen(known: _Known, question: ChoiceQuestion, settings: ExploringSettings) -> Choice:
    cells = known.candidates(settings)
    places_m = known.points_m(cells)
    views = known.outlook.views(places_m, settings)
    # What was tried is left out by where it lies, not by what it sees: a place that showed nothing new will not
    # by asking again.
    fresh = (views.opening_m > 0.0) & _apart(places_m, (*question.stops_m, *question.tried.in_vain_m), settings.apart_m)
    left = _left(known, question, settings)
    if not fresh.any():
        return Choice((), known.seen_m2, WhyEnded.UNREACHABLE if left else WhyEnded.COMPLETE, left)
    # Or the most that there is.
    overlap_min = min(settings.overlap_min, float(views.overlap[fresh].max()))
    which = np.flatnonzero(fresh & (views.overlap >= overlap_min))
    ways_m = known.ways[cells[which, 0], cells[which, 1]] * known.spec.resolution_m
    best = _ranked(places_m[which], views[which], ways_m, question)[: settings.shown]
    # Of all that is fresh, not of the chosen: a small addition near by must not hide a hall far away.
    is_enough = views.area_m2[fresh].max() < settings.good_enough * known.seen_m2
    return Choice(best, known.seen_m2, WhyEnded.GOOD_ENOUGH if is_enough else None, left)


def _ranked(
    places_m: NDArray[np.float64], views: Views, ways_m: NDArray[np.float64], question: ChoiceQuestion
) -> tuple[Candidate, ...]:
    """Return candidates, the best first; of equal ones the first on the lattice."""
    start = question.start
    turns_rad = facing_rad(places_m, (start.x_m, start.y_m), start.heading_rad)
    pace = question.pace
    seconds = [pace.seconds(way_m, turn_rad) for way_m, turn_rad in zip(ways_m, turns_rad, strict=True)]
    # Area a second and not area a metre: a sweep takes as long as ten metres of way.
    scores = views.area_m2 / np.array(seconds)
    return tuple(
        Candidate(
            (float(places_m[at, 0]), float(places_m[at, 1])),
            float(scores[at]),
            float(views.area_m2[at]),
            float(views.opening_m[at]),
            float(views.overlap[at]),
            float(ways_m[at]),
        )
        for at in np.argsort(-scores, kind="stable").tolist()
    )


def _left(known: _Known, question: ChoiceQuestion, settings: ExploringSettings) -> tuple[Left, ...]:
    """Return the openings that are left, and why each is."""
    near = distance_transform(np.isfinite(known.ways)) * known.spec.resolution_m <= _NEAR_M
    robot = known.spec.cell_at(question.start.x_m, question.start.y_m)
    found = openings(
        *(known.spec, known.free, known.unknown, near),
        robot=robot,
        within=known.outlook.within,
        width_min_m=settings.opening_min_m,
    )
    return tuple(Left(opening, _why(opening, question.tried.in_vain_m)) for opening in found)


def _why(opening: Opening, in_vain_m: tuple[Point, ...]) -> WhyLeft:
    if not opening.is_near:
        return WhyLeft.NO_WAY
    is_tried = any(math.dist(opening.at_m, place_m) <= _TRIED_M for place_m in in_vain_m)
    return WhyLeft.IN_VAIN if is_tried else WhyLeft.HIDDEN


def _holds(within: Rectangle, points_m: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which points lie within bounds, ``bool[n]``."""
    low, high = (within.west_m, within.south_m), (within.east_m, within.north_m)
    holds: NDArray[np.bool_] = np.all((points_m >= low) & (points_m <= high), axis=1)
    return holds


def _apart(places_m: NDArray[np.float64], from_m: Iterable[Point], apart_m: float) -> NDArray[np.bool_]:
    """Return which places are not within ``apart_m`` of any of some others, ``bool[n]``."""
    apart = np.ones(len(places_m), np.bool_)
    for x_m, y_m in from_m:
        apart &= np.hypot(places_m[:, 0] - x_m, places_m[:, 1] - y_m) > apart_m
    return apart


_NEAR_M = 1.0
"""An opening farther than this from all ground where the robot fits is one that it does not come near."""
_TRIED_M = 2.0
"""A place tried in vain is to blame for openings as near as this."""
