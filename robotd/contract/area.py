"""Parts of the map: a disk where the robot is known to be, a rectangle that is explored."""

import math
from typing import Annotated

import msgspec
from msgspec import Meta

from robotd.contract.arguments import Coordinate


class Area(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A disk of the map."""

    x_m: Coordinate
    y_m: Coordinate
    radius_m: Annotated[float, Meta(gt=0.0, le=100_000.0)]

    def __post_init__(self) -> None:
        """Refuse a disk that holds nothing: bounds are looked at only where it comes over the wire."""
        if not (math.isfinite(self.x_m) and math.isfinite(self.y_m)):
            raise ValueError("x_m and y_m must be finite")
        if not (math.isfinite(self.radius_m) and self.radius_m > 0.0):
            raise ValueError(f"radius_m must be positive, got {self.radius_m}")


class Bounds(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A rectangle of the map, its sides along the axes."""

    west_m: Coordinate
    south_m: Coordinate
    east_m: Coordinate
    north_m: Coordinate

    def __post_init__(self) -> None:
        """Refuse a rectangle that holds nothing."""
        if not (self.west_m < self.east_m and self.south_m < self.north_m):
            raise ValueError("west_m must be less than east_m, and south_m less than north_m")

    def holds(self, x_m: float, y_m: float) -> bool:
        """Return whether a point lies in it."""
        return self.west_m <= x_m <= self.east_m and self.south_m <= y_m <= self.north_m
