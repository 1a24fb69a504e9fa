"""A stop of a calibration: two sweeps, one each way round, so that the play of the head's gears cancels out."""

import math
from collections.abc import Generator, Sequence
from dataclasses import dataclass

import numpy as np

from robotd.calibration.found import Seen, Step, counted, swept
from robotd.calibration.heads import SweepHeads
from robotd.calibration.matching import Match, match
from robotd.contract.missions import Scan
from robotd.core.errors import CalibrationError
from robotd.core.pose import Pose2
from robotd.core.reading import Sweep

_TRIES = 4
"""Sweeps go round the other way each time; one that was taken again may break the turn."""


@dataclass(frozen=True, slots=True)
class TwoWayStop:
    """What was seen where the robot stands."""

    counts: tuple[int, int]
    counter_clockwise: SweepHeads
    clockwise: SweepHeads
    sweeps: tuple[Sweep, ...]
    """The same as they were taken."""


@dataclass(frozen=True, slots=True)
class SeenMove:
    """How the robot got from one stop to another, by what it saw."""

    pose: Pose2
    """``before_from_after``."""
    place_error_m: float
    heading_error_rad: float
    matches: tuple[Match, ...]


def stop(words: str) -> Generator[Step, Seen, TwoWayStop]:
    """Look round once each way; the base stands still."""
    sweeps: dict[bool, Sweep] = {}
    for _ in range(_TRIES):
        # The base stands: a turn of it would be measured by the very wheels that are to be calibrated.
        seen = yield Step(Scan(base_turns=False), words)
        sweep = swept(seen)
        sweeps[sweep.is_clockwise] = sweep
        if len(sweeps) == 2:
            heads = SweepHeads.of_sweep(sweeps[False]), SweepHeads.of_sweep(sweeps[True])
            return TwoWayStop(counted(seen), *heads, tuple(sweeps.values()))
    raise CalibrationError("the head swept only one way round")


def way(before: TwoWayStop, after: TwoWayStop, starts: Sequence[Pose2]) -> SeenMove:
    """Match each sweep with the one that went the same way round, and take the middle."""
    matches = (
        match(before.counter_clockwise, after.counter_clockwise, starts),
        match(before.clockwise, after.clockwise, starts),
    )
    first, second = (one.pose for one in matches)
    # Of a mean of two that err by themselves.
    covariance = (matches[0].covariance + matches[1].covariance) / 4.0
    turned_rad = math.remainder(second.heading_rad - first.heading_rad, math.tau)
    middle = Pose2((first.x_m + second.x_m) / 2.0, (first.y_m + second.y_m) / 2.0, first.heading_rad + turned_rad / 2.0)
    place_error_m = math.sqrt(float(np.trace(covariance[:2, :2])) / 2.0)
    return SeenMove(middle, place_error_m, math.sqrt(float(covariance[2, 2])), matches)


def along(distance_m: float) -> list[Pose2]:
    """Return where a straight way of about so far may have led: a scale may be wrong by half, and a zero by 20 deg."""
    ways_m = np.arange(0.5, 1.55, 0.1) * distance_m
    return [
        Pose2(float(way_m) * math.cos(aside_rad), float(way_m) * math.sin(aside_rad), 0.0)
        for way_m in ways_m
        for aside_rad in (-0.35, 0.0, 0.35)
    ]


def round_about(angle_rad: float, spread_rad: float) -> list[Pose2]:
    """Return how far the robot may have turned on the spot."""
    count = max(3, math.ceil(spread_rad / 0.05))
    return [
        Pose2(0.0, 0.0, float(angle)) for angle in np.linspace(angle_rad - spread_rad, angle_rad + spread_rad, count)
    ]
