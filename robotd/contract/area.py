"""Where on the map the robot is known to be: a disk."""

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Area:
    """A disk of the map."""

    x_m: float
    y_m: float
    radius_m: float

    def __post_init__(self) -> None:
        """Refuse a disk that holds nothing."""
        if not (math.isfinite(self.x_m) and math.isfinite(self.y_m)):
            raise ValueError("x_m and y_m must be finite")
        if not (math.isfinite(self.radius_m) and self.radius_m > 0.0):
            raise ValueError(f"radius_m must be positive, got {self.radius_m}")
