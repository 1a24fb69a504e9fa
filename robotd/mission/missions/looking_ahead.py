"""To a place on the map, piece by piece, with a look before and on each: what came since the map stops the robot.

Between two pieces it looks all round as well, and finds itself again: wheels lie, and where they alone say where the
robot is, it is soon beside its way by more than it keeps clear of walls.
"""

import math
from dataclasses import dataclass

from robotd.contract.ways import Hindrance, Point
from robotd.core.angles import FULL_TURN_RAD
from robotd.core.clock import NS_PER_S
from robotd.core.motion_error import Travel
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading
from robotd.exploring.ahead import bearings_about, bearings_along, bearings_on_the_way, in_the_way, shape_of
from robotd.head.jobs import Glance, Plan
from robotd.mission.missions.context import MissionContext
from robotd.mission.missions.driving import NoWay
from robotd.mission.missions.plan_told import PlanTold
from robotd.mission.missions.surveying import tell_tie
from robotd.mission.missions.watching import drive_watching, reach_m
from robotd.mission.motion.legs import next_odometry, rotate_to
from robotd.mission.whereabouts.map_in_use import MapInUse

PIECE_M = 1.5
"""No farther at a time: on less way wheels are seldom off by more than the robot keeps clear of walls."""
_ALL_ROUND = tuple(FULL_TURN_RAD * number / 20 - math.pi for number in range(20))
"""Enough to find a pose again that is known to some centimetres."""
_LOOKS = 3
"""So often on one piece something is met on the way that is not there any more by the second look."""


async def drive_looking(
    context: MissionContext, place: MapInUse, plan: PlanTold, goal_m: Point, met_m: tuple[Point, ...]
) -> tuple[Point, ...]:
    """Drive to a point in the map frame; return where something was met in the way, nothing if it was reached.

    After each hold it goes on from where the robot is then.

    Args:
        context: the mission's.
        place: the map.
        plan: told of each way.
        goal_m: where to go.
        met_m: what was met before, map frame: it is gone round.

    Raises:
        NoWay: the robot is not localized on the map, or the point cannot be reached.
        DeviceError, LinkTimeout, TransportError: a device failed on the way.
    """
    return await context.hold.through(lambda: _driven(context, place, plan, goal_m, met_m))


@dataclass(frozen=True, slots=True)
class _At:
    """Where the robot is, by its wheels and on the map."""

    in_odom: Pose2
    in_map: Pose2


async def _driven(
    context: MissionContext, place: MapInUse, plan: PlanTold, goal_m: Point, met_m: tuple[Point, ...]
) -> tuple[Point, ...]:
    known = await _here(context)
    way = await context.head.ask(Plan(place.ref, known.in_map, goal_m, met_m))
    if way.reason is not None:
        raise NoWay(way.message, way.reason, way.nearest_m)
    plan.drives((known.in_map.x_m, known.in_map.y_m), way.waypoints_m)
    for number, end_m in enumerate(_pieces(known.in_map, way.waypoints_m)):
        known, met_m_now = await _driven_piece(context, place, known, end_m, number, is_wary=bool(met_m))
        if met_m_now:
            return met_m_now
    return ()


async def _driven_piece(
    context: MissionContext, place: MapInUse, known: _At, end_m: Point, number: int, *, is_wary: bool
) -> tuple[_At, tuple[Point, ...]]:
    """Drive one piece of a way; return where the robot was found last, and what was met in the way, map frame."""
    seen_m: tuple[Point, ...] = ()
    for look in range(number, number + _LOOKS):
        here = await _facing(context, end_m)
        length_m = _way_m(here.in_map, end_m)
        # As a set: beams ahead and those all round share bearings, and none is worth two readings.
        along_rad = {*bearings_along(length_m, context.settings.planning.robot_radius_m)}
        # Round what it met it goes with open eyes: a corner between two beams is soon a bump.
        ahead_rad = {*along_rad, *bearings_about(0.0)} if is_wary or seen_m else along_rad
        # Where the first piece begins, it has just made a stop, and knows where it is.
        wanted_rad = sorted({*ahead_rad, *_ALL_ROUND} if look else ahead_rad)
        readings = await context.sweeper.glance(wanted_rad, clockwise=look % 2 == 1)
        if look:
            here = known = await _found_again(context, place, known, here, readings)
        # After it was found again: what is met is told on the map from there, and by wheels alone it would lie
        # beside itself.
        if met := await _met(context, readings, length_m):
            return known, tuple(here.in_map.transform(*place_m) for place_m in met)
        # What is met on the way stops it, and no more: standing, it looks again whether something is there.
        seen_m = await _go(context, end_m, readings)
        if not seen_m:
            return known, ()
    return known, seen_m


