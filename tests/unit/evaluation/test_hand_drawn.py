"""What a person draws: few corners, straight lines, near to where the walls are."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.core.grid_spec import GridSpec
from robotd.evaluation.hand_drawn import hand_drawn, loops_of, simplified
from robotd.grid.growth import grown_by_disk
from robotd.grid.occupancy import OccupancyGrid

SPEC = GridSpec(0.05, 0.0, 0.0, (60, 80))


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32))
def test_loops_go_round_all_cells_and_come_back(seed: int) -> None:
    mask = np.random.default_rng(seed).random((9, 12)) < 0.5
    loops = list(loops_of(mask))
    for loop in loops:
        steps = np.abs(np.roll(loop, -1, axis=0) - loop).sum(axis=1)
        assert (steps == 1).all()
    # Green's theorem: what lies to the left of all loops is the set.
    area = sum(float((loop[:, 1] * (np.roll(loop[:, 0], -1) - loop[:, 0])).sum()) for loop in loops)
    assert area == mask.sum()
    borders = np.abs(np.diff(np.pad(mask, 1).astype(int), axis=0)).sum()
    borders += np.abs(np.diff(np.pad(mask, 1).astype(int), axis=1)).sum()
    assert sum(len(loop) for loop in loops) == borders


def test_of_a_box_four_corners_are_kept() -> None:
    mask = np.zeros((30, 40), np.bool_)
    mask[5:20, 8:33] = True
    (loop,) = loops_of(mask)
    assert sorted(map(tuple, simplified(loop, 1.0).tolist())) == [(5, 8), (5, 33), (20, 8), (20, 33)]


def test_ragged_walls_are_drawn_straight_and_specks_left_out() -> None:
    random, cells = np.random.default_rng(4), np.zeros(SPEC.shape, np.uint8)
    wall = np.zeros(SPEC.shape, np.bool_)
    wall[30 + random.integers(0, 2, 70), np.arange(5, 75)] = True  # a wall that a noisy scanner saw
    cells[wall] = 250
    cells[10, 20] = 250  # and a speck
    cells[50:] = 128
    drawn = hand_drawn(OccupancyGrid(SPEC, cells)) > 128
    assert not drawn[:25].any()
    assert not drawn[50:].any()
    assert drawn[:, 8:72].any(axis=0).all()
    assert not (drawn & ~grown_by_disk(wall, 3.0)).any()
    assert (hand_drawn(OccupancyGrid(SPEC, cells))[50:] == 128).all()
