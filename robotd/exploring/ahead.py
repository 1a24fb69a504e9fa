"""A look along a leg before it is driven: which way to look, and what is in the way.

The leg leads through ground that the map has free, so whatever is met within the robot's breadth of it came since, or
stands lower or thinner than any beam so far. The robot looks along the leg: ahead is +x of its frame.
"""

import math
from collections.abc import Iterable

from robotd.contract.ways import Point
from robotd.core.reading import RangeReading, ReadingStatus

_HALVINGS = 3
"""Beams to either side leave the robot's breadth at the end of the leg, at half of it, and so on."""
_ITSELF_M = 0.05
"""What is nearer to the robot's edge than this stands beside it already: it is driven away from."""
_SAME_M = 0.1
"""So near to where one reading ended, another confirms it."""
_BROAD_M = 1.0
"""What is met within this about it is taken for part of it."""
_FAN, _FAN_STEP_RAD = 14, 0.05
"""To 40 degrees either way: nearer than that something stands beside the robot, not ahead."""


def bearings_along(length_m: float, half_width_m: float) -> tuple[float, ...]:
    """Return where to look for what is in the way of a leg, ascending [rad].

    >>> [round(math.degrees(bearing)) for bearing in bearings_along(1.7, 0.3)]
    [-37, -17, -9, 0, 9, 17, 37]
    """
    reach_m = length_m + half_width_m
    to_the_left_rad = {
        math.asin(half_width_m / out_m)
        for out_m in (reach_m / 2**halving for halving in range(_HALVINGS))
        # Nearer than its own breadth nothing can be beside the leg but what is beside the robot already.
        if out_m > half_width_m
    }
    return tuple(sorted({0.0, *to_the_left_rad, *(-bearing_rad for bearing_rad in to_the_left_rad)}))


def bearings_on_the_way(
    reach_m: float, half_width_m: float, *, speed_mps: float, reading_s: float
) -> tuple[float, ...]:
    """Return where to look while driving, ascending [rad]: over the robot's breadth, if the head is fast enough.

    Args:
        reach_m: beyond the robot's front; what is nearer must be seen in time.
        half_width_m: of the robot.
        speed_mps: it drives no faster.
        reading_s: from one reading to the next, the head turned between.

    >>> [round(math.degrees(bearing)) for bearing in bearings_on_the_way(0.7, 0.3, speed_mps=0.4, reading_s=0.1)]
    [-37, -17, 0, 17, 37]
    >>> bearings_on_the_way(0.7, 0.3, speed_mps=0.4, reading_s=0.5)
    (0.0,)
    """
    to_the_sides = bearings_along(reach_m, half_width_m)
    # A head that does not come round in time had better stay: a laser alone is fast.
    return to_the_sides if speed_mps * reading_s * len(to_the_sides) <= reach_m else (0.0,)


def in_the_way(readings: Iterable[RangeReading], length_m: float, half_width_m: float) -> RangeReading | None:
    """Return the reading that met the nearest of what is in the way; None if nothing is.

    Args:
        readings: taken along the leg.
        length_m: of the leg.
        half_width_m: of the robot.
    """
    hits = (reading for reading in readings if reading.status is ReadingStatus.OK)
    met = (reading for reading in hits if _is_met(head_m(reading), length_m, half_width_m))
    # The nearest is what it would hit first; what stands behind that is seen from the next place.
    return min(met, key=lambda reading: math.hypot(*head_m(reading)), default=None)


def bearings_about(bearing_rad: float) -> tuple[float, ...]:
    """Return where to look for how broad it is what a reading met, ascending [rad]; the reading's own is amid them."""
    return tuple(bearing_rad + number * _FAN_STEP_RAD for number in range(-_FAN, _FAN + 1))


def shape_of(reading: RangeReading, fan: Iterable[RangeReading]) -> tuple[Point, ...]:
    """Return where readings about one met the same thing as it did, robot frame; none if they say it was wrong.

    Args:
        reading: what met something.
        fan: taken afterwards, at :func:`bearings_about` it: one reading in twenty is wrong.
    """
    met_m = head_m(reading)
    heads_m = [head_m(one) for one in fan if one.status is ReadingStatus.OK]
    # Bounded: the fan also meets the walls behind, and a way round a chair must not become a way round the
    # room.
    near_m = tuple(one for one in heads_m if math.dist(one, met_m) <= _BROAD_M)
    return near_m if any(is_same(one, met_m) for one in near_m) else ()


def is_same(one_m: Point, other_m: Point) -> bool:
    """Return whether two readings that ended there may have met the same thing: then they confirm each other."""
    return math.dist(one_m, other_m) <= _SAME_M


def head_m(reading: RangeReading) -> Point:
    """Return where a reading that met something ends, robot frame."""
    assert reading.range_m is not None
    x_m = reading.origin_x_m + reading.range_m * math.cos(reading.bearing_rad)
    return x_m, reading.origin_y_m + reading.range_m * math.sin(reading.bearing_rad)


def _is_met(place_m: Point, length_m: float, half_width_m: float) -> bool:
    x_m, y_m = place_m
    is_beside = math.hypot(x_m, y_m) <= half_width_m + _ITSELF_M
    return not is_beside and abs(y_m) <= half_width_m and 0.0 < x_m <= length_m + half_width_m
