"""Make a map: at each stop sweep and insert, then go on."""

from dataclasses import dataclass

from robotd.contract.events import MissionPhase
from robotd.contract.missions import MapStart
from robotd.contract.ways import StopState
from robotd.core.clock import now_ns
from robotd.core.pose import Pose2
from robotd.core.reading import Sweep
from robotd.head.jobs import Insert, Inserted, PlaceStop
from robotd.localization.outcome import Outcome
from robotd.localization.stop_poses import StopPoses
from robotd.mission.missions.context import MissionContext, Reporter
from robotd.mission.missions.driving import NoWay, drive_to
from robotd.mission.missions.looking_again import looking_again
from robotd.mission.missions.plan_told import PlanTold
from robotd.mission.missions.stop_and_sweep import faults_text
from robotd.mission.whereabouts.map_in_use import MapInUse
from robotd.recording.results import map_result


@dataclass(frozen=True, slots=True)
class MappingResult:
    """What became of the stops."""

    swept: int
    unreachable: tuple[str, ...]
    faulty: tuple[str, ...]
    """Stops at which the rangefinder failed, and how often."""

    def __str__(self) -> str:
        """Say it in a line."""
        missed = f"; not reached: {'; '.join(self.unreachable)}" if self.unreachable else ""
        failed = "".join(f"; {text}" for text in self.faulty)
        return f"{self.swept} stops swept{missed}{failed}"


async def run_mapping(context: MissionContext, place: MapInUse, mission: MapStart, report: Reporter) -> MappingResult:
    """Carry out a :class:`MapStart` on a fresh map that odometry is already tied to.

    A stop that cannot be reached is said at once, left out, and named in the result.
    """
    unreachable: list[str] = []
    faulty: list[str] = []
    stops_m = ((mission.start.x_m, mission.start.y_m), *mission.stops_m)
    plan = PlanTold(report, place.map_id, stops_m)
    for stop, stop_m in enumerate(stops_m):
        plan.stop_is(stop, StopState.UNDER_WAY)
        # At stop 0 the robot stands already: the map begins there.
        if stop:
            report.at(MissionPhase.DRIVING, stop)
            try:
                await drive_to(context, place, plan, stop_m, mission.legs)
            # No way is an answer; a base that fails raises another error, which ends the mission.
            except NoWay as error:
                plan.stop_is(stop, StopState.UNREACHED, error.reason, error.nearest_m)
                unreachable.append(f"stop {stop}: {error}")
                report.at(MissionPhase.DRIVING, message=unreachable[-1])
                continue
        report.at(MissionPhase.SWEEPING, stop)
        sweep = await looking_again(context, report, lambda: context.sweep(next(context.sweep_numbers)))
        faulty += [f"stop {stop}: {text}" for text in [faults_text(sweep)] if text]
        report.at(MissionPhase.COMPUTING, message=faults_text(sweep))
        inserted = await _laid_in(context, place, sweep)
        place.take(inserted)
        change = place.changes(now_ns(), inserted)
        context.publish(change, map_result(change, inserted.digest))
        plan.stop_is(stop, StopState.SWEPT)
    return MappingResult(len(stops_m) - len(unreachable), tuple(unreachable), tuple(faulty))


async def _laid_in(context: MissionContext, place: MapInUse, sweep: Sweep) -> Inserted:
    """Lay a sweep into the map, where it fits what was mapped so far, and tie odometry there."""
    if context.settings.localization.stops is StopPoses.ODOMETRY:
        return await context.head.ask(Insert(place.ref, sweep, _taken_at(context, sweep)))
    travel, begins_at = context.whereabouts.stopped(sweep.in_odom), _taken_at(context, sweep)
    laid = await context.head.ask(PlaceStop(place.ref, place.map_id, sweep, travel, begins_at, now_ns()))
    # In one step with the map that it is on: nobody is told a pose on a map that is no more.
    is_found = laid.placed.outcome in _FOUND
    context.whereabouts.placed(laid.map_from_robot, sweep.in_odom, is_found=is_found)
    for event in laid.decided:
        context.publish(event)
    _tell_tie(context)
    return laid


def _tell_tie(context: MissionContext) -> None:
    """Say where the robot is by the new tie, without waiting for it to move."""
    here = context.robot.drive.odometry.latest
    if here is not None and (predicted := context.whereabouts.predicted(here)) is not None:
        context.publish(predicted)


_FOUND = frozenset(outcome.value for outcome in Outcome if outcome.is_found)


def _taken_at(context: MissionContext, sweep: Sweep) -> Pose2:
    """Return where a sweep began on the map, by odometry."""
    tie = context.whereabouts.tie
    assert tie is not None  # the map began with one, which may be doubted but is never dropped
    return tie.in_map(sweep.in_odom)
