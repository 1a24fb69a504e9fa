"""Walls as line segments: what a beam meets first, and how near a body comes. Pure geometry, plain doubles."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Point = tuple[float, float]

_ON_THE_WALL = 1e-12
"""Slack, as a share of a segment, by which a ray through a shared corner still meets one of its two walls."""


@dataclass(frozen=True, slots=True, eq=False)
class WallSegments:
    """``n`` segments in the world frame, each reaching from the floor up to its height."""

    starts_m: NDArray[np.float64]
    """``float64[n, 2]`` as ``(x, y)``."""
    along_m: NDArray[np.float64]
    """From start to end, ``float64[n, 2]``; none is zero."""
    heights_m: NDArray[np.float64]
    """``float64[n]``; ``inf`` for walls that reach the ceiling."""

    @classmethod
    def of(cls, segments: Iterable[tuple[Point, Point, float]]) -> "WallSegments":
        """Gather ``(start, end, height)`` segments; those of no length are left out."""
        table = np.array([(*start, *end, height) for start, end, height in segments], dtype=np.float64).reshape(-1, 5)
        along = table[:, 2:4] - table[:, 0:2]
        # A wall of no length has no direction, and would divide by nothing in each ray.
        kept = np.any(along != 0.0, axis=1)
        return cls(table[kept, 0:2], along[kept], table[kept, 4])


NO_WALLS = WallSegments.of(())


def ray_cast(
    walls: WallSegments, origin_m: Point, direction_rad: float, *, eye_height_m: float = 0.0, climb: float = 0.0
) -> float:
    """Return the horizontal distance to the first wall along a ray, ``inf`` if there is none; O(n).

    Args:
        walls: what can be met.
        origin_m: where the ray starts; a wall through this very point is met at distance 0.
        direction_rad: where it goes, counter-clockwise from +x.
        eye_height_m: how high above the floor it starts.
        climb: how much it rises per metre; walls that end below the ray are passed over.
    """
    cos, sin = math.cos(direction_rad), math.sin(direction_rad)
    to_start = walls.starts_m - np.array(origin_m)
    along = walls.along_m
    cross = cos * along[:, 1] - sin * along[:, 0]
    # Parallel walls divide by zero here, and are met edge-on below.
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = (to_start[:, 0] * along[:, 1] - to_start[:, 1] * along[:, 0]) / cross
        share = (to_start[:, 0] * sin - to_start[:, 1] * cos) / cross
    met = (distance >= 0.0) & (share >= -_ON_THE_WALL) & (share <= 1.0 + _ON_THE_WALL)
    edge_on = cross == 0.0
    if np.any(edge_on):
        met[edge_on], distance[edge_on] = _meet_edge_on(to_start[edge_on], along[edge_on], np.array((cos, sin)))
    # Where no wall is met the distance may be infinite, and a level climb times that is no number.
    met &= eye_height_m + climb * np.where(met, distance, 0.0) <= walls.heights_m
    return float(np.min(distance, where=met, initial=np.inf))


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
