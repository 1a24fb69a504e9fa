"""Two sweeps laid on each other: the pose between them, and an error that can be believed."""

import math
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.calibration.heads import SweepHeads
from robotd.calibration.matching import match
from robotd.calibration.two_way_stops import along, round_about
from robotd.core.errors import CalibrationError
from robotd.core.pose import IDENTITY, Pose2
from robotd.sim.buildings.world import load_world
from tests.unit.calibration.rooms import seen_from

LABORATORY = load_world("laboratory")
START = LABORATORY.start_pose


@cache
def reference() -> SweepHeads:
    return seen_from(LABORATORY, START, np.random.default_rng(1)).heads()


@settings(max_examples=12, deadline=None)
@given(
    way_m=st.floats(0.3, 2.0), aside_rad=st.floats(-0.1, 0.1), seed=st.integers(0, 999), bias_m=st.floats(-0.05, 0.05)
)
def test_a_straight_way_is_found_whatever_the_bias(way_m: float, aside_rad: float, seed: int, bias_m: float) -> None:
    rng = np.random.default_rng(seed)
    truth = Pose2(way_m * math.cos(aside_rad), way_m * math.sin(aside_rad), 0.3 * aside_rad)
    before = seen_from(LABORATORY, START, rng, bias_m=bias_m).heads()
    after = seen_from(LABORATORY, START @ truth, rng, bias_m=bias_m).heads()
    found = match(before, after, along(1.1 * way_m))
    assert found.pose.distance_m(truth) < 0.025
    assert abs(found.pose.heading_rad - truth.heading_rad) < 0.012


@settings(max_examples=10, deadline=None)
@given(turned_rad=st.floats(-3.1, 3.1), seed=st.integers(0, 999))
def test_any_turn_is_found(turned_rad: float, seed: int) -> None:
    after = seen_from(LABORATORY, START @ Pose2(0.0, 0.0, turned_rad), np.random.default_rng(seed)).heads()
    found = match(reference(), after, round_about(0.0, math.pi))
    assert abs(math.remainder(found.pose.heading_rad - turned_rad, math.tau)) < 0.012
    assert math.hypot(found.pose.x_m, found.pose.y_m) < 0.02


def test_the_error_it_tells_is_the_error_it_makes() -> None:
    off = []
    for seed in range(16):
        rng = np.random.default_rng(seed)
        truth = Pose2(1.0, rng.normal(0.0, 0.01), rng.normal(0.0, 0.05))
        before = seen_from(LABORATORY, START, rng).heads()
        found = match(before, seen_from(LABORATORY, START @ truth, rng).heads(), along(1.0))
        error = (found.pose.x_m - truth.x_m, found.pose.y_m - truth.y_m, found.pose.heading_rad - truth.heading_rad)
        off.append(np.array(error) / np.sqrt(np.diag(found.covariance)))
    spread = np.sqrt((np.array(off) ** 2).mean(axis=0))
    assert (spread > 0.3).all()
    assert (spread < 1.5).all()


def test_without_noise_it_is_exact_to_a_millimetre() -> None:
    rng = np.random.default_rng(0)
    before, after = (
        seen_from(LABORATORY, at, rng, sigma_m=0.0).heads() for at in (START, START @ Pose2(1.0, 0.0, 0.2))
    )
    found = match(before, after, along(1.0))
    assert found.pose.distance_m(Pose2(1.0, 0.0, 0.0)) < 0.003
    assert found.pose.heading_rad == pytest.approx(0.2, abs=0.001)


def test_two_rooms_do_not_match() -> None:
    corridor = load_world("corridor")
    elsewhere = seen_from(corridor, corridor.start_pose, np.random.default_rng(2)).heads()
    cloud = SweepHeads.of(
        np.linspace(-3.0, 3.0, 200), np.random.default_rng(3).uniform(0.5, 6.0, 200), np.zeros((200, 2))
    )
    for other in (elsewhere, cloud):
        with pytest.raises(CalibrationError, match="do not show the same walls"):
            match(reference(), other, [IDENTITY])


def test_too_few_readings_are_refused() -> None:
    with pytest.raises(CalibrationError, match="only 5 readings met a wall"):
        SweepHeads.of(np.zeros(5), np.ones(5), np.zeros((5, 2)))
