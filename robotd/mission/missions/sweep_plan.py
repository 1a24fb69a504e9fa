"""Which way the head points for each reading, and when the base must turn to help it."""

import math
from dataclasses import dataclass

from robotd.core.angles import FULL_TURN_RAD

_EDGE_RAD = 1e-9  # a bearing on the limit itself counts as within it


@dataclass(frozen=True, slots=True)
class SweepPart:
    """Readings taken without moving the base."""

    base_turn_rad: float
    """Heading of the base for this part, relative to where the sweep began."""
    bearings_rad: tuple[float, ...]
    """Directions to measure, relative to where the sweep began, in the order of least travel of the head."""


def plan_sweep(
    readings: int, pan_min_rad: float, pan_max_rad: float, *, clockwise: bool = False
) -> tuple[SweepPart, ...]:
    """Spread ``readings`` evenly round the robot over as few parts as the pan limits allow.

    The base turns as little as will do, counter-clockwise or, mirrored, clockwise: taking turns at that keeps
    an error of the rotation scale from adding up.

    Raises:
        ValueError: the head cannot pan at all.
    """
    if clockwise:
        return tuple(_mirrored(part) for part in plan_sweep(readings, -pan_max_rad, -pan_min_rad))
    reach_rad = pan_max_rad - pan_min_rad
    step_rad = FULL_TURN_RAD / readings
    if reach_rad < step_rad:
        raise ValueError(f"a pan range of {reach_rad:.3f} rad is narrower than one step of the sweep")
    parts = []
    first, turn_rad = 0, 0.0
    while first < readings:
        # Bearings run on from pan_min without wrapping, so the rest of the circle is one interval.
        start_rad = pan_min_rad + first * step_rad
        end_rad = pan_min_rad + (readings - 1) * step_rad
        if first:
            # If the rest is within reach, just far enough for its last bearing: turns cost odometry (decision 8).
            turn_rad = end_rad - pan_max_rad if end_rad - start_rad <= reach_rad else start_rad - pan_min_rad
        count = min(readings - first, math.floor((pan_max_rad + turn_rad - start_rad) / step_rad + _EDGE_RAD) + 1)
        bearings = tuple(start_rad + index * step_rad for index in range(count))
        parts.append(SweepPart(turn_rad, bearings))
        first += count
    return tuple(parts)


def _mirrored(part: SweepPart) -> SweepPart:
    return SweepPart(-part.base_turn_rad, tuple(-bearing for bearing in part.bearings_rad))
