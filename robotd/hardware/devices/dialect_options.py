"""What single dialects add to the settings of their device."""

import math
from dataclasses import dataclass
from typing import Annotated

from robotd.core.bounds import Within
from robotd.hardware.devices.settings import (
    U16_MAX,
    BoardOptions,
    DriveSettings,
    PanTiltSettings,
    RangefinderSettings,
    ReportOptions,
    SilenceOptions,
)

_SERVO_ID_MAX = 252
"""The maker's largest; 254 stands for all servos."""


@dataclass(frozen=True, kw_only=True)
class BoardDriveSettings(BoardOptions, DriveSettings):
    """Of our own board."""

    def __post_init__(self) -> None:
        """Refuse what the device or the board refuses."""
        DriveSettings.__post_init__(self)
        self.refuse_short_silence()


@dataclass(frozen=True, kw_only=True)
class RflexSettings(ReportOptions, DriveSettings):
    """Of an rFLEX base, which reports as often as it is told."""

    def __post_init__(self) -> None:
        """Refuse what the device refuses."""
        DriveSettings.__post_init__(self)
        self.refuse_short_silence()


@dataclass(frozen=True, kw_only=True)
class BoardPanTiltSettings(BoardOptions, PanTiltSettings):
    """Of our own board."""

    ttl_max_ms: Annotated[int, Within(10, U16_MAX, "ms")] = 30_000
    """Longest time that one turn of the head may take [ms]."""

    def __post_init__(self) -> None:
        """Refuse what the device or the board refuses."""
        PanTiltSettings.__post_init__(self)
        self.refuse_short_silence()


@dataclass(frozen=True, slots=True, kw_only=True)
class DynamixelSettings(PanTiltSettings):
    """Of two servos on one bus."""

    pan_id: Annotated[int, Within(0, _SERVO_ID_MAX)] = 1
    """Bus id of the pan servo."""
    tilt_id: Annotated[int, Within(0, _SERVO_ID_MAX)] = 2
    """Bus id of the tilt servo."""
    ttl_max_ms: Annotated[int, Within(10, U16_MAX, "ms")] = 30_000
    """After how long without hearing from us the servos stop [ms]; 2.54 s is the longest that they know."""

    def __post_init__(self) -> None:
        """Refuse what the head or the bus refuses."""
        PanTiltSettings.__post_init__(self)
        if self.pan_id == self.tilt_id:
            raise ValueError(f"tilt_id must differ from pan_id, got {self.tilt_id} twice")


@dataclass(frozen=True, slots=True, kw_only=True)
class FixedHeadSettings(PanTiltSettings):
    """Of a head without a motor, and without a line: its port is never opened."""

    pan_min_rad: Annotated[float, Within(-math.pi, math.pi, "rad")] = -math.pi
    """Where it is not asked to look: to the right of this, seen from the robot's heading."""
    pan_max_rad: Annotated[float, Within(-math.pi, math.pi, "rad")] = math.pi
    """Where it is not asked to look: to the left of this, seen from the robot's heading."""

    def __post_init__(self) -> None:
        """Refuse what the mount refuses, and a line."""
        PanTiltSettings.__post_init__(self)
        if self.line:
            raise ValueError(f'line must be empty, for a fixed head has none; got "{self.line}"')
        if not self.pan_min_rad < self.pan_max_rad:
            raise ValueError(f"pan_min_rad must be less than pan_max_rad, got {self.pan_min_rad}, {self.pan_max_rad}")


@dataclass(frozen=True, kw_only=True)
class BoardRangefinderSettings(BoardOptions, RangefinderSettings):
    """Of our own board."""

    def __post_init__(self) -> None:
        """Refuse what the device or the board refuses."""
        RangefinderSettings.__post_init__(self)
        self.refuse_short_silence()


@dataclass(frozen=True, slots=True, kw_only=True)
class DimetixSettings(RangefinderSettings):
    """Of a Dimetix, of which several can share a line; a DISTO has its line for itself."""

    device_id: Annotated[int, Within(0, 9)] = 0
    """Which device on the line: the switch on it, 0 to 9."""

    def __post_init__(self) -> None:
        """Refuse what the device refuses."""
        RangefinderSettings.__post_init__(self)


@dataclass(frozen=True, kw_only=True)
class TfminiSettings(SilenceOptions, RangefinderSettings):
    """Of a TFmini, of which the first generation reports by itself."""