async def _here(context: MissionContext) -> _At:
    now = await next_odometry(context.robot.drive, context.settings.driving.silence_s)
    pose = context.whereabouts.pose_of(now)
    if pose is None:
        message = "cannot drive on this map: the robot is not localized on it; first: robotctl localize"
        raise NoWay(message, Hindrance.NOT_LOCALIZED)
    return _At(now.in_odom, pose)


async def _facing(context: MissionContext, end_m: Point) -> _At:
    """Turn towards the end of a piece; return where the robot is then."""
    here = await _here(context)
    if _way_m(here.in_map, end_m) <= context.settings.driving.position_tolerance_m:
        return here  # from so near it could lie anywhere
    bearing_rad = math.atan2(end_m[1] - here.in_map.y_m, end_m[0] - here.in_map.x_m)
    # As a difference: the map's frame and that of odometry are turned against each other, and a turn is the
    # same in both.
    turn_rad = bearing_rad - here.in_map.heading_rad
    await rotate_to(context.robot.drive, here.in_odom.heading_rad + turn_rad, context.settings.driving, context.hold)
    return await _here(context)


async def _found_again(
    context: MissionContext, place: MapInUse, known: _At, here: _At, readings: tuple[RangeReading, ...]
) -> _At:
    """Tie odometry to where the map explains readings that were taken here; return where that is."""
    # A failed shot says nothing about the walls, and would count as a reading that the map does not explain.
    measured = tuple(reading for reading in readings if reading.is_measured)
    travel = Travel.through((known.in_odom, here.in_odom))
    found = await context.head.ask(Glance(place.ref, measured, known.in_map, travel))
    context.whereabouts.placed(found.map_from_robot, here.in_odom, is_found=found.is_found)
    tell_tie(context)
    return _At(here.in_odom, found.map_from_robot)


async def _met(context: MissionContext, readings: tuple[RangeReading, ...], length_m: float) -> tuple[Point, ...]:
    """Return what is in the way of a piece ahead, robot frame, as broad as a second look finds it; often nothing."""
    met = in_the_way(readings, length_m, context.settings.planning.robot_radius_m)
    if met is None:
        return ()
    return shape_of(met, await context.sweeper.glance(bearings_about(met.bearing_rad)))


async def _go(context: MissionContext, end_m: Point, looked: tuple[RangeReading, ...]) -> tuple[Point, ...]:
    """Drive to the end of a piece; return what stopped the robot on the way, map frame, nothing if it arrived."""
    tie = context.whereabouts.believed
    assert tie is not None  # what doubts it, ends the mission
    driving, half_width_m = context.settings.driving, context.settings.planning.robot_radius_m
    # The look before has just shown how fast the head is.
    reading_s = (looked[-1].time_ns - looked[0].time_ns) / NS_PER_S / max(1, len(looked) - 1)
    bearings_rad = bearings_on_the_way(reach_m(driving), half_width_m, speed_mps=driving.speed_mps, reading_s=reading_s)
    seen_rad = await context.sweeper.within_reach(bearings_rad)
    met_m = await drive_watching(context, tie.map_from_odom.inverse().transform(*end_m), seen_rad)
    return () if met_m is None else (tie.map_from_odom.transform(*met_m),)


def _pieces(start: Pose2, waypoints_m: tuple[Point, ...]) -> list[Point]:
    """Return the ends of the pieces of a way."""
    pieces: list[Point] = []
    at_m = (start.x_m, start.y_m)
    for corner_m in waypoints_m:
        count = max(1, math.ceil(math.dist(at_m, corner_m) / PIECE_M))
        across_m = (corner_m[0] - at_m[0], corner_m[1] - at_m[1])
        # Equal pieces: the full length each time would leave a stub at the end, with a look of its own.
        shares = [number / count for number in range(1, count + 1)]
        pieces += [(at_m[0] + share * across_m[0], at_m[1] + share * across_m[1]) for share in shares]
        at_m = corner_m
    return pieces


def _way_m(here: Pose2, end_m: Point) -> float:
    return math.hypot(end_m[0] - here.x_m, end_m[1] - here.y_m)
