"""From here to a place on the map: plan, then leg by leg."""

from robotd.contract.events import MissionPhase
from robotd.contract.missions import DriveTo, Legs
from robotd.core.errors import MissionError
from robotd.core.pose import Odometry, Pose2
from robotd.head.jobs import Plan
from robotd.mission.missions.context import MissionContext, Reporter
from robotd.mission.motion.legs import drive_leg, next_odometry
from robotd.mission.whereabouts.map_in_use import MapInUse


async def drive_to(context: MissionContext, place: MapInUse, x_m: float, y_m: float, legs: Legs) -> Odometry:
    """Drive to a point in the map frame and return odometry there; after each hold, from where the robot is then.

    Raises:
        MissionError: the robot is not localized on the map, or the point cannot be reached.
        DeviceError, LinkTimeout, TransportError: the base failed on the way.
    """
    return await context.hold.through(lambda: _drive_to(context, place, x_m, y_m, legs))


async def _drive_to(context: MissionContext, place: MapInUse, x_m: float, y_m: float, legs: Legs) -> Odometry:
    # Not the latest, which may be from before a hold: the next.
    here = await next_odometry(context.robot.drive, context.settings.driving.silence_s)
    tie = context.whereabouts.believed
    if tie is None:
        raise MissionError("cannot drive on this map: the robot is not localized on it; first: robotctl localize")
    start = tie.in_map(here.in_odom)
    waypoints_m = ((x_m, y_m),) if legs is Legs.STRAIGHT else await _planned(context, place, start, (x_m, y_m))
    # One tie for all legs: nothing looks round on the way, and what makes it doubted ends the mission.
    odom_from_map = tie.map_from_odom.inverse()
    for waypoint_m in waypoints_m:
        point_m = odom_from_map.transform(*waypoint_m)
        here = await drive_leg(context.robot.drive, *point_m, context.settings.driving, context.hold)
    return here


async def _planned(
    context: MissionContext, place: MapInUse, start: Pose2, goal_m: tuple[float, float]
) -> tuple[tuple[float, float], ...]:
    planned = await context.head.ask(Plan(place.ref, start, goal_m))
    if planned.hindrance:
        raise MissionError(f"({goal_m[0]:.2f}, {goal_m[1]:.2f}) m cannot be reached: {planned.hindrance}")
    return planned.waypoints_m


async def run_driving(context: MissionContext, place: MapInUse, mission: DriveTo, report: Reporter) -> str:
    """Carry out a :class:`DriveTo`; return what to tell the client."""
    report.at(MissionPhase.DRIVING)
    arrived = await drive_to(context, place, mission.x_m, mission.y_m, mission.legs)
    pose = context.whereabouts.pose_of(arrived)
    assert pose is not None  # drive_to refuses to start without
    return f"arrived at ({pose.x_m:.2f}, {pose.y_m:.2f}) m"
