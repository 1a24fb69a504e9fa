"""From what the instruments say to metres and radians in the robot frame."""

import math
from dataclasses import dataclass
from typing import Annotated

from robotd.core.angles import wrap_rad
from robotd.core.bounds import Within, refuse_outside
from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.hardware.devices.pantilt import AimReadback
from robotd.hardware.devices.rangefinder import Shot
from robotd.hardware.devices.slant import horizontal_m

# Wide enough for any robot, narrow enough that most values in a wrong unit fall outside (decision 23).
CountsPerM = Annotated[float, Within(100.0, 1e8, "counts/m", either_sign=True)]
CountsPerRad = Annotated[float, Within(10.0, 1e8, "counts/rad", either_sign=True)]
Offset = Annotated[float, Within(-3.0, 3.0, "m")]
Zero = Annotated[float, Within(-math.pi, math.pi, "rad")]
Height = Annotated[float, Within(0.0, 3.0, "m")]
Play = Annotated[float, Within(0.0, 0.5, "rad")]
Bias = Annotated[float, Within(-1.0, 1.0, "m")]
Nearest = Annotated[float, Within(0.001, 20.0, "m")]
Farthest = Annotated[float, Within(0.05, 200.0, "m")]


@dataclass(frozen=True, slots=True)
class DriveCalibration:
    """Scales of the two encoders; a negative one turns the sense of its encoder round."""

    counts_per_m: CountsPerM
    """Translation encoder counts per metre along the heading."""
    counts_per_rad: CountsPerRad
    """Rotation encoder counts per radian counter-clockwise."""

    def __post_init__(self) -> None:
        """Refuse scales that say nothing."""
        refuse_outside(self)


@dataclass(frozen=True, slots=True)
class HeadMount:
    """Where the head sits on the robot, and what it calls straight ahead and level."""

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

    def __post_init__(self) -> None:
        """Refuse what cannot be a mount."""
        refuse_outside(self)


@dataclass(frozen=True, slots=True)
class RangefinderCalibration:
    """What the instrument can be believed."""

    range_bias_m: Bias = 0.0
    """Added to every range along the beam."""
    range_min_m: Nearest = 0.3
    """Shortest range along the beam that the instrument measures rightly; LILY's is 0.3 m."""
    range_max_m: Farthest = 6.0
    """Cut-off: what is horizontally farther than this counts as not met; LILY's is 6 m."""

    def __post_init__(self) -> None:
        """Refuse ranges that leave nothing to measure."""
        refuse_outside(self)
        if not self.range_min_m < self.range_max_m:
            raise ValueError(f"range_max_m must be above range_min_m, got {self.range_max_m} and {self.range_min_m}")


def reading_in_robot(
    mount: HeadMount,
    calibration: RangefinderCalibration,
    aim: AimReadback,
    shot: Shot,
    stop_from_base: Pose2 = IDENTITY,
) -> RangeReading:
    """Lay one shot into the robot frame of the stop.

    Args:
        mount: where the head sits; its zeros are in ``aim`` already.
        calibration: between which ranges the instrument is believed; its bias is in ``shot`` already.
        aim: where the head points.
        shot: what the instrument measured there.
        stop_from_base: where the base stands now in the robot frame of the stop, if it turned since the sweep began.

    Returns:
        The reading, its range made horizontal by the tilt: a miss, with the cut-off as its range, or with the reach of
        an instrument that sees less far, if nothing was met up to there, and ``TOO_NEAR`` if it is nearer than the
        instrument can measure.
    """
    origin_x_m, origin_y_m = stop_from_base.transform(mount.x_m, mount.y_m)
    status, range_m = _horizontal(calibration, shot, aim.tilt_rad)
    return RangeReading(
        time_ns=shot.time_ns,
        bearing_rad=wrap_rad(stop_from_base.heading_rad + aim.pan_rad),
        status=status,
        range_m=range_m,
        strength=shot.strength,
        origin_x_m=origin_x_m,
        origin_y_m=origin_y_m,
    )


def _horizontal(calibration: RangefinderCalibration, shot: Shot, tilt_rad: float) -> tuple[ReadingStatus, float | None]:
    if shot.status is ReadingStatus.MISS:
        # A device that does not say how far it sees is believed up to the cut-off.
        seen_m = math.inf if shot.range_m is None else horizontal_m(shot.range_m, tilt_rad)
        return ReadingStatus.MISS, min(seen_m, calibration.range_max_m)
    if shot.status is not ReadingStatus.OK or shot.range_m is None:
        return shot.status, None
    # Too near is a matter of optics, so it is judged along the beam; too far is one of the map, so after the tilt.
    if shot.range_m < calibration.range_min_m:
        return ReadingStatus.TOO_NEAR, None
    range_m = horizontal_m(shot.range_m, tilt_rad)
    if range_m > calibration.range_max_m:
        return ReadingStatus.MISS, calibration.range_max_m
    return ReadingStatus.OK, range_m
