"""Beams are weighed in C as in NumPy, to the last bit; and what is weighed is a density."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from robotd.grid.kernels import Kernels, in_use
from robotd.grid.kernels.twins import TWINS
from robotd.grid.kernels.weigh.weigh_kernel import AS_MAPPED, IN_UNKNOWN, IN_VACANT, ChanceMap
from robotd.localization.judge.likelihood import skips_of
from tests.support.kernel_tables import NATIVE, both, needs_native

VALUES = np.array([0, 60, 127, 128, 129, 190, 255], np.uint8)
STOPS = np.where(np.arange(256) > 128, np.minimum(np.arange(256) / 255, 0.9), 0.001)
STOPS[128] = 0.015
SHAPE = (23, 31)


def chance_map(cells: NDArray[np.uint8], stops: NDArray[np.float64] = STOPS) -> ChanceMap:
    return ChanceMap(cells, skips_of(cells), stops)


def random_case(seed: int) -> tuple[NDArray[np.uint8], NDArray[np.float64], NDArray[np.float64]]:
    rng = np.random.default_rng(seed)
    cells = rng.choice(VALUES, SHAPE, p=[0.4, 0.1, 0.1, 0.3, 0.03, 0.03, 0.04])
    heading, bearing = rng.uniform(-4, 4, 4), rng.choice([0.0, np.pi / 4, np.pi / 2, 1.0], 12) + rng.integers(0, 2, 12)
    poses = np.stack((rng.uniform(-3, 26, 4), rng.uniform(-3, 34, 4), np.cos(heading), np.sin(heading)), axis=1)
    lengths = rng.uniform((-2, -2), (2, 2), (12, 2)), rng.uniform((0.3, 0.2, 0.0), (40, 2, 2), (12, 3))
    beams = np.column_stack((lengths[0], np.cos(bearing), np.sin(bearing), lengths[1], rng.random(12) < 0.2))
    return cells, poses, beams


@needs_native
@settings(max_examples=100, deadline=None)
@given(st.integers(0, 2**32))
def test_the_same_chances_to_the_last_bit(seed: int) -> None:
    cells, poses, beams = random_case(seed)
    one = NATIVE.weigh.weigh_beams(chance_map(cells), poses, beams)
    assert np.array_equal(one, TWINS.weigh.weigh_beams(chance_map(cells), poses, beams))
    assert (one >= 0.0).all()


@both
def test_nothing_is_weighed_without_poses_or_beams(kernels: Kernels) -> None:
    cells, poses, beams = random_case(0)
    assert kernels.weigh.weigh_beams(chance_map(cells), poses[:0], beams).shape == (0, 12, 3)
    assert kernels.weigh.weigh_beams(chance_map(cells), poses, beams[:0]).shape == (4, 0, 3)


@pytest.mark.parametrize("seed", range(8))
def test_a_beam_ends_somewhere_once(seed: int) -> None:
    """The density over all ranges and the chance that nothing stops the beam make one, without what is not mapped."""
    cells, poses, beams = random_case(seed)
    cells[6:17, 9:22], poses[:, :2] = 0, (11.5, 15.5)
    beams[0, :2] = 0.0
    step, end = 0.05, 400.0
    ranges = np.arange(step / 2, end, step)
    every = np.repeat(beams[:1], len(ranges) + 1, axis=0)
    every[:, 4:] = np.column_stack((np.append(ranges, end), np.full((len(every), 2), (0.5, 0.7)), np.zeros(len(every))))
    every[-1, 7] = 1.0
    chances = in_use().weigh.weigh_beams(chance_map(cells, np.where(np.arange(256) < 128, 0.0, STOPS)), poses, every)
    whole = chances[:, :-1].sum(axis=(1, 2)) * step + chances[:, -1, AS_MAPPED]
    # Student's tails are cut, and what is nearly stopped is dropped.
    assert ((whole > 0.98) & (whole < 1.001)).all(), whole


def test_a_range_is_as_likely_as_the_way_there_is_free() -> None:
    cells = np.zeros((5, 60), np.uint8)
    cells[:, 20], cells[:, 40], cells[:, 50:] = 255, 255, 128
    pose = np.array([[2.5, 0.5, 1.0, 0.0]])
    ranges = np.array([10.0, 20.0, 30.0, 40.0, 55.0])
    beams = np.column_stack((np.tile([0, 0, 1, 0], (5, 1)), ranges, np.full((5, 2), 0.5), np.zeros(5)))
    near, first, between, second, beyond = in_use().weigh.weigh_beams(chance_map(cells), pose, beams)[0]
    cells[:, 20:41] = 0
    assert in_use().weigh.weigh_beams(chance_map(cells), pose, beams)[0, 4].argmax() == IN_UNKNOWN
    assert near.argmax() == IN_VACANT
    assert first.argmax() == AS_MAPPED
    assert between.argmax() == IN_VACANT
    assert first.sum() > 5 * second.sum() > 20 * near.sum() > 40 * between.sum()
    assert beyond.sum() < 1e-4  # two walls are between


def test_a_thick_wall_stops_no_more_than_a_thin_one() -> None:
    thin, thick = np.zeros((5, 60), np.uint8), np.zeros((5, 60), np.uint8)
    thin[:, 20], thick[:, 20:24] = 255, 255
    pose = np.array([[2.5, 0.5, 1.0, 0.0]])
    miss = np.array([[0.0, 0.0, 1.0, 0.0, 50.0, 0.5, 0.5, 1.0]])
    no_rates = np.where(STOPS < 0.5, 0.0, STOPS)
    through = in_use().weigh.weigh_beams(chance_map(thin, no_rates), pose, miss)[0, 0, AS_MAPPED]
    assert through == pytest.approx(0.1)
    assert in_use().weigh.weigh_beams(chance_map(thick, no_rates), pose, miss)[0, 0, AS_MAPPED] == pytest.approx(0.1)
