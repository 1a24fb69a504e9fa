"""Settings of the three devices, as they stand in the configuration: each is one flat table.

What every dialect of a device has is here, and what several share; a dialect adds its own options beside its adapter.
"""

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
    Height,
    Nearest,
    Offset,
    Play,
    RangefinderCalibration,
    Reach,
    Zero,
)
from robotd.hardware.transport.line_format import LineFormat

U16_MAX = 0xFFFF
_REPORTS_MISSED = 3
"""This many in a row may be lost before a device is."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PortSettings:
    """How to reach a device; what its dialect alone knows stands beside the adapter of the dialect."""

    port: str
    """A device path, best one under ``/dev/serial/by-id``, or ``tcp://host:port``."""
    dialect: str = "board"
    """What the device speaks; ``board`` is the protocol of our own boards."""
    line: str = ""
    """Speed and frame of a serial line, as in ``19200 7E1``; empty for what the dialect is usually set to."""

    def __post_init__(self) -> None:
        """Refuse what no line can do."""
        if not self.port:
            raise ValueError("port must not be empty")
        if self.line:
            LineFormat.parse(self.line)
        refuse_outside(self)


@dataclass(frozen=True, kw_only=True)
class SilenceOptions:
    """What is asked of a device that reports by itself, whatever it is."""

    silence_s: Annotated[float, Within(0.3, 60.0, "s")] = 1.0
    """A device that reports by itself is lost when nothing came of it for so long; one that only answers is asked. A
    base in motion is stopped sooner, by ``driving.silence_s``."""


@dataclass(frozen=True, kw_only=True)
class ReportOptions(SilenceOptions):
    """What is asked of a device that reports as often as it is told."""

    telemetry_ms: Annotated[int, Within(5, 250, "ms")] = 40
    """Period of the telemetry [ms]; set-points follow it."""

    def refuse_short_silence(self) -> None:
        """Raise ValueError if some reports in a row cannot be lost."""
        if self.silence_s * 1000.0 < _REPORTS_MISSED * self.telemetry_ms:
            raise ValueError(
                f"silence_s must be at least {_REPORTS_MISSED} times telemetry_ms, got {self.silence_s} s"
                f" and {self.telemetry_ms} ms"
            )


@dataclass(frozen=True, kw_only=True)
class BoardOptions(ReportOptions):
    """What is agreed with one of our own boards."""

    ttl_max_ms: Annotated[int, Within(10, U16_MAX, "ms")] = 500
    """Longest time for which the board may go on with a motion without hearing from us [ms]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveSettings(PortSettings):
    """The synchro-drive base, whatever it speaks."""

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
    """The pan/tilt unit, whatever it speaks."""

    port: str = "/dev/robotd/pantilt"
    """A device path, best one under ``/dev/serial/by-id``, or ``tcp://host:port``."""
    x_m: Offset = 0.0
    """Pan axis in the robot frame, ahead of the centre."""
    y_m: Offset = 0.0
    """Pan axis in the robot frame, to the left of the centre."""
    pan_zero_rad: Zero = 0.0
    """Added to the pan that the head reads back, to get the angle from the robot's heading."""
    tilt_zero_rad: Zero = 0.0
    """Added to the tilt that the head reads back, to get the angle up from level."""
    backlash_rad: Play = 0.0
    """Play of the pan gears, which no readback shows: in a sweep the beam lags behind its motor by half of it."""
    height_m: Height = 0.0
    """Of the level beam above the floor; a tilt at which it would meet the floor before the cut-off is then refused. 0
    if nobody measured it."""
    lens_ahead_m: Reach = 0.0
    """How far ahead of both axes the beam leaves the head; it turns with the head."""
    lens_up_m: Reach = 0.0
    """How far above the tilt axis it does, when the head looks level."""

    def __post_init__(self) -> None:
        """Refuse what the port or the mount refuses."""
        PortSettings.__post_init__(self)

    @property
    def mount(self) -> HeadMount:
        """Where the head sits."""
        return HeadMount(
            *(self.x_m, self.y_m, self.pan_zero_rad, self.tilt_zero_rad, self.backlash_rad),
            height_m=self.height_m,
            lens_ahead_m=self.lens_ahead_m,
            lens_up_m=self.lens_up_m,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class RangefinderSettings(PortSettings):
    """The laser rangefinder, whatever it speaks."""

    port: str = "/dev/robotd/rangefinder"
    """A device path, best one under ``/dev/serial/by-id``, or ``tcp://host:port``."""
    range_bias_m: Bias = 0.0
    """Added to every range along the beam."""
    range_min_m: Nearest = 0.3
    """Shortest range along the beam that the instrument measures rightly; LILY's is 0.3 m."""
    range_max_m: Farthest = 6.0
    """Cut-off: what is horizontally farther than this counts as not met; LILY's is 6 m."""

    def __post_init__(self) -> None:
        """Refuse what the port or the calibration refuses."""
        PortSettings.__post_init__(self)
        _ = self.calibration  # made to be refused: it holds the two ranges against each other

    @property
    def calibration(self) -> RangefinderCalibration:
        """What the instrument can be believed."""
        return RangefinderCalibration(self.range_bias_m, self.range_min_m, self.range_max_m)
