"""Map a place that nobody described: look round, go where the most is expected to be seen, until nothing is left."""

from dataclasses import dataclass, field, replace

import msgspec

from robotd.contract.events import MissionPhase
from robotd.contract.explored import ExploringEnded, StopChosen
from robotd.contract.missions import Explore
from robotd.contract.ways import Hindrance, Point
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.rectangle import Rectangle
from robotd.exploring.errand import Errand
from robotd.exploring.reasons import WhyEnded, WhyLeft
from robotd.exploring.settings import Pace
from robotd.exploring.tried import Tried
from robotd.head.jobs import Choose, Chosen
from robotd.localization.outcome import Outcome
from robotd.mission.missions.at_rest import at_rest
from robotd.mission.missions.context import MissionContext, Reporter
from robotd.mission.missions.driving import NoWay
from robotd.mission.missions.looking_ahead import drive_looking
from robotd.mission.missions.plan_told import PlanTold
from robotd.mission.missions.surveying import Surveyed, here_on, survey_stop
from robotd.mission.whereabouts.map_in_use import MapInUse

_NEWS_CELLS = 20
"""A stop that changed fewer cells was in vain."""
_DETOURS = 5
"""How often something may stand in the way to one goal."""
_AGAINST = 3
"""This many stops in a row that speak against the map are no bad luck."""
_SWEEP_MIN_S = 1.0
"""However fast the rangefinder is, a stop costs time."""


@dataclass(slots=True)
class Journey:
    """How far one mission has come."""

    began_ns: int
    now_ns: int
    met_m: tuple[Point, ...] = ()
    """What was seen on the way since the last stop that the map has free: obstacles, whatever the map says."""
    pace: Pace = field(default_factory=Pace)
    stops: int = 0
    way_m: float = 0.0
    against: int = 0
    """Stops in a row that speak against the map."""

    def is_spent(self, mission: Explore) -> bool:
        """Return whether a budget is used up."""
        return (
            self.stops >= mission.stops_max
            or (mission.way_max_m is not None and self.way_m >= mission.way_max_m)
            or (mission.time_max_s is not None and self.now_ns - self.began_ns >= mission.time_max_s * NS_PER_S)
        )

    def stopped(self, stop: Surveyed) -> None:
        """Take note of a stop that was made."""
        first_ns, self.now_ns = (stop.sweep.readings[at].time_ns for at in (0, -1))
        self.pace = replace(self.pace, sweep_s=max(_SWEEP_MIN_S, (self.now_ns - first_ns) / NS_PER_S))
        self.stops += 1
        self.way_m += stop.way_m
        self.against = self.against + 1 if stop.outcome is Outcome.CONTRADICTS else 0
        # What stood in the way is on the map by now, or has gone.
        self.met_m = ()


async def run_exploring(context: MissionContext, place: MapInUse, mission: Explore, report: Reporter) -> str:
    """Carry out an :class:`Explore` on a map that odometry is tied to; return what to tell the client.

    Raises:
        MissionError: too many readings failed, or the robot is not localized on the map; it stands.
        DeviceError, LinkTimeout, TransportError: a device failed; the robot must be stopped.
    """
    exploring = Exploring(context, place, mission, report, await _begun(context, place, mission))
    await exploring.look_round(found_again=mission.resume)
    for goal_m in exploring.errand.asked_m:
        await exploring.visit(goal_m, "asked for")
    # One choice at a time, on the map as it is after the last stop: a tour planned ahead would be of a map that
    # is no more.
    while (chosen := await exploring.choose()).goal_m is not None:
        await exploring.visit(chosen.goal_m, _reason(chosen), chosen)
    if mission.returns:
        await exploring.go_back()
    return exploring.end(chosen)


async def _begun(context: MissionContext, place: MapInUse, mission: Explore) -> Journey:
    """Begin an errand on the map, or take up the one that it was left with."""
    time_ns, here = await here_on(context, "explore --resume")
    errand = place.errand or Errand((here.x_m, here.y_m))
    bounds = mission.within
    within = errand.within if bounds is None else Rectangle(*msgspec.structs.astuple(bounds))
    place.errand = replace(errand, within=within, asked_m=(*errand.asked_m, *mission.stops_m))
    return Journey(time_ns, time_ns)


