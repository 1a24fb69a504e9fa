"""Angles in radians, counter-clockwise from +x (REP-103)."""

import math

FULL_TURN_RAD = 2.0 * math.pi


def wrap_rad(angle_rad: float) -> float:
    """Return the same direction in ``[-pi, pi)``.

    >>> wrap_rad(3 * math.pi) == -math.pi
    True
    >>> wrap_rad(0.5)
    0.5
    """
    # As it is where it can be: the remainder would cost the last places.
    if -math.pi <= angle_rad < math.pi:
        return angle_rad
    return (angle_rad + math.pi) % FULL_TURN_RAD - math.pi
