"""Where to stop next, or why there is nowhere.

Stops cost more than metres: a sweep takes as long as ten metres of way. So candidates are judged by the ground that a
whole sweep is expected to add, over the time that it takes to get there, turn, and sweep. Before all else a sweep must
find its place on the map: candidates from which most beams end on known walls come first, however little they add.

The best of them is not always where it goes next. Some of them together look behind all that is open, and are put in
the order in which they wait least: what is near is finished before it leaves, unless something large waits for it.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.contract.ways import Point
from robotd.core.pose import Pose2
from robotd.core.rectangle import Rectangle
from robotd.exploring.charted import Charted
from robotd.exploring.cover import covering
from robotd.exploring.openings import Opening, openings
from robotd.exploring.order import best_order
from robotd.exploring.outlook import Views, facing_rad
from robotd.exploring.reasons import WhyEnded, WhyLeft
from robotd.exploring.settings import ExploringSettings, Pace
from robotd.exploring.tried import Tried
from robotd.grid.distance import distance_transform
from robotd.grid.occupancy import OccupancyGrid
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
    """Those that the next stop was chosen from, the best first; but before them all the one that was chosen."""
    tour_m: tuple[Point, ...]
    """Where it means to stop, in order; empty at an end."""
    seen_m2: float
    """Free ground that was seen."""
    ending: WhyEnded | None
    left: tuple[Left, ...]
    """What is open by now."""

    @property
    def goal_m(self) -> Point | None:
        """Where to stop next; None at an end."""
        return self.tour_m[0] if self.ending is None else None


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
        known = Charted.of(
            *(grid, hit, lone, Terrain.of(grid, question.start, hit, doubted, planning)),
            robot=(question.start.x_m, question.start.y_m),
            within=question.within,
            cut_off_m=question.cut_off_m,
            settings=settings,
        )
        choice = _chosen(known, question, settings)
        if choice.ending is None:
            return choice
    return choice


def _chosen(known: Charted, question: ChoiceQuestion, settings: ExploringSettings) -> Choice:
    cells = known.candidates(settings.lattice_m)
    places_m = known.points_m(cells)
    views = known.outlook.views(places_m, settings)
    # What was tried is left out by where it lies, not by what it sees: a place that showed nothing new will not
    # by asking again.
    fresh = (views.opening_m > 0.0) & _apart(places_m, (*question.stops_m, *question.tried.in_vain_m), settings.apart_m)
    left = _left(known, question, settings)
    if not fresh.any():
        return Choice((), (), known.seen_m2, WhyEnded.UNREACHABLE if left else WhyEnded.COMPLETE, left)
    # Or the most that there is.
    overlap_min = min(settings.overlap_min, float(views.overlap[fresh].max()))
    which = np.flatnonzero(fresh & (views.overlap >= overlap_min))
    ranked = _ranked(places_m[which], views[which], known.ways_m(cells[which]), question)
    enough_m2 = min(settings.good_enough * known.seen_m2, settings.good_enough_max_m2)
    # Of all that is fresh, not of the chosen: a small addition near by must not hide a hall far away.
    if views.area_m2[fresh].max() < enough_m2:
        return Choice(ranked[: settings.shown], (), known.seen_m2, WhyEnded.GOOD_ENOUGH, left)
    tour_m = tuple(_point(places_m[which[at]]) for at in _tour(known, cells[which], views[which], question, enough_m2))
    ranked = tuple(sorted(ranked, key=lambda one: one.at_m != tour_m[0]))
    return Choice(ranked[: settings.shown], tour_m, known.seen_m2, None, left)


def _tour(
    known: Charted, cells: NDArray[np.intp], views: Views, question: ChoiceQuestion, enough_m2: float
) -> tuple[int, ...]:
    """Return which of some cells look behind all that is open, in the order in which to stop there."""
    pace = question.pace
    cover = covering(
        views.behind_m2, known.ways_m(cells), lambda which: known.ways_between_m(cells, which), pace, enough_m2
    )
    # By a length that stands for what each sees: by the area itself, the largest would nearly always come first.
    weights = np.sqrt(views.area_m2[list(cover.places)]).tolist()
    return tuple(cover.places[at] for at in best_order(cover.ways_m / pace.speed_mps + pace.sweep_s, weights))


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
            _point(places_m[at]),
            float(scores[at]),
            float(views.area_m2[at]),
            float(views.opening_m[at]),
            float(views.overlap[at]),
            float(ways_m[at]),
        )
        for at in np.argsort(-scores, kind="stable").tolist()
    )


def _left(known: Charted, question: ChoiceQuestion, settings: ExploringSettings) -> tuple[Left, ...]:
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


def _point(place_m: NDArray[np.float64]) -> Point:
    return float(place_m[0]), float(place_m[1])


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
