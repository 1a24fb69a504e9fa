"""The recorded room as a map and as readings: what its even scans make, and what one of the others saw."""

from functools import cache

from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading
from robotd.evaluation.recorded import Reach, map_of, readings_of
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.logs.carmen import parse_carmen
from tests.support.recorded_room import drive_lines

_REACH = Reach(range_max_m=4.0, clear_m=3.0)


@cache
def mapped_room() -> tuple[OccupancyGrid, tuple[RangeReading, ...], Pose2]:
    """Return the map, the readings of another scan, and where that was taken."""
    scans = parse_carmen(drive_lines(40)).scans
    grid = map_of(scans[::2], _REACH, GridSettings(rows=1, cols=1, raise_alpha=0.5, lower_alpha=0.9))
    return grid, readings_of(scans[9], _REACH), scans[9].laser_pose
