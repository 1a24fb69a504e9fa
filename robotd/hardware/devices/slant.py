"""A beam that points up or down, on a map without heights: how far is that horizontally, and where is the floor?"""

import math


def horizontal_m(along_m: float, tilt_rad: float) -> float:
    """Return how far a range along the beam is on the map.

    >>> round(horizontal_m(2.0, -math.pi / 3), 3)
    1.0
    """
    return along_m * math.cos(tilt_rad)


def floor_m(height_m: float, tilt_rad: float) -> float:
    """Return how far, on the map, a beam meets the floor that begins so high above it; infinite if it never does.

    >>> round(floor_m(0.55, -0.24), 2)
    2.25
    >>> floor_m(0.55, 0.0)
    inf
    """
    return height_m / math.tan(-tilt_rad) if tilt_rad < 0.0 else math.inf
