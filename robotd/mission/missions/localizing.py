"""Where am I? Sweep here, and narrow the feasible poses down reading by reading, while the sweep goes on.

Readings go to the head in batches of a fixed count, so what is estimated after which reading never depends
on how fast this machine happens to be.
"""

import asyncio
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

from robotd.contract.estimate import PoseEstimate
from robotd.contract.events import MissionPhase
from robotd.contract.missions import Localize, PriorHeading
from robotd.core.angles import wrap_rad
from robotd.core.clock import now_ns
from robotd.core.errors import MissionError
from robotd.core.pose import IDENTITY, Odometry, Pose2
from robotd.core.reading import RangeReading, Slant, Tilt
from robotd.head.jobs import Narrow, Narrowed, Prepare
from robotd.mission.missions.at_rest import at_rest
from robotd.mission.missions.context import MissionContext, Reporter
from robotd.mission.missions.looking_until_sure import LookingUntilSure
from robotd.mission.missions.stop_and_sweep import faults_text
from robotd.mission.missions.tilts import require_tilts
from robotd.mission.whereabouts.map_in_use import MapInUse
from robotd.recording.results import result_of
from robotd.sensing.until_sure import CONTRAST_MIN

_BATCH = 20
"""Readings between two estimates while the heading is known and readings are counted as they come."""
_ESTIMATES = 4
"""How often a sweep is searched while the heading is not: at each quarter, whatever its number of readings."""


class LookedRound(NamedTuple):
    """What a look round came to."""

    estimate: PoseEstimate
    in_odom: Pose2
    """Where odometry put the robot when it began."""


async def run_localizing(
    context: MissionContext, place: MapInUse, mission: Localize, report: Reporter, number: int
) -> LookedRound:
    """Carry out a :class:`Localize`: sweep, estimate, and tie odometry to the map if the answer is unique."""
    tilts = await _tilts(context, place, mission)
    # Before headings are chosen: the prior is of where it stands now, not of where it was still turning.
    here = await at_rest(context)
    headings_rad = _headings(context, mission, here)
    # Before the sweep: a head that does not reach all round lets the base turn, and that way belongs to the
    # next look.
    context.whereabouts.looks(here.in_odom)
    report.at(MissionPhase.SWEEPING)
    # Drawn before the try, so that whatever fails, the head is told to forget what it may have begun.
    stop = context.head.number()
    try:
        # A whole sweep is judged at its end and nowhere else; one that may end early must not end on a chance.
        contrast_min = CONTRAST_MIN if mission.adaptive else 0.0
        where = place.ref, place.map_id, headings_rad, mission.within
        await context.head.ask(Prepare(stop, *where, contrast_min, mission.smallest_error, mission.layers))
        of = LookRound(report.mission_id, number)
        show = partial(context.ranks.show, stop, place, place.generation, number)
        narrowing = Narrowing(context, stop, _between(context, mission), of, show, ties=mission.tie)
        if mission.adaptive:
            looking = LookingUntilSure(context, place.ref, narrowing)
            return await _looked_until_sure(context, report, narrowing, looking, number)
        return await _looked_round(context, report, narrowing, number, tilts)
    finally:
        context.head.forget(stop)


async def _tilts(context: MissionContext, place: MapInUse, mission: Localize) -> tuple[Tilt, ...]:
    """Return the further tilts to look at: those of the map's layers, if they are wanted."""
    if not mission.layers:
        return ()
    if not place.tilts:
        raise MissionError(
            "the map in use has no layers: it was made at one tilt; make one at several, with robotctl map start NAME"
            " --tilt DEG"
        )
    if context.settings.localization.conservative:
        raise MissionError("layers exclude places that they explain badly, localization.conservative by proof alone")
    return await require_tilts(context, place.tilts)


async def _looked_round(
    context: MissionContext, report: Reporter, narrowing: "Narrowing", number: int, tilts: tuple[Tilt, ...]
) -> LookedRound:
    """Sweep, and narrow down meanwhile."""
    # Beside the sweep: the head works while the laser turns, so the last word comes a batch after the last
    # reading, not a whole sweep later.
    narrowed = asyncio.create_task(narrowing.run(), name="narrowing")
    try:
        sweep = await context.sweep(number, narrowing, tilts=tilts)
        report.at(MissionPhase.COMPUTING, message=faults_text(sweep))
        narrowing.end(sweep.slants)
        return LookedRound(await narrowed, sweep.in_odom)
    finally:
        # Whatever ended the sweep: a task is not left behind by its owner.
        # Cancelled and waited for, in this order: a task that is only cancelled could still publish an estimate
        # of a mission that has ended.
        narrowed.cancel()
        await asyncio.wait((narrowed,))


async def _looked_until_sure(
    context: MissionContext, report: Reporter, narrowing: "Narrowing", looking: LookingUntilSure, number: int
) -> LookedRound:
    """Read to all sides until two answers agree."""
    sweep = await context.look(number, looking.wanted, looking)
    report.at(MissionPhase.COMPUTING, message=faults_text(sweep))
    return LookedRound(await narrowing.answer((), final=True), sweep.in_odom)


def _headings(context: MissionContext, mission: Localize, here: Odometry) -> tuple[float, ...]:
    """Return the headings to try, ascending."""
    settings = context.settings.localization
    if mission.heading is PriorHeading.UNKNOWN:
        return settings.headings_all_round()
    if mission.heading_rad is not None:
        # Clients may count from 0 to 2 pi as well as from -pi to pi.
        return settings.headings_near(wrap_rad(mission.heading_rad))
    heading_rad = context.whereabouts.heading_of(here)
    if heading_rad is None:
        raise MissionError(
            "the heading is unknown: odometry is not tied to this map; try all headings (--heading-unknown, in the API"
            " heading = unknown), or say yours (--heading-deg, heading_rad)"
        )
    return settings.headings_near(heading_rad)


