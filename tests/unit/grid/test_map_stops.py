"""A map is its stops: they come to its grid again, and say so where they need not."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.grid import map_stops
from robotd.grid.arithmetic import arithmetic
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import BetweenBeams, GridSettings, OverRange, UpdatePolicy
from tests.support.made_maps import SPEC, made_stops

SETTINGS = [
    GridSettings(raise_alpha=0.7, policy=policy, over_range=over_range)
    for policy in UpdatePolicy
    for over_range in OverRange
]


DIGESTS = [
    "a86d34a9c307de0c34bac88a7b1a9e67b3fdb62a7412f1a4a421d2cfd6f45173",
    "5bfd61b25314e90336976df1a6b23eb0262cc43398eb6242c1442be0e58938b2",
    "ebe3a0a502538e98324d82bd1b4e0a6c11f6f95526160300ebe275a24ff90d71",
    "9e6d349baa6bd950fd094f9100117c14958909bd1201a6748bf750a0a0951ae0",
]


@given(seed=st.integers(0, 10**6), count=st.integers(0, 4), chosen=st.sampled_from(SETTINGS))
@settings(max_examples=40, deadline=None)
def test_stops_come_to_the_grid_that_they_were_laid_into(seed: int, count: int, chosen: GridSettings) -> None:
    made = made_stops(seed, count, settings=chosen)
    grid = OccupancyGrid(SPEC, settings=chosen)
    for stop in made.stops:
        grid.insert(stop.sweep, stop.map_from_robot)
    assert made.grid_on(SPEC).digest() == grid.digest()
    assert made.grid_on(SPEC).settings == chosen


def test_their_order_matters() -> None:
    made = made_stops(1, 3, settings=GridSettings(policy=UpdatePolicy.PER_READING))
    turned = dataclasses.replace(made, stops=made.stops[::-1])
    assert not np.array_equal(made.grid_on(SPEC).cells, turned.grid_on(SPEC).cells)


def test_a_further_stop_leaves_the_others_alone() -> None:
    made, further = made_stops(1), made_stops(2).stops[0]
    longer = made.with_stop(further)
    assert longer.stops == (*made.stops, further)
    assert len(made.stops) == 2
    assert longer.arithmetic == arithmetic()


def test_stops_that_two_machines_laid_in_are_of_neither(monkeypatch: pytest.MonkeyPatch) -> None:
    made = made_stops(1)
    there = dataclasses.replace(made, arithmetic="another")
    assert [one.is_of_this_arithmetic for one in (made, there, there.with_stop(made.stops[0]))] == [True, False, False]
    monkeypatch.setattr(map_stops, "arithmetic", lambda: "another")
    mixed = made.with_stop(made.stops[0])
    assert [one.is_of_this_arithmetic for one in (made, there, mixed)] == [False, True, False]
    monkeypatch.undo()
    assert not mixed.is_of_this_arithmetic


def test_the_arithmetic_is_told_by_the_last_place(monkeypatch: pytest.MonkeyPatch) -> None:
    compute, here, sine = arithmetic.__wrapped__, arithmetic(), np.sin

    def slightly_other(angles_rad: NDArray[np.float64]) -> NDArray[np.float64]:
        sines: NDArray[np.float64] = sine(angles_rad)
        sines[1234] = np.nextafter(sines[1234], 2.0)
        return sines

    assert compute() == here
    monkeypatch.setattr("robotd.grid.arithmetic.np.sin", slightly_other)
    assert compute() != here


FINE = GridSpec(0.02, -1.5, -1.0, (100, 150))
CLOSE = {
    BetweenBeams.SEEN: "9e2a82c8637cdbd290f4bbce01d199bd8896f6b74bc338d9f9d5eb4f32f51e31",
    BetweenBeams.UNSEEN: "4e707b38ad5db30ad104689177abef5115f44f110474747e04e3bdbf6df09dec",
}


@pytest.mark.parametrize("chosen", BetweenBeams)
def test_beams_close_together_do_what_they_did(chosen: BetweenBeams) -> None:
    """As the one below."""
    made = made_stops(7, 2, 300, settings=GridSettings(between_beams=chosen))
    assert made.grid_on(FINE).digest() == CLOSE[chosen]


@pytest.mark.parametrize(("chosen", "digest"), list(zip(SETTINGS, DIGESTS, strict=True)))
def test_an_insertion_does_what_it_did_when_the_first_maps_were_stored(chosen: GridSettings, digest: str) -> None:
    """A change of it, made on purpose, is counted in ``robotd.grid.arithmetic``: or else maps of before are refused."""
    assert made_stops(7, 3, 60, settings=chosen).grid_on(SPEC).digest() == digest
