"""Settings of the three devices, as they stand in the configuration: each is one flat table."""

import math
from dataclasses import dataclass
from typing import Annotated

from robotd.core.bounds import Within, refuse_outside
from robotd.hardware.devices.calibration import (
    Bias,
    CountsPerM,
    CountsPerRad,
    DriveCalibration,
    Farthest,
    HeadMount,
    Nearest,
    Offset,
    RangefinderCalibration,
    Zero,
)
from robotd.hardware.transport.line_format import LineFormat

_U16_MAX = 0xFFFF
_SERVO_ID_MAX = 252
_REPORTS_MISSED = 3
"""So many in a row may be lost before a device is."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PortSettings:
    """How to reach a device, and what is agreed with its board."""

    port: str
    """A device path, best one under ``/dev/serial/by-id``, or ``tcp://host:port``."""
    dialect: str = "board"
    """What the device speaks; ``board`` is the protocol of our own boards."""
    line: str = ""
    """Speed and frame of a serial line, as in ``19200 7E1``; empty for what the dialect is usually set to."""
    telemetry_ms: Annotated[int, Within(5, 250, "ms")] = 40
    """Period of the telemetry [ms]; set-points follow it."""
    ttl_max_ms: Annotated[int, Within(10, _U16_MAX, "ms")] = 500
    """Longest time for which the board may go on with a motion without hearing from us [ms]."""
    silence_s: Annotated[float, Within(0.3, 60.0, "s")] = 1.0
    """A device that reports by itself is lost when nothing came of it for so long; one that only answers is asked. A
    base in motion is stopped sooner, by ``driving.silence_s``."""

    def __post_init__(self) -> None:
        """Refuse what no line and no board can do."""
        if not self.port:
            raise ValueError("port must not be empty")
        if self.line:
            LineFormat.parse(self.line)
        refuse_outside(self)
        if self.silence_s * 1000.0 < _REPORTS_MISSED * self.telemetry_ms:
            raise ValueError(
                f"silence_s must be at least {_REPORTS_MISSED} times telemetry_ms, got {self.silence_s} s"
                f" and {self.telemetry_ms} ms"
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveSettings(PortSettings):
    """The synchro-drive base."""

    port: str = "/dev/robotd/drive"
    """A device path, best one under ``/dev/serial/by-id``, or ``tcp://host:port``."""
    counts_per_m: CountsPerM = 27_300.0
    """Translation encoder counts per metre; negative if it counts backwards."""
    counts_per_rad: CountsPerRad = 4_096.0
    """Rotation encoder counts per radian counter-clockwise; negative if it counts clockwise."""
    battery_min_v: Annotated[float, Within(0.0, 100.0, "V")] = 0.0
    """Below this voltage, as measured in motion, the robot stops and a fault is latched; 0 for never."""

    def __post_init__(self) -> None:
        """Refuse what the port or the calibration refuses."""
        PortSettings.__post_init__(self)

    @property
    def calibration(self) -> DriveCalibration:
        """The scales."""
        return DriveCalibration(self.counts_per_m, self.counts_per_rad)


@dataclass(frozen=True, slots=True, kw_only=True)
class PanTiltSettings(PortSettings):
    """The pan/tilt unit."""

    port: str = "/dev/robotd/pantilt"
    """A device path, best one under ``/dev/serial/by-id``, or ``tcp://host:port``."""
    ttl_max_ms: Annotated[int, Within(10, _U16_MAX, "ms")] = 30_000
    """Longest time that one turn of the head may take [ms]."""
    pan_id: Annotated[int, Within(0, _SERVO_ID_MAX)] = 1
    """Bus id of the pan servo, where the head is made of two."""
    tilt_id: Annotated[int, Within(0, _SERVO_ID_MAX)] = 2
    """Bus id of the tilt servo, where the head is made of two."""
    pan_min_rad: Annotated[float, Within(-math.pi, math.pi, "rad")] = -math.pi
    """Where a head without a motor is not asked to look: to the right of this, seen from the robot's heading."""
    pan_max_rad: Annotated[float, Within(-math.pi, math.pi, "rad")] = math.pi
    """Where a head without a motor is not asked to look: to the left of this, seen from the robot's heading."""
    x_m: Offset = 0.0
    """Pan axis in the robot frame, ahead of the centre."""
    y_m: Offset = 0.0
    """Pan axis in the robot frame, to the left of the centre."""
    pan_zero_rad: Zero = 0.0
    """Added to the pan that the head reads back, to get the angle from the robot's heading."""
    tilt_zero_rad: Zero = 0.0
    """Added to the tilt that the head reads back, to get the angle up from level."""

    def __post_init__(self) -> None:
        """Refuse what the port, the bus or the mount refuses."""
        PortSettings.__post_init__(self)
        if self.pan_id == self.tilt_id:
            raise ValueError(f"tilt_id must differ from pan_id, got {self.tilt_id} twice")
        if not self.pan_min_rad < self.pan_max_rad:
            raise ValueError(f"pan_min_rad must be less than pan_max_rad, got {self.pan_min_rad}, {self.pan_max_rad}")

    @property
    def mount(self) -> HeadMount:
        """Where the head sits."""
        return HeadMount(self.x_m, self.y_m, self.pan_zero_rad, self.tilt_zero_rad)


@dataclass(frozen=True, slots=True, kw_only=True)
class RangefinderSettings(PortSettings):
    """The laser rangefinder."""

    port: str = "/dev/robotd/rangefinder"
    """A device path, best one under ``/dev/serial/by-id``, or ``tcp://host:port``."""
    device_id: Annotated[int, Within(0, 9)] = 0
    """Which device on the line, where several can share one: the switch on a Dimetix, 0 to 9."""
    range_bias_m: Bias = 0.0
    """Added to every range along the beam."""
    range_min_m: Nearest = 0.3
    """Shortest range along the beam that the instrument measures rightly; LILY's is 0.3 m."""
    range_max_m: Farthest = 6.0
    """Cut-off: what is horizontally farther than this counts as not met; LILY's is 6 m."""

    def __post_init__(self) -> None:
        """Refuse what the port or the calibration refuses."""
        PortSettings.__post_init__(self)
        _ = self.calibration

    @property
    def calibration(self) -> RangefinderCalibration:
        """What the instrument can be believed."""
        return RangefinderCalibration(self.range_bias_m, self.range_min_m, self.range_max_m)
