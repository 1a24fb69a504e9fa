"""Walls as line segments, and plates that lie level: what a beam meets first, and how near a body comes.

Pure geometry, plain doubles.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Point = tuple[float, float]

_ON_THE_WALL = 1e-12
"""Slack, as a share of a segment, by which a ray through a shared corner still meets one of its two walls."""


@dataclass(frozen=True, slots=True)
class Plate:
    """A polygon that lies level, such as a face of a table's top: what rises or sinks on to it ends there."""

    corners_m: tuple[Point, ...]
    """World frame."""
    height_m: float
    """Above the floor."""

    def holds(self, point_m: Point) -> bool:
        """Return whether a point of the plane lies in it."""
        x_m, y_m = point_m
        is_inside = False
        for (x0_m, y0_m), (x1_m, y1_m) in zip(self.corners_m, (*self.corners_m[1:], self.corners_m[0]), strict=True):
            # A line from the point to the right crosses the rim of what holds it an odd number of times.
            if (y0_m > y_m) != (y1_m > y_m) and x_m < x0_m + (y_m - y0_m) / (y1_m - y0_m) * (x1_m - x0_m):
                is_inside = not is_inside
        return is_inside


@dataclass(frozen=True, slots=True, eq=False)
class WallSegments:
    """``n`` segments in the world frame, each reaching from some height, mostly the floor, up to its own."""

    starts_m: NDArray[np.float64]
    """``float64[n, 2]`` as ``(x, y)``."""
    along_m: NDArray[np.float64]
    """From start to end, ``float64[n, 2]``; none is zero."""
    heights_m: NDArray[np.float64]
    """``float64[n]``; ``inf`` for walls that reach the ceiling."""
    from_m: NDArray[np.float64]
    """``float64[n]``, where each begins above the floor."""
    plates: tuple[Plate, ...] = ()
    """What a beam that rises or sinks may end on."""

    @classmethod
    def of(
        cls, segments: Iterable[tuple[Point, Point, float] | tuple[Point, Point, float, float]], *plates: Plate
    ) -> "WallSegments":
        """Gather ``(start, end, height)`` segments, or with where they begin; those of no length are left out."""
        rows = [(*start, *end, height, *(begin or (0.0,))) for start, end, height, *begin in segments]
        table = np.array(rows, dtype=np.float64).reshape(-1, 6)
        along = table[:, 2:4] - table[:, 0:2]
        # A wall of no length has no direction, and would divide by nothing in each ray.
        kept = np.any(along != 0.0, axis=1)
        return cls(table[kept, 0:2], along[kept], table[kept, 4], table[kept, 5], plates)


NO_WALLS = WallSegments.of(())


def ray_cast(
    walls: WallSegments, origin_m: Point, direction_rad: float, *, eye_height_m: float = 0.0, climb: float = 0.0
) -> float:
    """Return the horizontal distance to the first wall or plate along a ray, ``inf`` if there is none; O(n).

    Args:
        walls: what can be met.
        origin_m: where the ray starts; a wall through this very point is met at distance 0.
        direction_rad: where it goes, counter-clockwise from +x.
        eye_height_m: how high above the floor it starts.
        climb: how much it rises per metre; walls that end below the ray are passed over, those above it under.
    """
    cos, sin = math.cos(direction_rad), math.sin(direction_rad)
    to_start = walls.starts_m - np.array(origin_m)
    along = walls.along_m
    cross = cos * along[:, 1] - sin * along[:, 0]
    # Parallel walls divide by zero here, or by next to nothing, and are met edge-on below.
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        distance = (to_start[:, 0] * along[:, 1] - to_start[:, 1] * along[:, 0]) / cross
        share = (to_start[:, 0] * sin - to_start[:, 1] * cos) / cross
    met = (distance >= 0.0) & (share >= -_ON_THE_WALL) & (share <= 1.0 + _ON_THE_WALL)
    edge_on = cross == 0.0
    if np.any(edge_on):
        met[edge_on], distance[edge_on] = _meet_edge_on(to_start[edge_on], along[edge_on], np.array((cos, sin)))
    # Where no wall is met the distance may be infinite, and a level climb times that is no number.
    height_m = eye_height_m + climb * np.where(met, distance, 0.0)
    met &= (walls.from_m <= height_m) & (height_m <= walls.heights_m)
    wall_m = float(np.min(distance, where=met, initial=np.inf))
    if not climb:  # a level beam meets no plate but edge-on
        return wall_m
    plates_m = ((plate, (plate.height_m - eye_height_m) / climb) for plate in walls.plates)
    return min(
        (
            along_m
            for plate, along_m in plates_m
            if 0.0 < along_m < wall_m and plate.holds((origin_m[0] + along_m * cos, origin_m[1] + along_m * sin))
        ),
        default=wall_m,
    )


def _meet_edge_on(
    to_start: NDArray[np.float64], along: NDArray[np.float64], unit: NDArray[np.float64]
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Return which walls parallel to the ray lie in its line ahead, and how far their nearer ends are."""
    one_m, other_m = to_start @ unit, (to_start + along) @ unit
    in_line = to_start[:, 0] * along[:, 1] == to_start[:, 1] * along[:, 0]
    return in_line & (np.maximum(one_m, other_m) >= 0.0), np.maximum(0.0, np.minimum(one_m, other_m))


def nearest_points(walls: WallSegments, point_m: Point) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return how far each wall is, ``float64[n]``, and from ``point_m`` to its nearest point, ``float64[n, 2]``."""
    to_start = walls.starts_m - np.array(point_m)
    along = walls.along_m
    share = np.clip(-np.sum(to_start * along, axis=1) / np.sum(along * along, axis=1), 0.0, 1.0)
    offset = to_start + share[:, None] * along
    return np.hypot(offset[:, 0], offset[:, 1]), offset


def clearance_m(walls: WallSegments, point_m: Point) -> float:
    """Return the distance to the nearest wall, ``inf`` without walls."""
    return float(np.min(nearest_points(walls, point_m)[0], initial=np.inf))
