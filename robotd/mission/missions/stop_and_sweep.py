"""Stand still, look all the way round, and hand back the readings of this stop.

One reading is: aim, wait for *motion done*, shoot. A head that cannot pan a full circle takes the sweep in parts,
and the base turns between them; all readings end up in the frame of where the robot stood first.
"""

import math
from collections.abc import AsyncGenerator, Callable, Sequence
from contextlib import aclosing
from dataclasses import dataclass, field, replace
from typing import NamedTuple, Protocol

from robotd.core.angles import wrap_rad
from robotd.core.clock import now_ns
from robotd.core.errors import MissionError
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Slant, Sweep, Tilt, goes_clockwise
from robotd.hardware.devices.calibration import HeadMount, RangefinderCalibration
from robotd.hardware.devices.pantilt import PanTiltLimits
from robotd.hardware.devices.reading_in_robot import reading_in_robot
from robotd.mission.missions.sweep_plan import SweepPart, plan_sweep
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.mission.motion.legs import rotate_to, settle
from robotd.mission.motion.steering import DrivingSettings
from robotd.mission.safety.hold import Hold
from robotd.mission.three_devices import Robot

FAILED = frozenset(
    {
        ReadingStatus.WEAK,
        ReadingStatus.SATURATED,
        ReadingStatus.AMBIENT,
        ReadingStatus.TIMEOUT,
        ReadingStatus.DEVICE_ERROR,
    }
)
"""Readings that the rangefinder owes; a miss, and what it cannot see, are answers."""
_LIMIT_MARGIN_RAD = 0.03  # the base turns only roughly as far as it should, and the head makes up for it
_TURNS = 5
"""So often the base is turned before it is given up: a set-point that comes late lets it turn on meanwhile."""


class SweepListener(Protocol):
    """Follows a sweep while it is taken."""

    def begun(self, in_odom: Pose2) -> None:
        """Hear that the robot stands, and where by odometry: the frame of all readings."""

    def read(self, reading: RangeReading) -> None:
        """Take a reading, as it is made."""


class Wanted(NamedTuple):
    """Bearings that are wanted next."""

    part: int
    """Of which part of the sweep they are."""
    bearings_rad: tuple[float, ...]


Wants = Callable[[tuple[SweepPart, ...]], AsyncGenerator[Wanted, None]]
"""Is given the parts of a sweep, and wants some bearings after the other; it goes on when those are read."""