def _between(context: MissionContext, mission: Localize) -> int:
    """Return how many readings there are between two estimates."""
    # Rounded up: down would add an estimate for the few readings that are left over.
    return -(-context.settings.sweep.readings // _ESTIMATES) if mission.heading is PriorHeading.UNKNOWN else _BATCH


@dataclass(frozen=True, slots=True)
class LookRound:
    """What an estimate is of."""

    mission_id: int
    sweep: int


class Narrowing:
    """A sweep under way: takes readings as they come, publishes estimates as they firm up."""

    def __init__(
        self,
        context: MissionContext,
        stop: int,
        readings_between: int,
        of: LookRound,
        show: Callable[[], None],
        *,
        ties: bool,
    ) -> None:
        """Follow a sweep.

        Args:
            context: what missions work with.
            stop: the number that the head knows it by.
            readings_between: how many there are between two estimates.
            of: which mission and sweep its estimates are of.
            show: lets who looks on see what the readings so far say.
            ties: whether odometry is tied to the map where the robot is found.
        """
        self._context = context
        self._stop = stop
        self._readings_between = readings_between
        self._of = of
        # Without a base there is no odometry that a tie could be made with, nor one to weigh by.
        self._has_base = context.robot.has_base
        self._ties = ties and self._has_base
        self._batches: asyncio.Queue[tuple[RangeReading, ...] | None] = asyncio.Queue()  # bounded by one sweep
        self._batch: list[RangeReading] = []
        self._show = show
        self._taken = 0
        """Readings that the head has."""
        self._shown = 0
        """Quarters of the sweep."""
        self._in_odom = IDENTITY
        """Where odometry put the robot when the sweep began."""
        self._slants: tuple[Slant, ...] = ()
        """What was seen at further tilts, once the sweep is whole."""

    def begun(self, in_odom: Pose2) -> None:
        """Take note of where it begins."""
        self._in_odom = in_odom

    def read(self, reading: RangeReading) -> None:
        """Take a reading."""
        self._batch.append(reading)
        if len(self._batch) == self._readings_between:
            self._flush()

    def end(self, slants: tuple[Slant, ...] = ()) -> None:
        """Say that the sweep is whole, and what was seen at further tilts."""
        self._slants = slants
        if self._batch:
            self._flush()
        self._batches.put_nowait(None)

    def _flush(self) -> None:
        # Put and not awaited: reading goes on at the pace of the laser, however long an estimate takes.
        self._batches.put_nowait(tuple(self._batch))
        self._batch.clear()

    async def run(self) -> PoseEstimate:
        """Narrow down until the sweep is whole; return the last word."""
        while (batch := await self._batches.get()) is not None:
            await self.answer(batch)
        return await self.answer((), final=True)

    async def answer(self, batch: Sequence[RangeReading], *, final: bool = False) -> PoseEstimate:
        """Take more readings; return and publish what all of them say, so far or, of a whole sweep, in the end."""
        slants = self._slants if final else ()
        # By count, failed ones among them: after which reading is estimated must not depend on what was measured.
        readings = tuple(reading for reading in batch if reading.is_measured)
        estimate = self._told(await self._context.head.ask(Narrow(self._stop, readings, now_ns(), final, slants)))
        self._taken += len(batch)
        self._show_quarters(estimate)
        return estimate

    def _show_quarters(self, estimate: PoseEstimate) -> None:
        """Show each quarter of the sweep, and the last when all is said."""
        quarters = _ESTIMATES * self._taken // self._context.settings.sweep.readings
        if estimate.final or self._shown < quarters < _ESTIMATES:
            self._show()
        # Also where nothing was shown: a quarter that came with the one before is not made up for.
        self._shown = quarters

    def _told(self, narrowed: Narrowed) -> PoseEstimate:
        """Learn from an estimate, then tell it, and return it as it was told."""
        estimate, made = narrowed.estimate, narrowed.entry
        if self._has_base:
            # Here: who does array work sees nothing of the whereabouts (decision 30).
            estimate = self._weighed(estimate)
            # The journal has what was told, so the entry that came along will not do.
            made = made if estimate is narrowed.estimate else result_of(estimate)
        if estimate.final and self._ties:
            self._learn(estimate)
        self._context.whereabouts.said(estimate)
        estimate = replace(
            self._context.whereabouts.tied(estimate, self._in_odom),
            mission_id=self._of.mission_id,
            sweep=self._of.sweep,
        )
        self._context.publish(estimate, made)
        return estimate

    def _weighed(self, estimate: PoseEstimate) -> PoseEstimate:
        """Return an estimate as it may be told: who counts wheels knows how far the robot cannot have come."""
        near_m = self._context.settings.judgement.second_look.same_within_m
        return self._context.whereabouts.weighed(estimate, self._in_odom, near_m=near_m)

    def _learn(self, estimate: PoseEstimate) -> None:
        """Let the whereabouts know; what is told apart as two places is not near either."""
        settings = self._context.settings
        near_m = settings.judgement.second_look.same_within_m
        near_rad = settings.localization.heading_error_rad
        self._context.whereabouts.looked(estimate, self._in_odom, near_m=near_m, near_rad=near_rad)


def pose_text(pose: Pose2) -> str:
    """Return a pose for people."""
    return f"({pose.x_m:.3f}, {pose.y_m:.3f}) m, {math.degrees(pose.heading_rad):.1f} deg"
