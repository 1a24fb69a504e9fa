"""A look ahead while the robot drives: the head goes to and fro over its breadth until something is in the way.

The map has the leg free, and a look before it found nothing; so what is met now came since. Two readings that agree,
one after the other, stop the robot: one in twenty is wrong.
"""

import asyncio
import itertools
from collections.abc import Sequence
from dataclasses import dataclass

from robotd.contract.ways import Point
from robotd.core.errors import MissionError
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading
from robotd.exploring.ahead import head_m, in_the_way, is_same
from robotd.mission.missions.context import MissionContext
from robotd.mission.missions.stop_and_sweep import FAILED
from robotd.mission.motion.legs import drive_leg
from robotd.mission.motion.steering import DrivingSettings, distance_left_m

_REACTION_S = 1.0
"""What may pass from when something can be seen until the robot brakes: the head comes round, and looks twice."""
_BLIND = 10
"""After this many failed readings in a row the robot does not see where it drives."""


def reach_m(driving: DrivingSettings) -> float:
    """Return how far before its front the robot must see to come to a stand before what it sees."""
    braking_m = driving.speed_mps**2 / (2.0 * driving.deceleration_mps2)
    return braking_m + driving.speed_mps * _REACTION_S


async def drive_watching(context: MissionContext, end_m: Point, bearings_rad: Sequence[float]) -> Point | None:
    """Drive one leg; return where something was met in the way, None if the end was reached.

    The robot stands in either case.

    Args:
        context: the mission's.
        end_m: where to go, ``odom`` frame, as what is returned.
        bearings_rad: where to look, over and over; nowhere, where the head does not pan ahead.

    Raises:
        MissionError: the rangefinder does not answer; the robot stands.
        DeviceError, LinkTimeout, TransportError: a device failed, the head or the laser among them.
        Interrupted: the mission was held meanwhile.
    """
    if not bearings_rad:
        await drive_leg(context.robot.drive, *end_m, context.settings.driving, context.hold)
        return None
    watch = _Watch(context, end_m)
    looking = asyncio.create_task(watch.look(bearings_rad), name="look ahead")
    try:
        # Also where it fails: nothing drives on with its eyes closed.
        await drive_leg(context.robot.drive, *end_m, context.settings.driving, context.hold, unless=looking.done)
        watch.is_over = True
        # To its end, and not cancelled: an answer that nobody waits for would be in the way of the next reading.
        return await looking
    finally:
        looking.cancel()
        # With its result, for nobody asks for that where the leg fails at the same moment.
        await asyncio.gather(looking, return_exceptions=True)


@dataclass(slots=True)
class _Watch:
    context: MissionContext
    end_m: Point
    is_over: bool = False
    """Whether the robot has arrived."""
    failed: int = 0
    """Readings in a row."""

    async def look(self, bearings_rad: Sequence[float]) -> Point | None:
        """Read at some bearings, over and over, until something is in the way or the leg is over."""
        laser = self.context.robot.rangefinder
        there_and_back = (*bearings_rad, *reversed(bearings_rad[1:-1]))
        for number in itertools.count():
            # Each time round, as of a robot that has moved: a scanner would tell of the first look for ever.
            if number % len(there_and_back) == 0:
                await laser.switch_laser(on=True)
            met_m = await self._met_m(there_and_back[number % len(there_and_back)])
            if met_m is not None or self.is_over:
                await laser.switch_laser(on=False)
                return met_m
        raise AssertionError("counting never ends")

    async def _met_m(self, bearing_rad: float) -> Point | None:
        """Return what is in the way at a bearing, ``odom`` frame, if a second reading confirms it."""
        first = await self._in_the_way(bearing_rad)
        second = None if first is None else await self._in_the_way(bearing_rad)
        return second if first is not None and second is not None and is_same(first, second) else None

    async def _in_the_way(self, bearing_rad: float) -> Point | None:
        reading = await self.context.sweeper.read_on_the_way(bearing_rad)
        self.failed = self.failed + 1 if reading.status in FAILED else 0
        if self.failed == _BLIND:
            raise MissionError(
                f"the rangefinder failed {_BLIND} times in a row while the robot drove: {reading.status}"
            )
        now = self.context.robot.drive.odometry.latest
        assert now is not None  # it drives by nothing else
        return self._judged(reading, now.in_odom)

    def _judged(self, reading: RangeReading, in_odom: Pose2) -> Point | None:
        settings = self.context.settings
        left_m = max(0.0, distance_left_m(in_odom, *self.end_m))
        # Farther on there is time: what walks there may have gone by then.
        ahead_m = min(left_m, reach_m(settings.driving))
        met = in_the_way((reading,), ahead_m, settings.planning.robot_radius_m)
        return None if met is None else in_odom.transform(*head_m(met))
