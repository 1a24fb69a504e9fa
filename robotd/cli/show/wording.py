"""Events in words for people, and as plain JSON for programs."""

import dataclasses
import math
from collections import Counter
from collections.abc import Callable
from typing import Any

from robotd.contract.estimate import PoseEstimate, PoseState, Region
from robotd.contract.events import (
    MapChanged,
    MissionProgress,
    RangeMeasured,
    RankMap,
    Status,
    StopPlaced,
    SweepBegun,
    SweepDone,
    SweepProgress,
    SweepReadings,
)
from robotd.contract.explored import WHYS, ExploringEnded, StopChosen
from robotd.contract.sweep_columns import from_columns
from robotd.contract.topics import EVENTS, LogEntry, Published
from robotd.contract.ways import MissionPlan, StopState
from robotd.core.pose import Odometry, Pose2
from robotd.core.reading import ReadingStatus


def as_json(event: Published) -> dict[str, Any]:
    """Return an event as one JSON object; of a map only how much of it changed, of its cells none."""
    name = EVENTS[type(event)][1]
    if isinstance(event, MapChanged):
        count = event.values.size
        spec = dataclasses.asdict(event.spec)
        plain = {"map_id": event.map_id, "generation": event.generation, "whole": event.whole}
        return {"event": name, "time_ns": event.time_ns, **plain, "spec": spec, "cells": int(count)}
    if isinstance(event, SweepReadings):
        readings = [dataclasses.asdict(reading) for reading in from_columns(event)]
        return {
            "event": name,
            "time_ns": event.time_ns,
            "number": event.number,
            "first": event.first,
            "readings": readings,
        }
    if isinstance(event, RankMap):
        event = dataclasses.replace(event, levels_zlib=b"")
    plain = dataclasses.asdict(event)
    return {"event": name, **{key: value for key, value in plain.items() if not isinstance(value, bytes)}}


def in_words(event: Published) -> str:
    """Return an event in one line."""
    words: Callable[[Any], str] = _WORDS.get(type(event), _fields_in_words)
    return words(event)


def _fields_in_words(event: Published) -> str:
    """Return an event that has no words of its own as its name and its fields, on one line."""
    fields = dataclasses.asdict(event)
    said = ", ".join(f"{name} {value}" for name, value in fields.items() if name != "time_ns" and value is not None)
    return f"{EVENTS[type(event)][1].replace('_', ' ')}: {said}"


def held_in_words(status: Status) -> str:
    """Return that a mission is held, and why, or that it goes on."""
    return f"held: {status.held}" if status.held else "the mission goes on"


def pose_in_words(pose: Pose2) -> str:
    """Return a pose in metres and degrees.

    >>> pose_in_words(Pose2(1.0, -0.5, math.pi / 2))
    'x 1.000 m, y -0.500 m, heading 90.0 deg'
    """
    return f"x {pose.x_m:.3f} m, y {pose.y_m:.3f} m, heading {math.degrees(pose.heading_rad):.1f} deg"


def region_in_words(region: Region) -> str:
    """Return one candidate region: where, how large, how well explained."""
    extent = region.extent
    size = f"{extent.x_max_m - extent.x_min_m:.2f} x {extent.y_max_m - extent.y_min_m:.2f} m"
    turn = f"{math.degrees(extent.heading_max_rad - extent.heading_min_rad):.1f} deg"
    return f"{pose_in_words(region.centre)}; {size} x {turn}, {region.best_rank} readings explained"


def estimate_in_words(estimate: PoseEstimate) -> str:
    """Return an estimate: its state first, then what it rests on; never a pose that is not unique."""
    support = f"{estimate.best_rank or 'too few'} of {estimate.readings} readings explained"
    if estimate.smallest_error_m is not None:
        support += f"; nine of ten agree once ranges may be {1000 * estimate.smallest_error_m:.0f} mm off"
    support += "".join(f", {said}" for said in estimate.layers)
    so_far = "" if estimate.final else ", so far"
    if estimate.best is not None:
        by_history = f"; by history, {estimate.unreachable} more cannot be reached" if estimate.by_history else ""
        extra = "" if estimate.state is PoseState.PREDICTED else f" ({support}{so_far}{by_history})"
        return f"{estimate.state}: {pose_in_words(estimate.best)}{extra}"
    if estimate.regions:
        why = f"; not where it should be: {estimate.contradiction}" if estimate.contradiction else ""
        return f"{estimate.state}: {_regions(estimate)} ({support}{so_far}{why})"
    return f"{estimate.state} ({support}{so_far})"


def estimate_in_short(estimate: PoseEstimate) -> str:
    """Return an estimate in less than half a line.

    >>> lost = PoseEstimate(0, PoseState.LOST, None, (), 20, 100, final=False, map_id="")
    >>> estimate_in_short(lost)
    'lost, 20/100 explained'
    """
    support = f"{estimate.best_rank or 'too few'}/{estimate.readings}"
    if estimate.best is not None:
        return f"{estimate.state} ({estimate.best.x_m:.2f}, {estimate.best.y_m:.2f}) m"
    if estimate.regions:
        return f"{estimate.state}, {_regions(estimate)}, {support}"
    return f"{estimate.state}, {support} explained"


