"""A log with raw odometry, mapped as the daemon maps: some of its scans are stops, one placed after the other."""

import itertools
import math
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from robotd.core.angles import wrap_rad
from robotd.core.motion_error import Travel
from robotd.core.pose import Pose2
from robotd.evaluation.recorded import Reach
from robotd.grid.readings import Readings
from robotd.localization.placing import Believed, place
from robotd.logs.scan import Scan
from robotd.slam.survey import Decision, StopPlaced, Survey, SurveySettings

_STOP_M, _STOP_RAD = 0.75, math.radians(45.0)
"""A scan this far from the last stop, or turned by this much, is the next."""
_ABOUT_M = 6.0
"""A scan that is no stop is located on the stops so near to it."""


@dataclass(slots=True)
class SurveyedLog:
    """What a survey of a log came to."""

    scans: Sequence[Scan]
    stops: Sequence[int]
    """Which scans they are."""
    survey: Survey
    outcomes: Counter[str] = field(default_factory=Counter)
    """How often each came up, and each other decision, by their names."""
    cpu_s: list[float] = field(default_factory=list)
    """Processor time of each stop."""


def readings_in_robot(scan: Scan, reach: Reach) -> Readings:
    """Return the beams of a scan that say something, in the frame of the robot."""
    met = scan.hit & (scan.ranges_m <= reach.range_max_m)
    # A hit beyond what is believed says, as a miss does, that the beam was free so far.
    some, mount = met | scan.missed | scan.hit, scan.robot_from_laser
    rows = np.empty((int(some.sum()), 5))
    rows[:, 0] = scan.angles_rad[some] + mount.heading_rad
    rows[:, 1] = np.where(met, scan.ranges_m, reach.clear_m)[some]
    rows[:, 2], rows[:, 3], rows[:, 4] = mount.x_m, mount.y_m, ~met[some]
    return Readings(rows)


def stops_of(scans: Sequence[Scan]) -> list[int]:
    """Return which scans are stops: the first, and each that odometry has far enough from the last one."""
    stops = [0]
    for index, scan in enumerate(scans):
        step = scans[stops[-1]].odometry.inverse() @ scan.odometry
        if math.hypot(step.x_m, step.y_m) >= _STOP_M or abs(step.heading_rad) >= _STOP_RAD:
            stops.append(index)
    return stops


def travel_between(scans: Sequence[Scan], one: int, other: int) -> Travel:
    """Return what odometry tells from one scan to another, earlier or later."""
    way = range(one, other + 1) if one <= other else range(one, other - 1, -1)
    return Travel.through(scans[index].odometry for index in way)


def surveyed(
    scans: Sequence[Scan],
    reach: Reach,
    settings: SurveySettings,
    told: Callable[[int, Sequence[Decision]], None] = lambda _stop, _decisions: None,
) -> SurveyedLog:
    """Survey a log from its first scan to its last, and bring all stops together at the end.

    Args:
        scans: of the log; its poses are of no account, its odometry is.
        reach: how far ranges are believed.
        settings: how to map and localize.
        told: is told each stop and what was decided there.
    """
    stops = stops_of(scans)
    survey = Survey.begun(readings_in_robot(scans[0], reach), scans[0].odometry, settings)
    found = SurveyedLog(scans, stops, survey)
    for stop, (one, other) in enumerate(itertools.pairwise(stops), start=1):
        begin_s = time.process_time()
        readings, travel = readings_in_robot(scans[other], reach), travel_between(scans, one, other)
        found.survey, decisions = found.survey.stepped(readings, travel)
        found.cpu_s.append(time.process_time() - begin_s)
        for decision in decisions:
            name = decision.placed.outcome.value if isinstance(decision, StopPlaced) else type(decision).__name__
            found.outcomes[name] += 1
        told(stop, decisions)
    # Loops are solved some at a time: those since the last time still wait.
    if found.survey.unsolved:
        found.survey, _ = found.survey.reconciled()
    return found


def interpolated(found: SurveyedLog) -> list[Pose2]:
    """Return where the robot was at each scan, by odometry between its stops."""
    poses: list[Pose2] = []
    last = 0
    for index, scan in enumerate(found.scans):
        while last + 1 < len(found.stops) and found.stops[last + 1] <= index:
            last += 1
        pose = _carried(found, last, scan)
        if last + 1 < len(found.stops):
            share = (index - found.stops[last]) / (found.stops[last + 1] - found.stops[last])
            pose = _between(pose, _carried(found, last + 1, scan), share)
        poses.append(pose)
    return poses


def located(found: SurveyedLog, which: Sequence[int], reach: Reach) -> dict[int, Pose2]:
    """Return where the robot was at some scans: stops have a pose, other scans are placed on the finished map.

    As the metric's authors propose where a program has no pose for each scan. Each is placed as a stop is, odometry
    carrying on from the stop nearest to it in the log.
    """
    graph = found.survey.graph
    laid = [(found.stops[stop], stop) for stop in graph.laid.tolist()]
    stop_of, at = dict(laid), np.array([scan for scan, _ in laid])
    return {
        scan: graph.pose(stop_of[scan])
        if scan in stop_of
        else _placed(found, scan, laid[int(np.abs(at - scan).argmin())], reach)
        for scan in sorted(set(which))
    }


def _placed(found: SurveyedLog, scan: int, nearest: tuple[int, int], reach: Reach) -> Pose2:
    graph, settings = found.survey.graph, found.survey.settings
    travel = travel_between(found.scans, nearest[0], scan)
    prior = Believed(graph.pose(nearest[1]) @ travel.step, settings.motion.covariance(travel))
    ground = settings.maps.ground(graph, graph.laid_about(prior.pose, _ABOUT_M), prior.pose)
    return place(ground, readings_in_robot(found.scans[scan], reach), prior, settings.placing).believed.pose


def _carried(found: SurveyedLog, stop: int, scan: Scan) -> Pose2:
    step = found.scans[found.stops[stop]].odometry.inverse() @ scan.odometry
    return found.survey.graph.pose(stop) @ step


def _between(one: Pose2, other: Pose2, share: float) -> Pose2:
    turned_rad = wrap_rad(one.heading_rad + share * wrap_rad(other.heading_rad - one.heading_rad))
    return Pose2(one.x_m + share * (other.x_m - one.x_m), one.y_m + share * (other.y_m - one.y_m), turned_rad)
