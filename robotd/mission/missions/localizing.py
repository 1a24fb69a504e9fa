"""Where am I? Sweep here, and narrow the feasible poses down reading by reading, while the sweep goes on.

Readings go to the head in batches of a fixed count, so what is estimated after which reading never depends
on how fast this machine happens to be.
"""

import asyncio
import math

from robotd.contract.estimate import PoseEstimate
from robotd.contract.events import MissionPhase
from robotd.contract.missions import Localize, PriorHeading
from robotd.core.angles import wrap_rad
from robotd.core.clock import now_ns
from robotd.core.errors import MissionError
from robotd.core.pose import Odometry, Pose2
from robotd.core.reading import RangeReading
from robotd.head.jobs import Narrow, Prepare
from robotd.mission.missions.context import MissionContext, Reporter
from robotd.mission.missions.stop_and_sweep import faults_text, standing
from robotd.mission.whereabouts.map_in_use import MapInUse
from robotd.recording.results import result_of

_BATCH = 20
"""Readings between two estimates while the heading is known and readings are counted as they come."""
_ESTIMATES = 4
"""How often a sweep is searched while the heading is not: at each quarter, whatever its number of readings."""


async def run_localizing(
    context: MissionContext, place: MapInUse, mission: Localize, report: Reporter, number: int
) -> PoseEstimate:
    """Carry out a :class:`Localize`: sweep, estimate, and tie odometry to the map if the answer is unique."""
    settings = context.settings
    here = await context.hold.through(lambda: standing(context.robot, settings.sweep.settle_s, settings.driving))
    headings_rad = _headings(context, mission, here)
    report.at(MissionPhase.SWEEPING)
    stop = context.head.number()
    try:
        await context.head.ask(Prepare(stop, place.ref, place.map_id, headings_rad, mission.within))
        narrowing = Narrowing(context, stop, _between(context, mission))
        estimate, in_odom = await _looked_round(context, report, narrowing, number)
    finally:
        context.head.forget(stop)
    # Without a base there is no odometry that a tie could be made with.
    if mission.tie and context.robot.has_base:
        _learn(context, in_odom, estimate)
    return estimate


async def _looked_round(
    context: MissionContext, report: Reporter, narrowing: "Narrowing", number: int
) -> tuple[PoseEstimate, Pose2]:
    """Sweep, narrow down meanwhile, and return the last word, and where odometry put the robot."""
    narrowed = asyncio.create_task(narrowing.run(), name="narrowing")
    try:
        sweep = await context.sweep(number, narrowing.offer)
        report.at(MissionPhase.COMPUTING, message=faults_text(sweep))
        narrowing.end(sweep.in_odom)
        return await narrowed, sweep.in_odom
    finally:
        # Whatever ended the sweep: a task is not left behind by its owner.
        narrowed.cancel()
        await asyncio.wait((narrowed,))


def _learn(context: MissionContext, in_odom: Pose2, estimate: PoseEstimate) -> None:
    """Let the whereabouts know; what is told apart as two places is not near either."""
    near_m = context.settings.judgement.second_look.same_within_m
    near_rad = context.settings.localization.heading_error_rad
    context.whereabouts.looked(estimate, in_odom, near_m=near_m, near_rad=near_rad)


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


class Narrowing:
    """A sweep under way: takes readings as they come, publishes estimates as they firm up."""

    def __init__(self, context: MissionContext, stop: int, readings_between: int) -> None:
        self._context = context
        self._stop = stop
        self._readings_between = readings_between
        self._batches: asyncio.Queue[tuple[RangeReading, ...] | None] = asyncio.Queue()  # bounded by one sweep
        self._batch: list[RangeReading] = []
        self._in_odom: Pose2 | None = None

    def offer(self, reading: RangeReading) -> None:
        """Take a reading."""
        self._batch.append(reading)
        if len(self._batch) == self._readings_between:
            self._flush()

    def end(self, in_odom: Pose2) -> None:
        """Say that the sweep is whole, and where odometry put the robot when it began."""
        self._in_odom = in_odom
        if self._batch:
            self._flush()
        self._batches.put_nowait(None)

    def _flush(self) -> None:
        self._batches.put_nowait(tuple(self._batch))
        self._batch.clear()

    async def run(self) -> PoseEstimate:
        """Narrow down until the sweep is whole; return the last word."""
        while True:
            batch = await self._batches.get()
            final = batch is None
            readings = tuple(reading for reading in batch or () if reading.is_measured)
            narrowed = await self._context.head.ask(Narrow(self._stop, readings, now_ns(), final))
            estimate, made = narrowed.estimate, narrowed.entry
            # Here: who does array work sees nothing of the whereabouts (decision 30).
            told = self._weighed(estimate)
            # The journal has what was told, so the entry that came along will not do.
            if told is not estimate:
                estimate, made = told, result_of(told)
            self._context.whereabouts.said(estimate)
            self._context.publish(estimate, made)
            if final:
                return estimate

    def _weighed(self, estimate: PoseEstimate) -> PoseEstimate:
        """Return a final estimate as it may be told: who counts wheels knows how far the robot cannot have come."""
        if self._in_odom is None or not estimate.final or not self._context.robot.has_base:
            return estimate
        near_m = self._context.settings.judgement.second_look.same_within_m
        return self._context.whereabouts.weighed(estimate, self._in_odom, near_m=near_m)


def pose_text(pose: Pose2) -> str:
    """Return a pose for people."""
    return f"({pose.x_m:.3f}, {pose.y_m:.3f}) m, {math.degrees(pose.heading_rad):.1f} deg"