@dataclass(frozen=True, slots=True)
class _Taken:
    """The readings of a sweep so far."""

    start: Odometry
    listeners: Sequence[SweepListener]
    readings: list[RangeReading] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Tell that it begins."""
        for listener in self.listeners:
            listener.begun(self.start.in_odom)

    def add(self, reading: RangeReading) -> None:
        """Take a reading, and tell of it."""
        self.readings.append(reading)
        for listener in self.listeners:
            listener.read(reading)


@dataclass(frozen=True, slots=True)
class Sweeper:
    """Takes sweeps with one robot."""

    robot: Robot
    mount: HeadMount
    calibration: RangefinderCalibration
    settings: SweepSettings
    driving: DrivingSettings
    hold: Hold

    async def sweep(
        self, number: int, *listeners: SweepListener, base_turns: bool = True, tilts: Sequence[Tilt] = ()
    ) -> Sweep:
        """Take sweep ``number`` here, and look round at further tilts.

        Without a base, or if it is not to turn, only the directions are read that the head reaches by itself.
        Listeners follow the first look round.

        Raises:
            MissionError: the head pans too little, or too many readings failed; the robot stands, and the laser is off.
            DeviceError, LinkTimeout, TransportError: a device failed. The caller must stop the robot, which also
                switches the laser off: a device that failed cannot be trusted to do it by itself.
        """
        parts = self._parts(await self.robot.pantilt.limits(), number)
        if not (base_turns and self.robot.has_base):
            parts = parts[:1]
        start = await self.hold.through(lambda: standing(self.robot, self.settings.settle_s, self.driving))
        taken, slanted = _Taken(start, listeners), [(self.tilted(tilt), tilt, _Taken(start, ())) for tilt in tilts]
        for part in parts:
            here, clockwise = await self._turn_base(start, part), goes_clockwise(number)
            await self.take(part.bearings_rad, here, taken, clockwise=clockwise)
            for sweeper, _, seen in slanted:
                # There and back, and all tilts before the base turns on.
                clockwise = not clockwise
                in_order = sorted(part.bearings_rad, reverse=clockwise)
                await sweeper.take(in_order, here, seen, clockwise=clockwise)
        slants = tuple(Slant(tilt, tuple(seen.readings)) for _, tilt, seen in slanted)
        return Sweep(number, start.in_odom, tuple(taken.readings), slants)

    def tilted(self, tilt: Tilt) -> "Sweeper":
        """Return what looks at a further tilt with the same robot."""
        settings = replace(self.settings, tilt_rad=tilt.tilt_rad)
        return replace(self, settings=settings, calibration=replace(self.calibration, range_max_m=tilt.cut_off_m))

    async def look(self, number: int, wants: Wants, *listeners: SweepListener) -> Sweep:
        """Take of sweep ``number`` what is wanted, some bearings at a time, until it wants no more.

        Raises: as :meth:`sweep`.
        """
        parts = self._parts(await self.robot.pantilt.limits(), number)
        parts = parts if self.robot.has_base else parts[:1]
        start = await self.hold.through(lambda: standing(self.robot, self.settings.settle_s, self.driving))
        taken, here, current = _Taken(start, listeners), start, 0
        clockwise = goes_clockwise(number)
        async with aclosing(wants(parts)) as wanted:
            async for bearings in wanted:
                if bearings.part != current:
                    here, current = await self._turn_base(start, parts[bearings.part]), bearings.part
                # There and back: a head that does not turn without end would go back all the way for nothing.
                in_order = sorted(bearings.bearings_rad, reverse=clockwise)
                await self.take(in_order, here, taken, clockwise=clockwise)
                clockwise = not clockwise
        return Sweep(number, start.in_odom, tuple(taken.readings))

    async def take(self, bearings_rad: Sequence[float], here: Odometry, taken: "_Taken", *, clockwise: bool) -> None:
        """Read at bearings that follow each other in one sense, from where the base stands now."""
        await self.robot.rangefinder.switch_laser(on=True)
        # By odometry, not by plan: the base turns only roughly as far as it should.
        turned_rad = wrap_rad(here.in_odom.heading_rad - taken.start.in_odom.heading_rad)
        lag_rad = self._lag_rad(clockwise=clockwise)
        await self._take_up_play(bearings_rad[0] - turned_rad, lag_rad)
        for bearing_rad in bearings_rad:
            taken.add(await self._read_through_holds(bearing_rad - turned_rad, lag_rad, taken.start, here))
            await self._check_enough(taken.readings)
        await self.robot.rangefinder.switch_laser(on=False)

    async def glance(self, bearings_rad: Sequence[float], *, clockwise: bool = False) -> tuple[RangeReading, ...]:
        """Take a few readings where the robot stands, given ascending; what is beyond the head's reach is left out.

        Who looks again and again does so there and back, or the head turns all the way for nothing.

        Raises:
            MissionError: too many of them failed, as of a sweep; the robot stands.
            DeviceError, LinkTimeout, TransportError: as :meth:`sweep`.
        """
        limits = await self.robot.pantilt.limits()
        lag_rad = self._lag_rad(clockwise=clockwise)
        in_order = reversed(bearings_rad) if clockwise else bearings_rad
        seen_rad = [rad for rad in in_order if limits.pan_min_rad <= rad - lag_rad <= limits.pan_max_rad]
        start = await self.hold.through(lambda: standing(self.robot, self.settings.settle_s, self.driving))
        await self.robot.rangefinder.switch_laser(on=True)
        await self._take_up_play(seen_rad[0], lag_rad)
        readings = [await self._read_through_holds(rad, lag_rad, start, start) for rad in seen_rad]
        await self.robot.rangefinder.switch_laser(on=False)
        _check_answered(readings, len(readings), self.settings.readings_min_share)
        return tuple(readings)

    async def within_reach(self, bearings_rad: Sequence[float]) -> tuple[float, ...]:
        """Return those of some bearings that the head pans to by itself."""
        limits = await self.robot.pantilt.limits()
        return tuple(rad for rad in bearings_rad if limits.pan_min_rad <= rad <= limits.pan_max_rad)

    async def read_on_the_way(self, bearing_rad: float) -> RangeReading:
        """Take one reading while the robot drives, the light being on, in the frame of where the robot is then.

        The play of the head's gears is left out: nothing is laid into a map by it.

        Raises:
            DeviceError, LinkTimeout, TransportError: as :meth:`sweep`.
        """
        here = Odometry(now_ns(), IDENTITY, STANDSTILL)
        return await self._read(bearing_rad, 0.0, here, here)

    def _parts(self, limits: PanTiltLimits, number: int) -> tuple[SweepPart, ...]:
        margin_rad = _LIMIT_MARGIN_RAD + self.mount.backlash_rad
        try:
            return plan_sweep(
                self.settings.readings,
                max(limits.pan_min_rad + margin_rad, -math.pi),
                min(limits.pan_max_rad - margin_rad, math.pi),
                clockwise=goes_clockwise(number),
            )
        except ValueError as error:
            raise MissionError(f"the head cannot look round: {error}") from error

    def _lag_rad(self, *, clockwise: bool) -> float:
        """Return how far the beam points behind what the head reads back while it pans in a sense."""
        # Half to each side: the zero of the head was found in the middle between both senses.
        half_rad = self.mount.backlash_rad / 2.0
        return half_rad if clockwise else -half_rad

    async def _take_up_play(self, pan_rad: float, lag_rad: float) -> None:
        """Let the head begin from so far before the first bearing that its gears bear when it gets there."""
        if self.mount.backlash_rad:
            before_rad = pan_rad + 2.0 * lag_rad
            timeout_s = self.settings.aim_timeout_s
            await self.hold.through(
                lambda: self.robot.pantilt.aim(before_rad, self.settings.tilt_rad, timeout_s=timeout_s)
            )

    async def _check_enough(self, readings: list[RangeReading]) -> None:
        # Against the whole sweep, not the readings so far: a bad beginning may still come to a good sweep.
        try:
            _check_answered(readings, self.settings.readings, self.settings.readings_min_share)
        except MissionError:
            await self.robot.rangefinder.switch_laser(on=False)
            raise

    async def _turn_base(self, start: Odometry, part: SweepPart) -> Odometry:
        if part.base_turn_rad == 0.0:
            return start
        return await self.hold.through(lambda: self._turn_to(start.in_odom.heading_rad + part.base_turn_rad))

    async def _turn_to(self, heading_rad: float) -> Odometry:
        for _ in range(_TURNS):
            await rotate_to(self.robot.drive, heading_rad, self.driving, self.hold)
            here = await settle(self.robot.drive, self.settings.settle_s, self.driving)
            off_rad = wrap_rad(here.in_odom.heading_rad - heading_rad)
            # Farther off than the head can make up for, it would be asked to pan beyond its limits.
            if abs(off_rad) <= _LIMIT_MARGIN_RAD:
                return here
        raise MissionError(
            f"the base stands {math.degrees(off_rad):.1f} degrees off what it was to turn to, after {_TURNS} turns;"
            f" the head makes up for {math.degrees(_LIMIT_MARGIN_RAD):.1f}"
        )

    async def _read_through_holds(
        self, pan_rad: float, lag_rad: float, start: Odometry, here: Odometry
    ) -> RangeReading:
        holds = self.hold.count

        async def read() -> RangeReading:
            if self.hold.count != holds:
                await self.robot.rangefinder.switch_laser(on=True)  # the stop put it out
            return await self._read(pan_rad, lag_rad, start, here)

        return await self.hold.through(read)

    async def _read(self, pan_rad: float, lag_rad: float, start: Odometry, here: Odometry) -> RangeReading:
        aim = await self.robot.pantilt.aim(pan_rad, self.settings.tilt_rad, timeout_s=self.settings.aim_timeout_s)
        # Only after the head has said that it rests: a shot on the way has a range and no direction.
        shot = await self.robot.rangefinder.shoot(timeout_s=self.settings.shot_timeout_s)
        # What is read back is the motor's side of the gears; the beam is on the other, behind by the play.
        aim = replace(aim, pan_rad=aim.pan_rad + lag_rad)
        # The last argument is where the robot stands now, seen from where it stood first.
        return reading_in_robot(self.mount, self.calibration, aim, shot, start.in_odom.inverse() @ here.in_odom)


def _check_answered(readings: Sequence[RangeReading], of: int, min_share: float) -> None:
    """Refuse readings of which too many failed."""
    failed = sum(reading.status in FAILED for reading in readings)
    if of - failed < min_share * of:
        last = readings[-1].status
        raise MissionError(f"the rangefinder failed at {failed} of {len(readings)} readings, the last was {last}")


async def standing(robot: Robot, settle_s: float, driving: DrivingSettings) -> Odometry:
    """Wait until the robot stands still, and return its odometry; without a base, the last that was known of it.

    Raises:
        LinkTimeout, DeviceError: as :func:`settle`.
    """
    if robot.has_base:
        return await settle(robot.drive, settle_s, driving)
    return robot.drive.odometry.latest or Odometry(now_ns(), IDENTITY, STANDSTILL)


def faults_text(sweep: Sweep) -> str:
    """Say how many readings of a sweep failed; empty if none did."""
    readings = [*sweep.readings, *(reading for slant in sweep.slants for reading in slant.readings)]
    failed = sum(reading.status in FAILED for reading in readings)
    return f"{failed} of {len(readings)} readings failed" if failed else ""
