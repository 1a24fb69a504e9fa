"""Stand still, look all the way round, and hand back the readings of this stop.

One reading is: aim, wait for *motion done*, shoot. A head that cannot pan a full circle takes the sweep in parts,
and the base turns between them; all readings end up in the frame of where the robot stood first.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

from robotd.core.angles import wrap_rad
from robotd.core.pose import Odometry
from robotd.core.reading import RangeReading, Sweep
from robotd.hardware.devices.calibration import HeadMount, RangefinderCalibration, reading_in_robot
from robotd.mission.motion import rotate_to, settle
from robotd.mission.robot import Robot
from robotd.mission.steering import DrivingSettings
from robotd.mission.sweep_plan import SweepPart, plan_sweep

_LIMIT_MARGIN_RAD = 0.03  # the base turns only roughly as far as it should, and the head makes up for it


@dataclass(frozen=True, slots=True)
class SweepSettings:
    """How a sweep is taken."""

    readings: int = 300
    """Readings evenly round the robot."""
    tilt_rad: float = 0.0
    """Tilt of the beam, up from level; LILY slanted hers to the floor 2 m ahead. The cut-off (``range_max_m``) must lie
    before the floor, or the floor is taken for walls."""
    settle_s: float = 0.2
    """Odometry must report standstill for so long before the first reading."""
    aim_timeout_s: float = 5.0
    """Longest time one turn of the head may take."""
    shot_timeout_s: float = 1.0
    """Longest time one measurement may take."""

    def __post_init__(self) -> None:
        """Refuse what cannot be swept."""
        if not 1 <= self.readings <= 10_000:
            raise ValueError(f"readings must be 1 to 10000, got {self.readings}")
        for name in ("settle_s", "aim_timeout_s", "shot_timeout_s"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} must be positive, got {getattr(self, name)}")
        if not -1.4 <= self.tilt_rad <= 1.4:
            raise ValueError(f"tilt_rad must be within +-1.4, got {self.tilt_rad}")


@dataclass(frozen=True, slots=True)
class Sweeper:
    """Takes sweeps with one robot."""

    robot: Robot
    mount: HeadMount
    calibration: RangefinderCalibration
    settings: SweepSettings
    driving: DrivingSettings

    async def sweep(self, number: int, on_reading: Callable[[RangeReading], None]) -> Sweep:
        """Take sweep ``number`` here; ``on_reading`` sees each reading as it is made.

        Raises:
            DeviceError, LinkTimeout, TransportError: a device failed. The caller must stop the robot, which also
                switches the laser off: a device that failed cannot be trusted to do it by itself.
        """
        limits = await self.robot.pantilt.limits()
        parts = plan_sweep(
            self.settings.readings,
            max(limits.pan_min_rad + _LIMIT_MARGIN_RAD, -math.pi),
            min(limits.pan_max_rad - _LIMIT_MARGIN_RAD, math.pi),
            clockwise=number % 2 == 1,
        )
        start = await settle(self.robot.drive, self.settings.settle_s, self.driving)
        readings: list[RangeReading] = []
        await self.robot.rangefinder.switch_laser(on=True)
        for part in parts:
            here = await self._turn_base(start, part)
            turned_rad = wrap_rad(here.in_odom.heading_rad - start.in_odom.heading_rad)
            for bearing_rad in part.bearings_rad:
                reading = await self._read(bearing_rad - turned_rad, start, here)
                readings.append(reading)
                on_reading(reading)
        await self.robot.rangefinder.switch_laser(on=False)
        return Sweep(number, start.in_odom, tuple(readings))

    async def _turn_base(self, start: Odometry, part: SweepPart) -> Odometry:
        if part.base_turn_rad == 0.0:
            return start
        await rotate_to(self.robot.drive, start.in_odom.heading_rad + part.base_turn_rad, self.driving)
        return await settle(self.robot.drive, self.settings.settle_s, self.driving)

    async def _read(self, pan_rad: float, start: Odometry, here: Odometry) -> RangeReading:
        aim = await self.robot.pantilt.aim(pan_rad, self.settings.tilt_rad, timeout_s=self.settings.aim_timeout_s)
        shot = await self.robot.rangefinder.shoot(timeout_s=self.settings.shot_timeout_s)
        return reading_in_robot(self.mount, self.calibration, aim, shot, start.in_odom.inverse() @ here.in_odom)
