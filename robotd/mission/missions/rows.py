"""The kinds of mission, each a row: its request, what it needs, its stops, and what carries it out."""

from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from robotd.contract.estimate import Contradiction, PoseEstimate
from robotd.contract.missions import (
    DriveStraight,
    DriveTo,
    Explore,
    Localize,
    Look,
    MapContinue,
    MapStart,
    Measure,
    Mission,
    Resolve,
    Scan,
    Turn,
)
from robotd.core.errors import MissionError
from robotd.head.jobs import BeginMap
from robotd.mission.missions.by_head import run_look, run_measure, run_scan
from robotd.mission.missions.by_odometry import run_straight, run_turning
from robotd.mission.missions.context import MissionContext, Reporter
from robotd.mission.missions.driving import run_driving
from robotd.mission.missions.exploring import run_exploring
from robotd.mission.missions.localizing import pose_text, run_localizing
from robotd.mission.missions.looking_again import looking_again
from robotd.mission.missions.mapping import run_mapping
from robotd.mission.missions.resolving import run_resolving
from robotd.mission.missions.surveying import here_on
from robotd.mission.missions.tilts import tilts_of
from robotd.mission.motion.legs import next_odometry
from robotd.mission.whereabouts.map_in_use import MapInUse
from robotd.mission.whereabouts.tie import Tie

_MARGIN_M = 3.0
"""A map reaches at least this far beyond its stops, and farther unless the stops fill it."""
_REACH_M = 20.0
"""How far from its start a robot explores that was given no bounds."""


class Host(Protocol):
    """What a mission needs of the one that runs it."""

    def adopt(self, place: MapInUse, tie: Tie | None) -> None:
        """Make this the map in use, and tell everybody."""


@dataclass(frozen=True, slots=True)
class MissionRow:
    """One kind of mission."""

    request: type[Mission]
    carry_out: Callable[[Host, MissionContext, Any, Reporter], Awaitable[str]]
    """Carries it out and returns what to tell the client.

    Raises:
        MissionError: it cannot be done; the robot stands.
        DeviceError, LinkTimeout, TransportError: a device failed; the robot must be stopped.
    """
    stops: Callable[[Any], int] = lambda _: 1
    needs_base: bool = True
    pauses_prediction: bool = False
    """Whether odometry is not asked where the robot is: while it looks for itself, what it finds is the better word."""


async def _make_map(host: Host, context: MissionContext, mission: MapStart, report: Reporter) -> str:
    points_m = ((mission.start.x_m, mission.start.y_m), *mission.stops_m)
    place = await _begin_map(host, context, mission, points_m, report)
    return str(await run_mapping(context, place, points_m, mission.legs, report))


async def _continue_map(_: Host, context: MissionContext, mission: MapContinue, report: Reporter) -> str:
    place = _place_named(context, mission.name)
    if mission.start is not None:
        silence_s = context.settings.driving.silence_s
        now = await context.hold.through(lambda: next_odometry(context.robot.drive, silence_s))
        context.whereabouts.placed(mission.start.pose, now.in_odom, is_found=True)
    _time_ns, here = await here_on(context, "map continue")
    points_m = ((here.x_m, here.y_m), *mission.stops_m)
    return str(await run_mapping(context, place, points_m, mission.legs, report, goes_on=True))


async def _explore(host: Host, context: MissionContext, mission: Explore, report: Reporter) -> str:
    if mission.resume:
        place = _place_named(context, mission.name)
    else:
        place = await _begin_map(host, context, mission, _corners_m(mission), report)
    return await run_exploring(context, place, mission, report)


async def _localize(_: Host, context: MissionContext, mission: Localize, report: Reporter) -> str:
    # Taken once: a mission ends on the map that it began on, and looking again must not look on another.
    place = _place(context)
    look = await looking_again(
        context, report, lambda: run_localizing(context, place, mission, report, next(context.sweep_numbers))
    )
    return describe(look.estimate)


async def _resolve(_: Host, context: MissionContext, mission: Resolve, report: Reporter) -> str:
    resolved = await run_resolving(context, _place(context), mission, report)
    return f"{describe(resolved.estimate)}; {resolved}"


async def _drive(_: Host, context: MissionContext, mission: DriveTo, report: Reporter) -> str:
    return await run_driving(context, _place(context), mission, report)


async def _straight(_: Host, context: MissionContext, mission: DriveStraight, report: Reporter) -> str:
    return await run_straight(context, mission, report)


async def _turn(_: Host, context: MissionContext, mission: Turn, report: Reporter) -> str:
    return await run_turning(context, mission, report)


async def _look(_: Host, context: MissionContext, mission: Look, report: Reporter) -> str:
    return await looking_again(context, report, lambda: run_look(context, mission))


