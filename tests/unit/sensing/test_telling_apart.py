"""Bearings that tell rivals apart: where they expect other ranges, and not all on one wall."""

import math

import numpy as np
import pytest

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.wall_field import WallField
from robotd.sensing.telling_apart import Expected, telling_bearings

CELL_M = 0.05
BEARINGS = np.linspace(0.0, math.tau, 72, endpoint=False)


@pytest.fixture(scope="module")
def walls() -> WallField:
    """Two rooms of 3 m x 3 m side by side, the right one with a box in its upper right corner."""
    cells = np.ones((68, 132), np.bool_)
    cells[4:64, 4:64] = False
    cells[4:64, 68:128] = False
    cells[44:64, 108:128] = True
    return WallField.of(GridSpec(CELL_M, 0.0, 0.0, cells.shape), cells, cells)


LEFT, RIGHT = Pose2(1.7, 1.7, 0.0), Pose2(4.9, 1.7, 0.0)


def test_rooms_that_are_alike_expect_the_same(walls: WallField) -> None:
    turned = Pose2(1.7, 1.7, math.pi / 2)
    assert not Expected.at(walls, [LEFT, turned], BEARINGS, 6.0).differ().any()


def test_the_bearings_of_what_differs_are_chosen_and_lie_apart(walls: WallField) -> None:
    expected = Expected.at(walls, [LEFT, RIGHT], BEARINGS, 6.0)
    chosen = telling_bearings(expected, (0.5, 0.5), BEARINGS, (), 20)
    bearings_rad = BEARINGS[list(chosen)]
    # Only towards the box, up and to the right, and every 10 degrees.
    assert 3 <= len(chosen) <= 8
    assert ((bearings_rad > 0.0) & (bearings_rad < math.pi / 2)).all()
    gaps = np.diff(np.sort(bearings_rad))
    assert gaps.min() >= math.radians(10.0) - 1e-9


def test_no_bearing_is_chosen_near_to_one_that_was(walls: WallField) -> None:
    expected = Expected.at(walls, [LEFT, RIGHT], BEARINGS, 6.0)
    first = telling_bearings(expected, (0.5, 0.5), BEARINGS, (), 1)
    taken_rad = BEARINGS[list(first)].tolist()
    for number in telling_bearings(expected, (0.5, 0.5), BEARINGS, taken_rad, 20):
        assert abs(BEARINGS[number] - taken_rad[0]) >= math.radians(10.0) - 1e-9


def test_what_tells_the_believed_apart_comes_first(walls: WallField) -> None:
    # The third looks elsewhere at every bearing, but hardly anybody believes in it.
    corner = Pose2(0.5, 0.5, 0.3)
    expected = Expected.at(walls, [LEFT, RIGHT, corner], BEARINGS, 6.0)
    (best,) = telling_bearings(expected, (0.6, 0.4, 1e-6), BEARINGS, (), 1)
    assert expected.differ()[0][best]


def test_beyond_the_cut_off_nothing_differs(walls: WallField) -> None:
    assert telling_bearings(Expected.at(walls, [LEFT, RIGHT], BEARINGS, 0.4), (0.5, 0.5), BEARINGS, (), 5) == ()
