"""One shot, laid into the robot frame of the stop."""

import math

from robotd.core.angles import wrap_rad
from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.hardware.devices.calibration import HeadMount, RangefinderCalibration
from robotd.hardware.devices.pantilt import AimReadback
from robotd.hardware.devices.rangefinder import Shot
from robotd.hardware.devices.slant import SlantedBeam, slanted_beam


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
    beam = slanted_beam(mount, aim.pan_rad, aim.tilt_rad)
    origin_x_m, origin_y_m = stop_from_base.transform(beam.start_x_m, beam.start_y_m)
    status, range_m = _horizontal(calibration, shot, beam)
    return RangeReading(
        time_ns=shot.time_ns,
        bearing_rad=wrap_rad(stop_from_base.heading_rad + aim.pan_rad),
        status=status,
        range_m=range_m,
        strength=shot.strength,
        origin_x_m=origin_x_m,
        origin_y_m=origin_y_m,
    )


def _horizontal(
    calibration: RangefinderCalibration, shot: Shot, beam: SlantedBeam
) -> tuple[ReadingStatus, float | None]:
    if shot.status is ReadingStatus.MISS:
        # A device that does not say how far it sees is believed up to the cut-off.
        seen_m = math.inf if shot.range_m is None else beam.per_m * shot.range_m
        return ReadingStatus.MISS, min(seen_m, calibration.range_max_m)
    if shot.status is not ReadingStatus.OK or shot.range_m is None:
        return shot.status, None
    # Too near is a matter of optics, so it is judged along the beam; too far is one of the map, so after the tilt.
    if shot.range_m < calibration.range_min_m:
        return ReadingStatus.TOO_NEAR, None
    range_m = beam.per_m * shot.range_m
    if range_m > calibration.range_max_m:
        return ReadingStatus.MISS, calibration.range_max_m
    return ReadingStatus.OK, range_m
