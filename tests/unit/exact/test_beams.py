"""Beams are rational: of exact length, in a direction next to the one asked for."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.exact.beams import Beam, beam, direction, theta_slices
from robotd.exact.rationals import Arithmetic, rational
from robotd.exact.surds import compare
from tests.unit.exact.arithmetics import arithmetics

angles = st.floats(-10.0, 10.0) | st.floats(-1e-5, 1e-5)


@given(angles, arithmetics)
def test_a_direction_is_of_length_one_and_within_a_nanoradian(bearing_rad: float, arithmetic: Arithmetic) -> None:
    cos, sin = direction(bearing_rad, arithmetic)
    assert {type(cos), type(sin)} == {type(arithmetic(0))}
    assert cos * cos + sin * sin == 1
    assert math.hypot(float(cos) - math.cos(bearing_rad), float(sin) - math.sin(bearing_rad)) < 1.001e-9


@pytest.mark.parametrize(
    ("quarters", "expected"), [(0, (1, 0)), (1, (0, 1)), (2, (-1, 0)), (-1, (0, -1)), (7, (0, -1))]
)
def test_quarter_turns_are_exact(quarters: int, expected: tuple[int, int]) -> None:
    cos, sin = direction(quarters * math.pi / 2.0)
    assert (int(cos), int(sin)) == expected
    assert cos * sin == 0


def test_the_body_is_all_but_the_last_eps() -> None:
    assert Beam(rational(3), rational(4)).body_share(rational(1)) == rational("4/5")
    assert Beam(rational(3), rational(4)).body_share(rational(6)) == 0
    slanted = Beam(rational(1), rational(1))
    assert compare(slanted.body_share(rational(1)) * slanted.length, slanted.length - 1) == 0


def test_theta_slices_turn_all_beams() -> None:
    slices = theta_slices([beam(0.0, rational(2))], [0.0, math.pi / 2.0])
    assert slices == [(Beam(rational(2), rational(0)),), (Beam(rational(0), rational(2)),)]


def test_a_beam_has_a_length() -> None:
    with pytest.raises(ValueError, match="needs a length"):
        Beam(rational(0), rational(0))
