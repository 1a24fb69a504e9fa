"""A look round that takes no more readings than it needs: to all sides, until two answers in a row agree.

While a few places are left, half of the readings go where these expect different ranges; the rest to all sides as
before, for the place may be none of them.
"""

from collections.abc import AsyncGenerator, Sequence
from typing import Protocol

from robotd.contract.estimate import PoseEstimate, Region
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading
from robotd.head.jobs import ChooseBearings, MapRef
from robotd.mission.missions.context import MissionContext
from robotd.mission.missions.stop_and_sweep import Wanted
from robotd.mission.missions.sweep_plan import SweepPart
from robotd.sensing.spread import spread_order
from robotd.sensing.until_sure import UntilSure

_RIVALS_MAX = 16
"""Of more places no bearing tells many apart; more readings to all sides do."""
_LEAST_BELIEF = 0.01
"""Of a place that the second look did not look at: it counts a little, too."""


class Answers(Protocol):
    """Says what readings come to."""

    def begun(self, in_odom: Pose2) -> None:
        """Hear where odometry puts the robot."""

    async def answer(self, batch: Sequence[RangeReading]) -> PoseEstimate:
        """Take more readings, and say what all of them come to."""


class LookingUntilSure:
    """Says which bearings are wanted next, by what the readings so far say."""

    def __init__(self, context: MissionContext, on: MapRef, answers: Answers) -> None:
        """Look round on a map."""
        same = context.settings.judgement.second_look
        self._context = context
        self._map = on
        self._answers = answers
        self._until = UntilSure(same.same_within_m, same.same_within_rad)
        self._batch: list[RangeReading] = []
        self._told_apart_rad: list[float] = []
        """Bearings that were chosen because rivals differ there."""

    def begun(self, in_odom: Pose2) -> None:
        """Take note of where it begins."""
        self._answers.begun(in_odom)

    def read(self, reading: RangeReading) -> None:
        """Take a reading."""
        self._batch.append(reading)
        if reading.is_measured:
            self._until.measured(reading.bearing_rad)

    async def wanted(self, parts: tuple[SweepPart, ...]) -> AsyncGenerator[Wanted, None]:
        """Want bearings until it is sure, or all of the sweep is taken."""
        bearings_rad = parts[0].bearings_rad
        # In this order any beginning of the list goes about evenly all round, so stopping early leaves no blind
        # side.
        left = list(spread_order(len(bearings_rad)))
        rivals: tuple[Region, ...] = ()
        while left:
            count = self._until.wanted(len(bearings_rad) - len(left))
            # Half at most: rivals are what is known so far, and the true place may be none of them.
            telling = await self._telling(rivals, [bearings_rad[number] for number in left], count // 2)
            chosen = [left[at] for at in telling]
            chosen += [number for number in left if number not in chosen][: count - len(chosen)]
            left = [number for number in left if number not in chosen]
            yield Wanted(0, tuple(bearings_rad[number] for number in chosen))
            estimate = await self._answered()
            if self._until.is_sure:
                return
            rivals = estimate.regions
        # What the head does not reach by itself: the base turns, so it is taken in one go.
        for number, part in enumerate(parts[1:], start=1):
            yield Wanted(number, part.bearings_rad)
            await self._answered()

    async def _answered(self) -> PoseEstimate:
        batch = tuple(self._batch)
        self._batch.clear()
        estimate = await self._answers.answer(batch)
        self._until.answered(estimate)
        return estimate

    async def _telling(self, rivals: Sequence[Region], bearings_rad: Sequence[float], count: int) -> tuple[int, ...]:
        """Return the numbers of bearings at which rivals differ."""
        if not 2 <= len(rivals) <= _RIVALS_MAX or count == 0:
            return ()
        believed = tuple((region.pose, max(region.belief, _LEAST_BELIEF)) for region in rivals)
        cutoff_m = self._context.settings.rangefinder.range_max_m
        chosen = await self._context.head.ask(
            ChooseBearings(self._map, believed, tuple(bearings_rad), tuple(self._told_apart_rad), count, cutoff_m)
        )
        self._told_apart_rad += [bearings_rad[at] for at in chosen]
        return chosen
