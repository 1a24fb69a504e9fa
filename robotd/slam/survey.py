"""Mapping and localizing at once, one stop after the other: a state and a sweep in, another state and decisions out.

Pure, so that a mission and an evaluation of logs do the same, bit for bit; nothing here waits, draws or drives.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from robotd.core.motion_error import MotionBias, MotionError, Travel
from robotd.core.pose import IDENTITY, Pose2
from robotd.grid.readings import Readings
from robotd.localization.outcome import Outcome
from robotd.localization.placing import Believed, Placed, PlacingSettings, place
from robotd.slam.graph import Edge, EdgeKind
from robotd.slam.local_map import LocalMaps
from robotd.slam.loops import Loop, LoopSettings, edge_to, seek
from robotd.slam.solve import solve
from robotd.slam.stop_graph import StopGraph
from robotd.slam.stops import PlacedStop, Poses


@dataclass(frozen=True, slots=True)
class SurveySettings:
    """How a robot maps and localizes at once; the same for all buildings."""

    recent: int = 15
    """A sweep is placed on this many stops before it."""
    held_max: int = 3
    """The last of this many sweeps in a row that speak against the map begins a segment of its own."""
    floor_m: float = 0.02
    floor_rad: float = math.radians(0.35)
    """No step is surer than this."""
    solve_every: int = 10
    """Small corrections after which the map is made again."""
    motion: MotionError = field(default_factory=MotionError)
    placing: PlacingSettings = field(default_factory=PlacingSettings)
    loops: LoopSettings | None = field(default_factory=LoopSettings)
    """None closes no loops: then it is the front end alone that is measured."""
    maps: LocalMaps = field(default_factory=LocalMaps)


@dataclass(frozen=True, slots=True, eq=False)
class StopPlaced:
    """A stop has a place: where it was put, and how the map liked that."""

    stop: int
    placed: Placed


@dataclass(frozen=True, slots=True, eq=False)
class LoopHeld:
    """A loop would bend the map by more than one stop is believed."""

    loop: Loop


@dataclass(frozen=True, slots=True, eq=False)
class LoopClosed:
    """A loop is believed: it is an edge of the graph from here on."""

    loop: Loop


@dataclass(frozen=True, slots=True, eq=False)
class Reconciled:
    """All stops were brought together: the map is another."""

    stops_moved: int
    largest_move_m: float
    refused: tuple[Edge, ...]


Decision = StopPlaced | LoopHeld | LoopClosed | Reconciled


@dataclass(frozen=True, slots=True, eq=False)
class Survey:
    """What is known after some stops."""

    settings: SurveySettings = field(default_factory=SurveySettings)
    graph: StopGraph = field(default_factory=StopGraph)
    bias: MotionBias = field(default_factory=MotionBias)
    since_laid: Travel = field(default_factory=Travel)
    """Since the last stop that maps are made of."""
    held: int = 0
    """Stops in a row that spoke against the map."""
    way_m: float = 0.0
    closed_at_m: float = 0.0
    """How far the robot had come when a loop was closed last."""
    waiting: tuple[Loop, ...] = ()
    """Large corrections that nothing has confirmed yet."""
    unsolved: int = 0
    """Loops that were closed since the map was made again."""
    stored: int = 0
    """Stops of before, of a survey that was gone on with: it need not go on where they end."""

    @classmethod
    def begun(cls, readings: Readings, at: Pose2 = IDENTITY, settings: SurveySettings | None = None) -> "Survey":
        """Return the survey of a first stop, whose place is where the map begins."""
        graph = StopGraph().with_stop(PlacedStop(readings, Travel(), Outcome.PLACED), at)
        return cls(settings or SurveySettings(), graph)

    @classmethod
    def resumed(cls, stops: Sequence[tuple[Readings, Pose2]], settings: SurveySettings) -> "Survey":
        """Return the survey of stops that were stored, each tied to the one before as surely as a step can be."""
        (first, at), *later = stops
        survey = cls.begun(first, at, settings)
        graph, floor = survey.graph, np.zeros((3, 3))
        for readings, pose in later:
            step = graph.pose(-1).inverse() @ pose
            travel = Travel(step, math.hypot(step.x_m, step.y_m), abs(step.heading_rad))
            found = Believed(pose, floor).no_surer(settings.floor_m, settings.floor_rad)
            edge = edge_to(graph, len(graph.stops) - 1, len(graph.stops), found, EdgeKind.STEP)
            graph = graph.with_stop(PlacedStop(readings, travel, Outcome.PLACED), pose, edge)
        return replace(survey, graph=graph, stored=len(stops))

    def found_at(self, pose: Pose2, travel: Travel) -> Travel:
        """Return the travel since the last stop of a robot that was found at a pose by other means than its wheels."""
        expected = self.graph.pose(int(self.graph.laid[-1])) @ self.since_laid.step
        return replace(travel, step=expected.inverse() @ pose)

    def stepped(self, readings: Readings, travel: Travel) -> tuple["Survey", tuple[Decision, ...]]:
        """Return what is known after one more stop, and what was decided."""
        after, placed = _placed(self, readings, travel)
        decisions: tuple[Decision, ...] = (StopPlaced(len(self.graph.stops), placed),)
        settings = self.settings.loops
        if settings is None or not _asks_for_loops(after, placed.outcome, settings):
            return after, decisions
        after, more = _looped(after, settings)
        return after, decisions + more

    def reconciled(self) -> tuple["Survey", Reconciled]:
        """Return the survey with all stops where they bend the edges least."""
        # From where they are: Gauss-Newton needs a start near to the answer, and this one was built stop by
        # stop.
        solution = solve(self.graph.poses, self.graph.edges)
        return self.moved_to(solution.poses, tuple(self.graph.edges[at] for at in solution.refused))

    def moved_to(self, poses: Poses, refused: tuple[Edge, ...] = ()) -> tuple["Survey", Reconciled]:
        """Return the survey with its stops elsewhere."""
        moves_m = np.hypot(*(poses - self.graph.poses)[:, :2].T)
        told = Reconciled(int((moves_m > _MOVED_M).sum()), float(moves_m.max(initial=0.0)), refused)
        # What waits was found on poses that are no more.
        return replace(self, graph=self.graph.moved_to(poses), unsolved=0, waiting=()), told


def _placed(survey: Survey, readings: Readings, travel: Travel) -> tuple[Survey, Placed]:
    """Return the survey with one more stop, and what came of placing it."""
    settings, graph, since = survey.settings, survey.graph, survey.since_laid.then(travel)
    last = int(graph.laid[-1])
    prior = Believed(graph.pose(last) @ survey.bias.corrected(since), settings.motion.covariance(since))
    ground = settings.maps.ground(graph, _recent(survey, prior.pose), prior.pose)
    placed = place(ground, readings, prior, settings.placing)
    is_against = placed.outcome is Outcome.CONTRADICTS
    held = survey.held + 1 if is_against else 0
    # One sweep against the map may be people in the way; three in a row, and it is the map, or the wheels, that
    # are wrong.
    opens = held >= settings.held_max
    is_laid = opens or not is_against
    stop = PlacedStop(readings, travel, placed.outcome, graph.stops[-1].segment + opens, is_laid=is_laid)
    kind = EdgeKind.STEP if placed.outcome.is_found else EdgeKind.ODOMETRY
    found = placed.believed.no_surer(settings.floor_m, settings.floor_rad)
    edge = edge_to(graph, last, len(graph.stops), found, kind)
    # Only from what the map fully explains, and is as sure of: a place that odometry itself decided, as along a wall,
    # would teach it that it does not err.
    learns = placed.outcome is Outcome.PLACED and placed.believed.deviation_m <= prior.deviation_m / math.sqrt(2.0)
    after = replace(
        survey,
        graph=graph.with_stop(stop, placed.believed.pose, edge),
        bias=survey.bias.learned(since, edge.step) if learns else survey.bias,
        # Summed over stops that were held back: the next is tied to the last one that is in the map.
        since_laid=Travel() if is_laid else since,
        held=0 if opens else held,
        way_m=survey.way_m + travel.way_m,
    )
    return after, placed


def _recent(survey: Survey, near: Pose2) -> list[int]:
    """Return the stops that the next sweep is placed on: the last ones, or of those that were stored the nearest."""
    graph, recent = survey.graph, survey.settings.recent
    laid = graph.laid.tolist()
    segment = graph.stops[laid[-1]].segment
    latest = [stop for stop in laid if graph.stops[stop].segment == segment][-recent:]
    here = [stop for stop in latest if stop >= survey.stored]
    if len(here) == len(latest):
        return latest
    stored = np.arange(survey.stored)
    nearest = stored[np.argsort(graph.off_m(near, stored), kind="stable")[: recent - len(here)]]
    return sorted(nearest.tolist()) + here


def _asks_for_loops(survey: Survey, outcome: Outcome, settings: LoopSettings) -> bool:
    is_turn = (len(survey.graph.stops) - 1) % settings.every == 0
    # A loop that waits is asked again at once: what confirms it must come soon, or it is forgotten.
    return is_turn or bool(survey.waiting) or outcome is Outcome.CONTRADICTS


def _looped(survey: Survey, settings: LoopSettings) -> tuple[Survey, tuple[Decision, ...]]:
    """Return the survey after its last stop was sought on old ones, and what was decided."""
    stop = len(survey.graph.stops) - 1
    loop = seek(survey.graph, survey.way_m - survey.closed_at_m, survey.settings.maps, settings)
    waiting = tuple(one for one in survey.waiting if stop - one.stop < settings.agree_within)
    if loop is None:
        return replace(survey, waiting=waiting), ()
    if not loop.is_large(settings):
        return _closed(replace(survey, waiting=waiting), (loop,), large=False)
    agreeing = tuple(one for one in waiting if one.agrees(loop, settings))
    if not agreeing:
        return replace(survey, waiting=(*waiting, loop)), (LoopHeld(loop),)
    # All that agree are taken, also those that waited: each is an edge of its own, found from another stop.
    return _closed(survey, (*agreeing, loop), large=True)


def _closed(survey: Survey, loops: Sequence[Loop], *, large: bool) -> tuple[Survey, tuple[Decision, ...]]:
    """Return the survey with loops closed; all stops are brought together where that is worth it."""
    graph, unsolved = survey.graph.with_edges([loop.edge for loop in loops]), survey.unsolved + len(loops)
    after = replace(survey, graph=graph, unsolved=unsolved, closed_at_m=survey.way_m)
    closed = tuple(LoopClosed(loop) for loop in loops)
    if not (large or unsolved >= survey.settings.solve_every):
        return after, closed
    after, reconciled = after.reconciled()
    return after, (*closed, reconciled)


_MOVED_M = 0.001
