"""One stop of a map in the making: sweep, find its place on what was mapped so far, lay it in."""

from dataclasses import dataclass

from robotd.contract.events import MissionPhase
from robotd.core.clock import now_ns
from robotd.core.errors import MissionError
from robotd.core.motion_error import Travel
from robotd.core.pose import Pose2
from robotd.core.reading import Sweep
from robotd.head.jobs import Insert, Inserted, PlaceStop
from robotd.localization.outcome import Outcome
from robotd.localization.stop_poses import StopPoses
from robotd.mission.missions.context import MissionContext, Reporter
from robotd.mission.missions.looking_again import looking_again
from robotd.mission.missions.stop_and_sweep import faults_text
from robotd.mission.missions.tilts import require_tilts
from robotd.mission.motion.legs import next_odometry
from robotd.mission.whereabouts.map_in_use import MapInUse
from robotd.recording.results import map_result


@dataclass(frozen=True, slots=True)
class Surveyed:
    """What came of a stop."""

    sweep: Sweep
    faults: str
    """How many readings failed; empty if none did."""
    outcome: Outcome | None
    """None where odometry alone says where the stop is."""
    cells: int
    """How many cells of the map it changed."""
    way_m: float
    """From the stop before, as the wheels tell it."""
    at: Pose2
    """Where the robot stood, on the map."""


async def here_on(context: MissionContext, then: str) -> tuple[int, Pose2]:
    """Return the time, and where the robot is by then on the map in use.

    Raises:
        MissionError: it is not localized on it; names the verb that may come ``then``.
    """
    silence_s = context.settings.driving.silence_s
    now = await context.hold.through(lambda: next_odometry(context.robot.drive, silence_s))
    pose = context.whereabouts.pose_of(now)
    if pose is None:
        first = "the robot is not localized on this map; first: robotctl localize"
        raise MissionError(f"{first}, then {then}")
    return now.time_ns, pose


async def survey_stop(
    context: MissionContext, place: MapInUse, report: Reporter, *, found_again: bool = False
) -> Surveyed:
    """Sweep where the robot stands, and lay that into the map.

    With ``found_again`` it goes on with a map on which it was found by other means than its wheels.

    Raises:
        MissionError: too many readings failed, or the map has a layer at a tilt that must not be looked at; the robot
            stands.
        DeviceError, LinkTimeout, TransportError: a device failed; the robot must be stopped.
    """
    report.at(MissionPhase.SWEEPING)
    # Each time: the map may be of another robot, whose head sat elsewhere.
    tilts = await require_tilts(context, place.tilts)
    sweep = await looking_again(context, report, lambda: context.sweep(next(context.sweep_numbers), tilts=tilts))
    faults = faults_text(sweep)
    report.at(MissionPhase.COMPUTING, message=faults)
    travel = context.whereabouts.stopped(sweep.in_odom)
    inserted, outcome, at = await _laid_in(context, place, sweep, travel, found_again=found_again)
    place.take(inserted)
    change = place.changes(now_ns(), inserted)
    context.publish(change, map_result(change, inserted.digest))
    return Surveyed(sweep, faults, outcome, len(change.cells), travel.way_m, at)


async def _laid_in(
    context: MissionContext, place: MapInUse, sweep: Sweep, travel: Travel, *, found_again: bool
) -> tuple[Inserted, Outcome | None, Pose2]:
    """Lay a sweep into the map, where it fits what was mapped so far, and tie odometry there."""
    at = _taken_at(context, sweep)
    if context.settings.localization.stops is StopPoses.ODOMETRY:
        return await context.head.ask(Insert(place.ref, sweep, at)), None, at
    laid = await context.head.ask(PlaceStop(place.ref, place.map_id, sweep, travel, at, now_ns(), found_again))
    # In one step with the map that it is on: nobody is told a pose on a map that is no more.
    outcome = Outcome(laid.placed.outcome)
    context.whereabouts.placed(laid.map_from_robot, sweep.in_odom, is_found=outcome.is_found)
    for event in laid.decided:
        context.publish(event)
    tell_tie(context)
    return laid, outcome, laid.map_from_robot


def tell_tie(context: MissionContext) -> None:
    """Say where the robot is by a new tie, without waiting for it to move."""
    here = context.robot.drive.odometry.latest
    if here is not None and (predicted := context.whereabouts.predicted(here)) is not None:
        context.publish(predicted)


def _taken_at(context: MissionContext, sweep: Sweep) -> Pose2:
    """Return where a sweep began on the map, by odometry."""
    tie = context.whereabouts.tie
    assert tie is not None  # the map began with one, which may be doubted but is never dropped
    return tie.in_map(sweep.in_odom)
