"""A sweep looks evenly round the robot, whatever the head can do."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.core.angles import FULL_TURN_RAD
from robotd.mission.missions.sweep_plan import SweepPart, plan_sweep

limits = st.tuples(st.floats(-math.pi, -0.2), st.floats(0.2, math.pi))


def directions(parts: tuple[SweepPart, ...]) -> list[float]:
    return sorted(bearing % FULL_TURN_RAD for part in parts for bearing in part.bearings_rad)


@given(st.integers(20, 400), limits, st.booleans())
def test_the_bearings_are_even_and_each_is_taken_once(readings: int, pan: tuple[float, float], clockwise: bool) -> None:
    found = directions(plan_sweep(readings, *pan, clockwise=clockwise))
    assert len(found) == readings
    step = FULL_TURN_RAD / readings
    gaps = [b - a for a, b in zip(found, [*found[1:], found[0] + FULL_TURN_RAD], strict=True)]
    assert all(math.isclose(gap, step, abs_tol=1e-6) for gap in gaps)


@given(st.integers(20, 400), limits, st.booleans())
def test_the_head_stays_within_its_limits(readings: int, pan: tuple[float, float], clockwise: bool) -> None:
    for part in plan_sweep(readings, *pan, clockwise=clockwise):
        for bearing in part.bearings_rad:
            assert pan[0] - 1e-6 <= bearing - part.base_turn_rad <= pan[1] + 1e-6


@given(st.integers(20, 400), limits)
def test_there_are_no_more_parts_than_needed(readings: int, pan: tuple[float, float]) -> None:
    per_part = math.floor((pan[1] - pan[0]) / (FULL_TURN_RAD / readings) + 1e-9) + 1
    assert len(plan_sweep(readings, *pan)) == math.ceil(readings / per_part)


def test_a_real_pan_tilt_unit_takes_two_parts_and_a_small_turn() -> None:
    first, second = plan_sweep(300, math.radians(-159), math.radians(159))
    assert len(first.bearings_rad) == 266
    assert len(second.bearings_rad) == 34
    assert math.degrees(second.base_turn_rad) == pytest.approx(40.8, abs=0.1)


def test_clockwise_turns_the_other_way() -> None:
    turns = [plan_sweep(300, -2.5, 2.5, clockwise=clockwise)[1].base_turn_rad for clockwise in (False, True)]
    assert turns[0] > 0.0
    assert turns[1] == pytest.approx(-turns[0])


def test_an_endless_head_needs_no_turn_of_the_base() -> None:
    (part,) = plan_sweep(300, -math.pi, math.pi)
    assert part.base_turn_rad == 0.0


def test_a_head_that_cannot_pan_is_refused() -> None:
    with pytest.raises(ValueError, match="narrower than one step"):
        plan_sweep(300, 0.0, 0.001)
