"""Maps whose walls were drawn with a broad pen, or as thick as they stand: the robot is found on either."""

import math

import numpy as np
import pytest

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.occupancy import OccupancyGrid
from robotd.localization.localizer import Localizer
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings
from robotd.sim.physics.walls import Point, WallSegments, ray_cast

SPEC = GridSpec(0.05, -1.0, -1.0, (140, 200))
LINES = (
    *(((0.0, 0.0), (8.0, 0.0)), ((8.0, 0.0), (8.0, 5.0)), ((8.0, 5.0), (0.0, 5.0)), ((0.0, 5.0), (0.0, 0.0))),
    *(((3.0, 0.0), (3.0, 1.8)), ((3.0, 3.1), (3.0, 5.0)), ((5.5, 3.2), (8.0, 3.2)), ((1.0, 3.6), (1.6, 4.4))),
)
"""Where walls of no thickness stand [m]."""
POSES = (Pose2(1.3, 1.1, 0.4), Pose2(4.2, 4.1, -2.0), Pose2(6.9, 1.2, 2.9))


def drawn(pen_m: float) -> OccupancyGrid:
    """Return the room as a pen draws it that reaches this far to either side of a wall."""
    cells = np.full(SPEC.shape, 128, np.uint8)
    rows, cols = np.indices(SPEC.shape)
    x, y = SPEC.origin_x_m + (cols + 0.5) * 0.05, SPEC.origin_y_m + (rows + 0.5) * 0.05
    cells[(x > 0.0) & (x < 8.0) & (y > 0.0) & (y < 5.0)] = 0
    for (x0, y0), (x1, y1) in LINES:
        length = math.hypot(x1 - x0, y1 - y0)
        along = np.clip(((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / length, 0.0, length)
        off = np.hypot(x - x0 - along * (x1 - x0) / length, y - y0 - along * (y1 - y0) / length)
        cells[off <= max(pen_m, 0.036)] = 255
    return OccupancyGrid(SPEC, cells)


def scan(pose: Pose2, face_m: float) -> list[RangeReading]:
    """Return half a circle of readings of walls whose faces stand so far from the lines, on either side."""
    walls, random = WallSegments.of([side for line in LINES for side in sides(*line, face_m)]), np.random.default_rng(3)
    readings = []
    for bearing_rad in np.linspace(-math.pi / 2, math.pi / 2, 180):
        range_m = ray_cast(walls, (pose.x_m, pose.y_m), pose.heading_rad + bearing_rad) + random.normal(0, 0.015)
        readings.append(RangeReading(0, float(bearing_rad), ReadingStatus.OK, range_m))
    return readings


def sides(start: Point, end: Point, face_m: float) -> list[tuple[Point, Point, float]]:
    """Return the four sides of a wall."""
    (x0, y0), (x1, y1) = start, end
    length = math.hypot(x1 - x0, y1 - y0)
    x, y = face_m * (x1 - x0) / length, face_m * (y1 - y0) / length
    corners = [(x0 - x - y, y0 - y + x), (x1 + x - y, y1 + y + x), (x1 + x + y, y1 + y - x), (x0 - x + y, y0 - y - x)]
    return [(one, other, math.inf) for one, other in zip(corners, corners[1:] + corners[:1], strict=True)]


@pytest.mark.parametrize(("pen_m", "face_m"), [(0.0, 0.0), (0.1, 0.0), (0.15, 0.0), (0.2, 0.0), (0.15, 0.15)])
@pytest.mark.parametrize("pose", POSES)
def test_the_robot_is_found_whatever_pen_drew_the_walls(pen_m: float, face_m: float, pose: Pose2) -> None:
    settings = LocalizationSettings()
    localizer = Localizer.at_stop(ReadyMap.of(drawn(pen_m), settings), "m", settings.headings_all_round())
    localizer.add(*scan(pose, face_m))
    best = localizer.estimate(0, final=True).best
    assert best is not None
    assert best.distance_m(pose) < 0.1