def _regions(estimate: PoseEstimate) -> str:
    return f"{len(estimate.regions) + estimate.regions_left_out} regions"


def counts_in_words(sweep: SweepProgress) -> str:
    """Return what the readings of a sweep came to."""
    return f"{sweep.hits} hits, {sweep.misses} misses, {sweep.rejected} rejected"


def sweep_in_words(sweep: SweepProgress) -> str:
    """Return how far a sweep has come."""
    return (
        f"{sweep.taken} of {sweep.total} readings: {sweep.hits} hits, {sweep.misses} misses, {sweep.rejected} rejected"
    )


def range_in_words(one: RangeMeasured) -> str:
    """Return one measurement along the beam.

    >>> range_in_words(RangeMeasured(0, 0, 1, ReadingStatus.OK, 1.5, 310))
    '1.500 m, strength 310'
    """
    range_ = f"{one.range_m:.3f} m" if one.range_m is not None else ""
    what = "" if one.status is ReadingStatus.OK else one.status.replace("_", " ")
    strength = "" if one.strength is None else f"strength {one.strength}"
    return ", ".join(filter(None, (what, range_, strength)))


def odometry_in_words(now: Odometry, *, raw: bool = False) -> str:
    """Return where the base is by its wheels; ``raw`` adds what its encoders counted.

    >>> from robotd.core.pose import Twist2
    >>> odometry_in_words(Odometry(0, Pose2(1.0, 0.0, 0.0), Twist2(0.5, 0.0), (27300, 0)), raw=True)
    'odometry x 1.000 m, y 0.000 m, heading 0.0 deg, 0.50 m/s; counted 27300 of translation, 0 of rotation'
    """
    words = f"odometry {pose_in_words(now.in_odom)}, {now.twist.speed_mps:.2f} m/s"
    if not raw:
        return words
    counted = "{} of translation, {} of rotation".format(*now.counts) if now.counts else "nothing that it tells"
    return f"{words}; counted {counted}"


def ending_in_words(ended: ExploringEnded) -> str:
    """Return why exploring ended, and a line for each opening that is left."""
    lines = [
        f"  left open at ({one.x_m:.2f}, {one.y_m:.2f}) m, {one.width_m:.1f} m wide: {WHYS.get(one.why, one.why)}"
        for one in ended.left
    ]
    return "\n".join((ended.words, *lines))


def mission_in_words(step: MissionProgress) -> str:
    """Return a step of a mission."""
    where = f" stop {step.stop + 1} of {step.stops}" if step.stops > 1 and not step.is_last else ""
    return f"{step.kind}{where}: {step.phase}" + (f", {step.message}" if step.message else "")


def _plan_in_words(plan: MissionPlan) -> str:
    """Return what a mission intends."""
    way = (
        "" if plan.goal_m is None else "way to ({:.2f}, {:.2f}) m, {} legs".format(*plan.goal_m, len(plan.waypoints_m))
    )
    counts = Counter(stop.state for stop in plan.stops)
    stops = [f"{counts[state]} {state.replace('_', ' ')}" for state in StopState if counts[state]]
    return f"plan of mission {plan.mission_id}: " + "; ".join(filter(None, (way, ", ".join(stops))))


_WORDS: dict[type[Published], Callable[[Any], str]] = {
    PoseEstimate: estimate_in_words,
    SweepProgress: sweep_in_words,
    MissionProgress: mission_in_words,
    Odometry: odometry_in_words,
    RangeMeasured: range_in_words,
    StopPlaced: lambda event: (
        f"stop {event.stop + 1} {event.outcome.replace('_', ' ')}: {pose_in_words(event.pose)},"
        f" {event.explained:.0%} explained, {event.contradicted:.0%} contradicted"
    ),
    StopChosen: lambda event: f"stop {event.stop + 1} will be at ({event.x_m:.2f}, {event.y_m:.2f}) m: {event.reason}",
    ExploringEnded: lambda event: event.words,
    Status: lambda event: f"{event.mode}: {event.reason}",
    SweepDone: lambda event: (
        f"sweep {event.sweep.number} done: {len(event.sweep.measured)} of {len(event.sweep.readings)} measured"
    ),
    MapChanged: lambda event: (
        "no map is in use"
        if event.map_id is None
        else f"map {event.map_id[:12]} generation {event.generation}: {event.values.size} cells"
    ),
    SweepBegun: lambda event: f"sweep {event.number} of {event.total} readings begun",
    SweepReadings: lambda event: (
        f"sweep {event.number}: readings {event.first + 1} to {event.first + len(event.status_u8)}"
    ),
    MissionPlan: _plan_in_words,
    RankMap: lambda event: f"rank map of sweep {event.number}: {event.readings} readings at {event.headings} headings",
    LogEntry: lambda event: f"{event.level.lower()} {event.logger}: {event.message}",
}
