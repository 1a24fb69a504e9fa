"""Where the head's zero is, and how much play its gears have.

The play shows in two sweeps from one place, one each way round: what the one sees ahead the other sees turned. The zero
is where the robot goes when it drives straight: that is ahead, whatever the head calls it.
"""

import math

import numpy as np

from robotd.calibration.found import Calibration, Constants, Found, Procedure, Residuals, Step
from robotd.calibration.heads import SweepHeads
from robotd.calibration.matching import match
from robotd.calibration.two_way_stops import TwoWayStop, along, round_about, stop, way
from robotd.contract.missions import DriveStraight

_PLAY_MAX_RAD = 0.3


def calibrate_head(now: Constants, distance_m: float) -> Procedure:
    """Find pan zero and play: ``distance_m`` ahead and back, twice, with sweeps both ways round at each stop."""
    here = yield from stop("look round, once each way")
    plays, aheads = [play(here.counter_clockwise, here.clockwise)], list[tuple[float, float]]()
    # There and back: a wheel that pulls to one side turns both ways' directions against each other, and the
    # mean is free of it.
    for leg_m in (distance_m, -distance_m) * 2:
        yield Step(DriveStraight(leg_m), f"drive {abs(leg_m):g} m {'ahead' if leg_m > 0.0 else 'back'}")
        there = yield from stop("look round, once each way")
        aheads.append(_ahead(here, there, leg_m))
        plays.append(play(there.counter_clockwise, there.clockwise))
        here = there
    play_rad, play_error_rad = combined(plays)
    ahead_rad, ahead_error_rad = combined(aheads)
    # Gears have no less than none; where they have none, noise says a little less as often as a little more.
    backlash_rad = max(0.0, now.backlash_rad + play_rad)
    zero_rad = math.remainder(now.pan_zero_rad - ahead_rad, math.tau)
    return Calibration(
        (
            Found("pantilt", "pan_zero_rad", "rad", zero_rad, ahead_error_rad, now.pan_zero_rad),
            Found("pantilt", "backlash_rad", "rad", backlash_rad, play_error_rad, now.backlash_rad),
        ),
        (
            Residuals("direction of the legs", "rad", np.array([angle for angle, _ in aheads]) - ahead_rad),
            Residuals("play at the stops", "rad", np.array([angle for angle, _ in plays]) - play_rad),
        ),
    )


def play(counter_clockwise: SweepHeads, clockwise: SweepHeads) -> tuple[float, float]:
    """Return how far the head lags behind its motor from one sense to the other [rad], and its error.

    A sweep that goes counter-clockwise tells bearings too large by half of the play, the other as much too small.

    Raises:
        CalibrationError: the two sweeps do not show the same place.
    """
    found = match(counter_clockwise, clockwise, round_about(0.0, _PLAY_MAX_RAD), at_one_place=True)
    return found.pose.heading_rad, math.sqrt(float(found.covariance[2, 2]))


def combined(angles: list[tuple[float, float]]) -> tuple[float, float]:
    """Return the mean of some small angles by their errors, and its error: by what they disagree, if that is more."""
    values, errors = np.array(angles).T
    weights = errors**-2.0
    mean = float((weights * values).sum() / weights.sum())
    disagreement = float((weights * (values - mean) ** 2).sum()) / max(1, len(values) - 1)
    # The larger of what each claims and of how far they disagree: four that contradict each other are not sure.
    return mean, math.sqrt(max(1.0, disagreement) / float(weights.sum()))


def _ahead(before: TwoWayStop, after: TwoWayStop, leg_m: float) -> tuple[float, float]:
    """Return in which direction a leg led, as the head sees it, and its error [rad]."""
    led = way(before, after, along(leg_m))
    x_m, y_m = math.copysign(1.0, leg_m) * led.pose.x_m, math.copysign(1.0, leg_m) * led.pose.y_m
    # A leg that turns a little on its way is an arc: its chord leaves at half of that.
    ahead_rad = math.atan2(y_m, x_m) - led.pose.heading_rad / 2.0
    return ahead_rad, led.place_error_m / math.hypot(x_m, y_m)
