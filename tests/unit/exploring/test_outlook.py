"""What could be seen, against the definition, beam by beam."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.rectangle import Rectangle
from robotd.exploring.outlook import Outlook, facing_rad
from robotd.exploring.settings import ExploringSettings
from robotd.grid import kernels
from robotd.grid.kernels.cast.cast_kernel import BLOCKS, ENDS

SETTINGS = ExploringSettings(beams=36, opening_min_m=0.3)
SPEC = GridSpec(0.1, -0.4, 0.2, (14, 17))
CUT_OFF_M = 1.1
WITHIN = Rectangle(-0.2, 0.3, 1.0, 1.4)


@given(cells=st.binary(min_size=14 * 17, max_size=14 * 17), within=st.sampled_from([None, WITHIN]), bare=st.booleans())
def test_views_are_what_each_beam_says(cells: bytes, within: Rectangle | None, bare: bool) -> None:
    values = np.frombuffer(cells, np.uint8).reshape(14, 17)
    walls, unknown = values > 220, (values > 120) & (values <= 220)
    if bare:
        walls, unknown = np.zeros_like(walls), np.ones_like(walls)
        unknown[3:9, 4:11] = False
    free = np.argwhere(~walls & ~unknown)
    if not len(free):
        return
    places_m = np.array([SPEC.centre_of(*cell) for cell in free[::7].tolist()])
    places_m = places_m[_inside(places_m, within or WITHIN)]
    outlook = Outlook.on(SPEC, walls, unknown, within, CUT_OFF_M)
    views = outlook.views(places_m, SETTINGS)
    for number, (x_m, y_m) in enumerate(places_m.tolist()):
        opening_m, area_m2, overlap = _by_beams(outlook, walls, unknown, x_m, y_m)
        assert views.opening_m[number] == pytest.approx(opening_m, abs=1e-9)
        assert views.area_m2[number] == pytest.approx(area_m2, rel=1e-3, abs=1e-6)
        assert views.overlap[number] == pytest.approx(overlap)
    assert views.behind_m2.sum(axis=1) == pytest.approx(views.area_m2)


def _by_beams(
    outlook: Outlook, walls: NDArray[np.bool_], unknown: NDArray[np.bool_], x_m: float, y_m: float
) -> tuple[float, float, float]:
    """Work it out from the definition: a list of beams, runs of them going round, and sums for integrals."""
    beams = [_beam(outlook, walls, unknown, x_m, y_m, SETTINGS.step_rad * k) for k in range(SETTINGS.beams)]
    is_open = [stop == BLOCKS and way_m + 0.05 < reach_m for way_m, stop, reach_m, _ in beams]
    opening_m = area_m2 = 0.0
    for k, (way_m, _, reach_m, end_m) in enumerate(beams):
        run = _run(is_open, k)
        width_m = sum(beams[one][0] * SETTINGS.step_rad for one in run)
        if width_m < SETTINGS.opening_min_m:
            continue
        depth_m = min(SETTINGS.depth_max_m, width_m)
        opening_m += way_m * SETTINGS.step_rad
        lengths_m = np.linspace(way_m, max(way_m, min(end_m, reach_m)), 2001)
        chance = np.exp(-(lengths_m - way_m) / depth_m)
        area_m2 += float(np.trapezoid(lengths_m * chance, lengths_m)) * SETTINGS.step_rad
    overlap = sum(stop == ENDS and way_m < CUT_OFF_M for way_m, stop, _, _ in beams) / len(beams)
    return opening_m, area_m2, overlap


def _run(is_open: list[bool], k: int) -> set[int]:
    """Return the open beams that hang together with one, going round."""
    if not is_open[k]:
        return set()
    run, count = {k}, len(is_open)
    for step in (1, -1):
        one = (k + step) % count
        while is_open[one] and one not in run:
            run.add(one)
            one = (one + step) % count
    return run


def _beam(
    outlook: Outlook, walls: NDArray[np.bool_], unknown: NDArray[np.bool_], x_m: float, y_m: float, bearing_rad: float
) -> tuple[float, int, float, float]:
    """Return how far a beam goes, what stops it, how far it is asked about, and where the unknown it enters ends."""
    cos, sin = math.cos(bearing_rad), math.sin(bearing_rad)
    way_m, stop = _cast(walls, unknown, x_m, y_m, cos, sin)
    side_x = outlook.within.east_m if cos > 0 else outlook.within.west_m
    side_y = outlook.within.north_m if sin > 0 else outlook.within.south_m
    out_m = min(
        (side_x - x_m) / cos if abs(cos) > 1e-12 else math.inf, (side_y - y_m) / sin if abs(sin) > 1e-12 else math.inf
    )
    into_m = way_m + 1e-7
    further_m, _ = _cast(~unknown, np.zeros_like(unknown), x_m + into_m * cos, y_m + into_m * sin, cos, sin)
    return way_m, stop, min(CUT_OFF_M, out_m), way_m + further_m


def _cast(
    ends: NDArray[np.bool_], blocks: NDArray[np.bool_], x_m: float, y_m: float, cos: float, sin: float
) -> tuple[float, int]:
    cast = kernels.in_use().cast
    pose = np.array([[(x_m - SPEC.origin_x_m) / 0.1, (y_m - SPEC.origin_y_m) / 0.1, 1.0, 0.0]])
    ways, stops = cast.cast_beams(cast.skip_codes(ends, blocks), np.array([[0.0, 0.0, cos, sin]]), pose, 1)
    return float(ways[0, 0]) * 0.1, int(stops[0, 0])


def _inside(points_m: NDArray[np.float64], within: Rectangle) -> NDArray[np.bool_]:
    return np.array([within.west_m < x < within.east_m and within.south_m < y < within.north_m for x, y in points_m])


def test_what_lies_behind_the_border_is_told_apart_by_where_it_begins() -> None:
    """A room with a door to the west and one to the east: from the middle each promises as much."""
    walls, unknown = np.zeros((40, 60), np.bool_), np.ones((40, 60), np.bool_)
    walls[[5, -6], 20:40] = walls[5:-5, [20, 39]] = True
    walls[15:25, [20, 39]] = unknown[5:-5, 20:40] = False
    outlook = Outlook.on(GridSpec(0.1, 0.0, 0.0, (40, 60)), walls, unknown, None, 6.0)
    views = outlook.views(np.array([(3.0, 2.0), (2.3, 0.8)]), ExploringSettings(stretch_m=3.0))
    west, east = views.behind_m2.T
    assert west[0] == pytest.approx(east[0], rel=0.05)
    assert west[0] > 0.5
    assert west[1] == 0.0
    assert east[1] > 0.0


def test_what_is_narrow_promises_little_and_a_door_more_than_next_to_nothing() -> None:
    expected_m2 = []
    for cells in (6, 9, 14):
        walls, unknown = np.zeros((40, 60), np.bool_), np.ones((40, 60), np.bool_)
        walls[[5, -6], 20:40] = walls[5:-5, [20, 39]] = True
        walls[16 : 16 + cells, 39] = unknown[5:-5, 20:40] = False
        outlook = Outlook.on(GridSpec(0.1, 0.0, 0.0, (40, 60)), walls, unknown, None, 6.0)
        expected_m2.append(outlook.views(np.array([(3.5, 2.0)]), ExploringSettings()).area_m2[0])
    assert expected_m2[0] < 0.8
    assert expected_m2[1] > ExploringSettings().good_enough_max_m2
    assert expected_m2[2] > 1.5 * expected_m2[1]


def test_a_small_shadow_promises_little_and_open_ground_much() -> None:
    walls, unknown = np.zeros((40, 40), np.bool_), np.zeros((40, 40), np.bool_)
    walls[[0, -1], :] = walls[:, [0, -1]] = True
    pocket, beyond = unknown.copy(), unknown.copy()
    pocket[14:26, 30:33] = True
    beyond[:, 30:39] = True
    spec, here = GridSpec(0.1, 0.0, 0.0, (40, 40)), np.array([(2.05, 2.05)])
    small, large = (
        Outlook.on(spec, walls, one, None, 6.0).views(here, ExploringSettings()) for one in (pocket, beyond)
    )
    assert small.opening_m[0] > 0.6
    assert small.area_m2[0] < 0.45
    assert large.area_m2[0] > 8 * small.area_m2[0]
    assert small.overlap[0] > 0.8


@pytest.mark.parametrize(("heading_deg", "turn_deg"), [(0.0, 90.0), (90.0, 0.0), (-90.0, 180.0), (-170.0, 100.0)])
def test_a_turn_goes_the_short_way_round(heading_deg: float, turn_deg: float) -> None:
    turn_rad = facing_rad(np.array([(1.0, 3.0)]), (1.0, 1.0), math.radians(heading_deg))
    assert math.degrees(turn_rad[0]) == pytest.approx(turn_deg)
