"""A sweep in the form that scanners have: one place, a first direction, and even steps counter-clockwise from there."""

import math
from dataclasses import dataclass

import numpy as np

from robotd.core.reading import RangeReading


@dataclass(frozen=True, slots=True)
class BeamFan:
    """The readings in that order. How well the head aimed is lost, and so is its offset across each beam."""

    first_rad: float
    step_rad: float
    readings: tuple[RangeReading, ...]

    @classmethod
    def of(cls, readings: tuple[RangeReading, ...]) -> "BeamFan":
        """Return the fan of at least two readings, whichever way the head went round."""
        # Each bearing is wrapped, and the form tells a first one and a step: a sweep goes round without a leap.
        bearings = np.unwrap([reading.bearing_rad for reading in readings]).tolist()
        if bearings[-1] < bearings[0]:  # clockwise, which few readers expect
            bearings, readings = bearings[::-1], readings[::-1]
        return cls(bearings[0], (bearings[-1] - bearings[0]) / (len(readings) - 1), readings)


def from_axis_m(reading: RangeReading) -> float:
    """Return how far the end of a measured reading is from the robot's axis, along the bearing."""
    cos, sin = math.cos(reading.bearing_rad), math.sin(reading.bearing_rad)
    return (reading.range_m or 0.0) + reading.origin_x_m * cos + reading.origin_y_m * sin
