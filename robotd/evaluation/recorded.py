"""Recorded scans as the readings of a robot that stands where the laser stood."""

from dataclasses import dataclass

import numpy as np

from robotd.core.pose import IDENTITY
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.logs.scan import Scan

_MARGIN_M = 0.5


@dataclass(frozen=True, slots=True)
class Reach:
    """How far recorded ranges are believed."""

    range_max_m: float
    """What lies farther away was not met."""
    clear_m: float
    """Where nothing was met, the beam is believed to be free up to here: dark and slanted walls return nothing, too."""


def readings_of(scan: Scan, reach: Reach) -> tuple[RangeReading, ...]:
    """Return the beams of a scan that say something, in the frame of the laser."""
    met = scan.hit & (scan.ranges_m <= reach.range_max_m)
    beams = zip(scan.angles_rad.tolist(), scan.ranges_m.tolist(), met, scan.missed | scan.hit & ~met, strict=True)
    return tuple(
        RangeReading(0, angle_rad, ReadingStatus.OK, range_m)
        if is_met
        else RangeReading(0, angle_rad, ReadingStatus.MISS, reach.clear_m)
        for angle_rad, range_m, is_met, is_missed in beams
        if is_met or is_missed
    )


def map_of(scans: tuple[Scan, ...], reach: Reach, settings: GridSettings) -> OccupancyGrid:
    """Return the map that these scans make, laid in where the log says that the laser was; large enough for all hits.

    Raises:
        ValueError: it would be larger than any map.
    """
    points_m = np.concatenate([_hits_in_map_m(scan, reach) for scan in scans])
    low_m, high_m = points_m.min(axis=0), points_m.max(axis=0)
    corners_m = [(float(low_m[0]), float(low_m[1])), (float(high_m[0]), float(high_m[1]))]
    grid = OccupancyGrid(settings.spec_covering(corners_m, _MARGIN_M), settings=settings)
    for number, scan in enumerate(scans):
        grid.insert(Sweep(number, IDENTITY, readings_of(scan, reach)), scan.laser_pose)
    return grid


def _hits_in_map_m(scan: Scan, reach: Reach) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Return where the beams of a scan ended, and where the laser was, map frame, ``float64[n, 2]``."""
    met = scan.hit & (scan.ranges_m <= reach.range_max_m)
    pose = scan.laser_pose
    directions_rad = scan.angles_rad[met] + pose.heading_rad
    steps = np.stack((np.cos(directions_rad), np.sin(directions_rad)), axis=1)
    here_m = np.array([[pose.x_m, pose.y_m]])
    return np.concatenate((here_m, here_m + scan.ranges_m[met, None] * steps))
