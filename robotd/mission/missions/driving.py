"""From here to a place on the map: plan, then leg by leg."""

from robotd.contract.events import MissionPhase
from robotd.contract.missions import DriveTo, Legs
from robotd.contract.ways import Hindrance, Point
from robotd.core.errors import MissionError
from robotd.core.pose import Pose2
from robotd.head.jobs import Plan
from robotd.mission.missions.at_rest import at_rest
from robotd.mission.missions.context import MissionContext, Reporter
from robotd.mission.missions.plan_told import PlanTold
from robotd.mission.motion.legs import drive_leg, next_odometry
from robotd.mission.whereabouts.map_in_use import MapInUse


class NoWay(MissionError):
    """A place cannot be driven to; the robot stands where it stood."""

    def __init__(self, message: str, reason: Hindrance, nearest_m: Point | None = None) -> None:
        super().__init__(message)
        self.reason = reason
        self.nearest_m = nearest_m
        """The reachable point nearest to it, if there is one."""


async def drive_to(context: MissionContext, place: MapInUse, plan: PlanTold, goal_m: Point, legs: Legs) -> None:
    """Drive to a point in the map frame, where the robot is told to stop; after each hold, from where it is then.

    Raises:
        NoWay: the robot is not localized on the map, or the point cannot be reached.
        DeviceError, LinkTimeout, TransportError: the base failed on the way.
    """
    await context.hold.through(lambda: _drive_to(context, place, plan, goal_m, legs))


async def _drive_to(context: MissionContext, place: MapInUse, plan: PlanTold, goal_m: Point, legs: Legs) -> None:
    # Not the latest, which may be from before a hold: the next.
    here = await next_odometry(context.robot.drive, context.settings.driving.silence_s)
    tie = context.whereabouts.believed
    if tie is None:
        message = "cannot drive on this map: the robot is not localized on it; first: robotctl localize"
        raise NoWay(message, Hindrance.NOT_LOCALIZED)
    start = tie.in_map(here.in_odom)
    waypoints_m = (goal_m,) if legs is Legs.STRAIGHT else await _planned(context, place, start, goal_m)
    plan.drives((start.x_m, start.y_m), waypoints_m)
    # One tie for all legs: nothing looks round on the way, and what makes it doubted ends the mission.
    odom_from_map = tie.map_from_odom.inverse()
    for waypoint_m in waypoints_m:
        point_m = odom_from_map.transform(*waypoint_m)
        await drive_leg(context.robot.drive, *point_m, context.settings.driving, context.hold)


async def _planned(context: MissionContext, place: MapInUse, start: Pose2, goal_m: Point) -> tuple[Point, ...]:
    way = await context.head.ask(Plan(place.ref, start, goal_m, place.bumps_m))
    if way.reason is not None:
        message = f"({goal_m[0]:.2f}, {goal_m[1]:.2f}) m cannot be reached: {way.message}"
        raise NoWay(message, way.reason, way.nearest_m)
    return way.waypoints_m


async def run_driving(context: MissionContext, place: MapInUse, mission: DriveTo, report: Reporter) -> str:
    """Carry out a :class:`DriveTo`; return what to tell the client."""
    report.at(MissionPhase.DRIVING)
    plan = PlanTold(report, place.map_id)
    await drive_to(context, place, plan, (mission.x_m, mission.y_m), mission.legs)
    pose = context.whereabouts.pose_of(await at_rest(context))
    assert pose is not None  # drive_to refuses to start without
    return f"arrived at ({pose.x_m:.2f}, {pose.y_m:.2f}) m"