@dataclass(frozen=True, slots=True)
class Exploring:
    """An exploring mission under way."""

    context: MissionContext
    place: MapInUse
    mission: Explore
    report: Reporter
    journey: Journey

    async def look_round(self, *, found_again: bool = False, at_goal_m: Point | None = None) -> None:
        """Make a stop where the robot stands; the first on a map that is gone on with is ``found_again``."""
        # Before the sweep, so that everything it tells bears the number of this stop.
        self.report.stop = self.journey.stops
        stop = await survey_stop(self.context, self.place, self.report, found_again=found_again)
        # In one step with the map: who goes on after a kill must not find a stop that its errand knows nothing of.
        self.journey.stopped(stop)
        errand = self.errand if at_goal_m is None else self.errand.gone_to(at_goal_m)
        # A place that shows nothing new would be chosen again for ever: what hides behind it does not appear by
        # looking twice.
        is_in_vain = stop.cells < _NEWS_CELLS
        self.place.explored(errand.in_vain((stop.at.x_m, stop.at.y_m)) if is_in_vain else errand)

    async def choose(self) -> Chosen:
        """Return where to stop next, or why to end; a journey that is spent, or lost, ends whatever is left."""
        _, start = await here_on(self.context, "explore --resume")
        journey, errand = self.journey, self.errand
        tried = Tried(errand.in_vain_m, self._met_m)
        cut_off_m = self.context.settings.rangefinder.range_max_m
        # Asked even if the journey is spent: the answer also says what is left to do, which the last word
        # tells.
        job = Choose(self.place.ref, start, tried, errand.within, cut_off_m, journey.pace)
        chosen = await self.context.head.ask(job)
        # Before the budget: a map that contradicts what is seen is the reason that people must hear.
        if journey.against >= _AGAINST:
            return _ended_by(WhyEnded.LOST, chosen)
        if chosen.ending is None and journey.is_spent(self.mission):
            return _ended_by(WhyEnded.BUDGET, chosen)
        return chosen

    async def visit(self, goal_m: Point, reason: str, chosen: Chosen | None = None) -> None:
        """Go to a place and look round there; if it is not reached, say so, and do not try it again."""
        candidates, tour_m = ((), ()) if chosen is None else (chosen.candidates, chosen.tour_m)
        journey, (x_m, y_m) = self.journey, goal_m
        if journey.is_spent(self.mission):
            return
        self.context.publish(
            StopChosen(now_ns(), self.place.map_id, journey.stops, x_m, y_m, reason, candidates, tour_m)
        )
        self.report.at(MissionPhase.DRIVING, journey.stops, f"to ({x_m:.2f}, {y_m:.2f}) m: {reason}")
        hindrance = await self._reach(goal_m)
        # Not reached is no failure of the mission: a chair in a doorway must not cost the rest of the house.
        if hindrance:
            self.place.explored(self.errand.in_vain(goal_m).gone_to(goal_m))
            self.report.at(MissionPhase.DRIVING, message=f"({x_m:.2f}, {y_m:.2f}) m not reached: {hindrance}")
        else:
            await self.look_round(at_goal_m=goal_m)

    async def go_back(self) -> None:
        """Return to where the mission began."""
        self.report.at(MissionPhase.DRIVING, message="back to where it began")
        hindrance = await self._reach(self.errand.began_m)
        if hindrance:
            self.report.at(MissionPhase.DRIVING, message=f"not got back: {hindrance}")
        await at_rest(self.context)

    def end(self, chosen: Chosen) -> str:
        """Tell why it ended and what is left; return that for people."""
        journey = self.journey
        ended = ExploringEnded(
            now_ns(),
            self.place.map_id,
            chosen.ending or WhyEnded.COMPLETE,
            journey.stops,
            journey.way_m,
            chosen.seen_m2,
            chosen.left,
        )
        self.context.publish(ended)
        self.report.stops = journey.stops
        return ended.words

    @property
    def errand(self) -> Errand:
        """What it is out for, which stays with the map."""
        assert self.place.errand is not None  # it began with one
        return self.place.errand

    @property
    def _met_m(self) -> tuple[Point, ...]:
        return (*self.place.bumps_m, *self.journey.met_m)

    async def _reach(self, goal_m: Point) -> str:
        """Drive to a place, round what stands in the way; return why it was not reached, empty if it was."""
        plan = PlanTold(self.report, self.place.map_id)
        # Bounded: somebody who walks before the robot is met again and again, and each detour is a way it need
        # not drive.
        for _ in range(1 + _DETOURS):
            try:
                met_m = await drive_looking(self.context, self.place, plan, goal_m, self._met_m)
            # No way is an answer; a device that fails raises another error, which ends the mission.
            except NoWay as error:
                # No other goal would be any better: a robot that does not know where it is cannot go anywhere.
                if error.reason is Hindrance.NOT_LOCALIZED:
                    raise
                return str(error)
            if not met_m:
                return ""
            self.journey.met_m = (*self.journey.met_m, *met_m)
            words = f"at ({met_m[0][0]:.2f}, {met_m[0][1]:.2f}) m stands what is not on the map"
            self.report.at(MissionPhase.DRIVING, message=words)
        return "there is always something in the way"


def _ended_by(ending: WhyEnded, chosen: Chosen) -> Chosen:
    """Return a choice as an end: what was not looked at yet, is left to do."""
    left = tuple(replace(one, why=WhyLeft.TO_DO) if one.why == WhyLeft.HIDDEN else one for one in chosen.left)
    return msgspec.structs.replace(chosen, goal_m=None, ending=ending.value, left=left)


def _reason(chosen: Chosen) -> str:
    best = chosen.candidates[0]
    first = f"; first of {len(chosen.tour_m)} stops that see all that is open" if len(chosen.tour_m) > 1 else ""
    return (
        f"{best.area_m2:.1f} m2 more expected after {best.way_m:.1f} m, "
        f"{best.overlap:.0%} of the beams on known walls{first}"
    )
