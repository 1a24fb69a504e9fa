import math

import numpy as np
import pytest

from robotd.core.motion_error import MotionBias, MotionError, Travel
from robotd.core.pose import IDENTITY, Pose2


def test_a_travel_sums_ways_and_turns_and_not_what_is_left_of_them() -> None:
    there_and_back = [Pose2(0.0, 0.0, 0.0), Pose2(1.0, 0.0, 0.5), Pose2(0.0, 0.0, 0.0)]
    travel = Travel.through(there_and_back)
    assert (travel.step, travel.way_m, travel.turn_rad) == (IDENTITY, 2.0, 1.0)
    assert MotionError().deviations(travel)[0] > MotionError().deviations(Travel())[0]


def test_two_travels_are_one() -> None:
    poses = [Pose2(0.1 * at, 0.02 * at**2, 0.1 * at) for at in range(7)]
    both = Travel.through(poses[:4]).then(Travel.through(poses[3:]))
    whole = Travel.through(poses)
    assert both.way_m == pytest.approx(whole.way_m)
    assert both.turn_rad == pytest.approx(whole.turn_rad)
    assert both.step.distance_m(whole.step) < 1e-12


def test_covariance_and_bounds_are_of_the_deviations() -> None:
    error, travel = MotionError(), Travel(Pose2(2.0, 0.0, 0.3), 2.5, 0.4)
    place_m, heading_rad = error.deviations(travel)
    assert np.sqrt(np.diag(error.covariance(travel))) == pytest.approx([place_m, place_m, heading_rad])
    assert error.bounds(travel) == pytest.approx((3.0 * place_m, 3.0 * heading_rad))


def test_what_odometry_is_off_by_every_time_is_learned() -> None:
    random = np.random.default_rng(1)
    bias, true_per_m = MotionBias(), math.radians(2.5)
    for stop in range(40):
        turn = float(random.uniform(-0.8, 0.8)) * (stop % 2)
        travel = Travel(Pose2(0.7, 0.0, turn), 0.7, abs(turn))
        true = travel.step @ Pose2(0.02, 0.0, 0.7 * true_per_m + 0.05 * turn + float(random.normal(0.0, 0.003)))
        bias = bias.learned(travel, true)
    travel = Travel(Pose2(1.4, 0.0, 0.6), 1.4, 0.6)
    off = (travel.step @ Pose2(0.04, 0.0, 1.4 * true_per_m + 0.05 * 0.6)).inverse() @ bias.corrected(travel)
    assert abs(off.heading_rad) < 0.005
    assert math.hypot(off.x_m, off.y_m) < 0.01


def test_a_few_steps_teach_nothing_and_one_that_was_misjudged_neither() -> None:
    travel = Travel(Pose2(0.7, 0.0, 0.0), 0.7, 0.0)
    bias = MotionBias()
    for _ in range(7):
        bias = bias.learned(travel, Pose2(0.8, 0.0, 0.0))
    assert bias.corrected(travel) == travel.step
    right = MotionBias()
    for stop in range(20):
        right = right.learned(travel, Pose2(0.7, 0.0, 0.0) if stop != 12 else Pose2(-0.7, 0.3, 1.0))
    assert right.corrected(travel) == travel.step
    assert len(right.learned(travel, travel.step).latest) <= 50
