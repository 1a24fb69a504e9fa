"""Which of several places is it? Drive to where they differ, and look again, until one is left.

The robot does not know where it is, so no way is planned on the map: it drives ways that are free wherever it may be
(:mod:`robotd.sensing.safe_ways`), and carries all places along (:mod:`robotd.localization.history`). Where rooms are
alike to the last wall nothing will ever tell: then it gives up, and all places are told.
"""

from dataclasses import dataclass

from robotd.contract.area import Area
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import MissionPhase
from robotd.contract.missions import Localize, PriorHeading, Resolve
from robotd.head.jobs import ChooseSafeWay
from robotd.mission.missions.context import MissionContext, Reporter
from robotd.mission.missions.localizing import LookedRound, run_localizing
from robotd.mission.missions.looking_again import looking_again
from robotd.mission.motion.legs import drive_leg
from robotd.mission.whereabouts.map_in_use import MapInUse
from robotd.sensing.rivals import Rival, SafeWay

_IN_VAIN_MAX = 6
"""Stops in a row that leave no fewer places."""
_WAY_FACTOR = 1.2
"""The disk that the client knows the robot in grows by the way, and by what wheels err."""


_NO_REST_M = 0.1


@dataclass(frozen=True, slots=True)
class Resolved:
    """What is known in the end, and what it cost."""

    estimate: PoseEstimate
    rivals: int
    """Places that the first look left."""
    stops: int
    way_m: float
    gave_up: str = ""
    """Why it was not told which; empty if it was."""

    def __str__(self) -> str:
        """Say it in a line."""
        told = f"{self.rivals} places at first, {self.stops} stops, {self.way_m:.1f} m driven"
        return f"{told}; gave up: {self.gave_up}" if self.gave_up else told


async def run_resolving(context: MissionContext, place: MapInUse, mission: Resolve, report: Reporter) -> Resolved:
    """Carry out a :class:`Resolve`.

    Raises:
        MissionError: the head cannot look round.
        DeviceError, LinkTimeout, TransportError: a device failed; the robot must be stopped.
    """
    look = await _look(context, place, mission, report, 0.0)
    first = fewest = _places(look.estimate)
    stops, way_m, in_vain = 1, 0.0, 0
    while look.estimate.state is PoseState.AMBIGUOUS:
        way, why_not = await _next_way(context, place, look.estimate, in_vain)
        if way is None:
            return Resolved(look.estimate, first, stops, way_m, why_not)
        report.at(MissionPhase.DRIVING, stops, _in_words(way, len(look.estimate.regions)))
        for corner_m in way.corners_m:
            # From where that look began, in odometry: on the map the robot is in several places at once.
            await _drive(context, look.in_odom.transform(*corner_m))
        stops, way_m = stops + 1, way_m + way.length_m
        look = await _look(context, place, mission, report, way_m)
        # Against the fewest so far, not the last: places that come and go would count as progress for ever.
        in_vain = 0 if _places(look.estimate) < fewest else in_vain + 1
        fewest = min(fewest, _places(look.estimate))
    return Resolved(look.estimate, first, stops, way_m)


async def _look(
    context: MissionContext, place: MapInUse, mission: Resolve, report: Reporter, way_m: float
) -> LookedRound:
    """Look round, all headings tried; ``way_m`` is how far the robot has driven since the client knew where it is."""
    within = mission.within
    if within is not None:
        # Grown and not dropped: what the client knew is still worth most of the search, and a disk that the
        # robot has left would exclude the truth.
        within = Area(within.x_m, within.y_m, within.radius_m + _WAY_FACTOR * way_m)
    localize = Localize(heading=PriorHeading.UNKNOWN, within=within, adaptive=True)
    return await looking_again(
        context, report, lambda: run_localizing(context, place, localize, report, next(context.sweep_numbers))
    )


async def _next_way(
    context: MissionContext, place: MapInUse, estimate: PoseEstimate, in_vain: int
) -> tuple[SafeWay | None, str]:
    """Return a way to drive; or None, and why there is none."""
    if in_vain == _IN_VAIN_MAX:
        return None, f"{_IN_VAIN_MAX} stops in a row left no fewer places"
    # A leg is safe only if it is free from every place that is possible, so all of them must be known.
    if estimate.regions_left_out or not (estimate.complete and estimate.regions):
        return None, "more places are left than can be told, and no way is known to be free from all of them"
    rivals = tuple(Rival.of(region, place.spec) for region in estimate.regions)
    settings = context.settings
    answer = await context.head.ask(
        ChooseSafeWay(place.ref, rivals, settings.rangefinder.range_max_m, settings.driving.speed_mps)
    )
    return answer.way, "no way is free wherever the robot may be"


async def _drive(context: MissionContext, end_m: tuple[float, float]) -> None:
    """Drive to a point in the ``odom`` frame, and after a hold on to the same."""
    drive, driving = context.robot.drive, context.settings.driving
    await context.hold.through(lambda: drive_leg(drive, *end_m, driving, context.hold))


def _places(estimate: PoseEstimate) -> int:
    return len(estimate.regions) + estimate.regions_left_out


def _in_words(way: SafeWay, places: int) -> str:
    rest = f" of {way.length_m + way.rest_m:.1f} m" if way.rest_m > _NO_REST_M else ""
    return (
        f"{places} places: {way.length_m:.1f} m{rest}, free under each;"
        f" {way.told_apart:.0%} of a sweep there tells them apart"
    )