async def _scan(_: Host, context: MissionContext, mission: Scan, report: Reporter) -> str:
    return await looking_again(context, report, lambda: run_scan(context, mission, report))


async def _measure(_: Host, context: MissionContext, mission: Measure, report: Reporter) -> str:
    return await run_measure(context, mission, report)


_ROWS = (
    MissionRow(MapStart, _make_map, stops=lambda mission: 1 + len(mission.stops_m)),
    MissionRow(MapContinue, _continue_map, stops=lambda mission: 1 + len(mission.stops_m)),
    MissionRow(Explore, _explore, stops=lambda mission: mission.stops_max),
    MissionRow(Localize, _localize, needs_base=False, pauses_prediction=True),
    MissionRow(Resolve, _resolve, pauses_prediction=True),
    MissionRow(DriveTo, _drive),
    MissionRow(DriveStraight, _straight),
    MissionRow(Turn, _turn),
    MissionRow(Look, _look, needs_base=False),
    MissionRow(Scan, _scan, needs_base=False),
    MissionRow(Measure, _measure, needs_base=False),
)
MISSION_ROWS = {row.request: row for row in _ROWS}


def _place(context: MissionContext) -> MapInUse:
    place = context.whereabouts.map_in_use
    if place is None:
        raise MissionError(
            "no map is in use: make one, with robotctl map start NAME, or load one, with robotctl map load NAME"
        )
    return place


def _place_named(context: MissionContext, name: str) -> MapInUse:
    place = _place(context)
    if place.name != name:
        raise MissionError(f"the map in use is {place.name}, not {name}; load that first, with robotctl map load NAME")
    return place


def _corners_m(mission: Explore) -> tuple[tuple[float, float], ...]:
    """Return what a map that is explored must have room for: its bounds, or the same to all sides of the start."""
    (x_m, y_m), within = (mission.start.x_m, mission.start.y_m), mission.within
    if within is None:
        return ((x_m - _REACH_M, y_m - _REACH_M), (x_m + _REACH_M, y_m + _REACH_M), *mission.stops_m)
    # Refused at once: the map is cut to the bounds, and the first stop might lie beside it.
    if not within.holds(x_m, y_m):
        raise MissionError(f"the robot stands at ({x_m:.2f}, {y_m:.2f}) m, outside of the bounds of what to explore")
    return ((within.west_m, within.south_m), (within.east_m, within.north_m), *mission.stops_m)


async def _begin_map(
    host: Host,
    context: MissionContext,
    mission: MapStart | Explore,
    points_m: Sequence[tuple[float, float]],
    report: Reporter,
) -> MapInUse:
    """Begin a map with room for some points, take it into use, and tie odometry to it."""
    settings, tilts = context.settings.grid, await tilts_of(context, mission.tilts)
    try:
        spec = settings.spec_covering(points_m, _MARGIN_M)
    except ValueError as error:
        raise MissionError(f"this does not fit on one map: {error}") from error
    number = context.head.number()
    # Before odometry is read: making a large map takes a while, and the tie must be of where the robot is after
    # that.
    begun = await context.head.ask(BeginMap(number, spec, settings))
    silence_s = context.settings.driving.silence_s
    here = await context.hold.through(lambda: next_odometry(context.robot.drive, silence_s))
    place = MapInUse(f"new-{report.mission_id}", mission.name, number, begun)
    place.tilts = tilts
    # Tied from the first moment: a client said where it stands, and there is nothing on the map that could
    # contradict.
    host.adopt(place, Tie.between(mission.start.pose, here.in_odom))
    return place


def describe(estimate: PoseEstimate) -> str:
    """Return an estimate in one line for people."""
    share = f"{estimate.best_rank or 'too few'} of {estimate.readings} readings"
    share += "".join(f", {said}" for said in estimate.layers)
    if estimate.best is not None:
        by_history = f"; by history: it cannot have come to {estimate.unreachable} more" if estimate.by_history else ""
        return f"{estimate.state} at {pose_text(estimate.best)}: {share}{by_history}"
    if estimate.jumped_m is not None and estimate.regions:
        found = pose_text(estimate.regions[0].pose)
        why = _WHY[estimate.contradiction] if estimate.contradiction else ""
        return (
            f"{estimate.state}: found at {found}, {estimate.jumped_m:.1f} m from where odometry puts it ({share}){why};"
            " localize once more, best from another place: it counts when two looks agree"
        )
    if not estimate.regions:
        return f"{estimate.state}: no pose is believed; the best explain {share}"
    regions = len(estimate.regions) + estimate.regions_left_out
    excluded = f"; it cannot have come to {estimate.unreachable} more" if estimate.unreachable else ""
    return f"{estimate.state}: {regions} regions explain up to {share}{excluded}"


_WHY = {
    Contradiction.CARRIED: ", as if it had been carried",
    Contradiction.SLIPPED: ", as if its wheels had slipped",
}
