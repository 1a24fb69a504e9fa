"""Make a map: at each stop sweep and insert, then go on."""

from collections.abc import Sequence
from dataclasses import dataclass

from robotd.contract.events import MissionPhase
from robotd.contract.missions import Legs
from robotd.contract.ways import Point, StopState
from robotd.mission.missions.context import MissionContext, Reporter
from robotd.mission.missions.driving import NoWay, drive_to
from robotd.mission.missions.plan_told import PlanTold
from robotd.mission.missions.surveying import survey_stop
from robotd.mission.whereabouts.map_in_use import MapInUse


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


async def run_mapping(
    context: MissionContext,
    place: MapInUse,
    stops_m: Sequence[Point],
    legs: Legs,
    report: Reporter,
    *,
    goes_on: bool = False,
) -> MappingResult:
    """Lay sweeps at some stops, of which the first is where the robot stands, into a map that odometry is tied to.

    With ``goes_on`` the map has stops of before, and the robot was found on it by other means than its wheels.

    A stop that cannot be reached is said at once, left out, and named in the result.
    """
    unreachable: list[str] = []
    faulty: list[str] = []
    # With all stops from the beginning: a console draws the way ahead, not only what was done.
    plan = PlanTold(report, place.map_id, tuple(stops_m))
    for stop, stop_m in enumerate(stops_m):
        plan.stop_is(stop, StopState.UNDER_WAY)
        # At stop 0 the robot stands already.
        if stop:
            report.at(MissionPhase.DRIVING, stop)
            try:
                await drive_to(context, place, plan, stop_m, legs)
            # No way is an answer; a base that fails raises another error, which ends the mission.
            except NoWay as error:
                plan.stop_is(stop, StopState.UNREACHED, error.reason, error.nearest_m)
                # In the order of the stops, and in the last word: who comes back after an hour reads one line.
                unreachable.append(f"stop {stop}: {error}")
                report.at(MissionPhase.DRIVING, message=unreachable[-1])
                continue
        report.stop = stop
        surveyed = await survey_stop(context, place, report, found_again=goes_on and not stop)
        faulty += [f"stop {stop}: {text}" for text in [surveyed.faults] if text]
        plan.stop_is(stop, StopState.SWEPT)
    return MappingResult(len(stops_m) - len(unreachable), tuple(unreachable), tuple(faulty))
