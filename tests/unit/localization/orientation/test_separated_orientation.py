"""Separated orientation in simulated rooms, and where it must say no."""

import itertools
import math
import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from robotd.contract.walls_verdict import WallsVerdict
from robotd.core.grid_spec import GridSpec
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.binary import BinaryMap
from robotd.grid.readings import Readings
from robotd.localization.count.rank_grid import RankGrid
from robotd.localization.obstacles.prepared_map import PreparedMap
from robotd.localization.orientation.separated_orientation import (
    Axis,
    OrientationSettings,
    SeparatedOrientation,
    map_axis,
    readings_axis,
    separated_orientation,
)
from robotd.sim.buildings.world import load_world
from robotd.sim.physics.walls import Point, WallSegments, ray_cast

RESOLUTION_M = 0.05
SETTINGS = OrientationSettings()


def swept(
    walls: WallSegments,
    x_m: float,
    y_m: float,
    heading_rad: float,
    *,
    cut_off_m: float = 6.0,
    seed: int = 0,
    count: int = 300,
) -> list[RangeReading]:
    """Sigma 2 cm, one reading in twenty wrong."""
    chance, sweep = random.Random(seed), []
    for number in range(count):
        bearing = math.tau * number / count - math.pi
        range_m = ray_cast(walls, (x_m, y_m), heading_rad + bearing) + chance.gauss(0.0, 0.02)
        if chance.random() < 0.05:
            range_m = chance.uniform(0.3, 4.0)
        status = ReadingStatus.OK if range_m <= cut_off_m else ReadingStatus.MISS
        sweep.append(RangeReading(0, bearing, status, min(max(range_m, 0.05), cut_off_m)))
    return sweep


def drawn(walls: WallSegments, turn_rad: float = 0.0) -> BinaryMap:
    """Draw walls, turned about the origin, on a grid that is large enough; nothing else is occupied."""
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    shares = np.linspace(0.0, 1.0, 1500)[:, None, None]
    points = (walls.starts_m + shares * walls.along_m).reshape(-1, 2) @ np.array([[cos, sin], [-sin, cos]])
    low = points.min(axis=0) - 0.5
    cols, rows = np.ceil((points.max(axis=0) + 0.5 - low) / RESOLUTION_M).astype(int).tolist()
    spec = GridSpec(RESOLUTION_M, float(low[0]), float(low[1]), (rows, cols))
    occupied = np.zeros(spec.shape, np.bool_)
    occupied.flat[spec.flat_at(points)] = True
    return BinaryMap(spec, occupied)


def axis_of(occupied: NDArray[np.bool_]) -> Axis:
    axis = map_axis(occupied, RESOLUTION_M, SETTINGS)
    assert axis is not None
    return axis


def off_rad(one_rad: float, other_rad: float, modulo_rad: float) -> float:
    return abs((one_rad - other_rad + modulo_rad / 2.0) % modulo_rad - modulo_rad / 2.0)


@pytest.mark.parametrize(("cut_off_m", "usable_share"), [(2.1, 0.6), (6.0, 1.0)])
@pytest.mark.parametrize("name", ["office", "laboratory", "corridor"])
def test_in_simulated_rooms_one_of_the_four_headings_is_right_within_two_degrees(
    name: str, cut_off_m: float, usable_share: float
) -> None:
    """With the short cut-off there are places where too little wall is in sight; there it says so."""
    world, turn = load_world(name), 0.35
    axis = axis_of(drawn(world.walls, turn).occupied)
    places = [(world.start.x_m, world.start.y_m), *world.stops_m, *world.probes_m]
    usable = 0
    for number, (x_m, y_m) in enumerate(places):
        heading = -3.0 + 0.7 * number
        sweep = swept(world.walls, x_m, y_m, heading, cut_off_m=cut_off_m, seed=number)
        result = separated_orientation(sweep, axis, SETTINGS)
        if result.verdict is WallsVerdict.LITTLE_IN_SIGHT:
            continue
        usable += 1
        assert (result.verdict, len(result.headings_rad)) == (WallsVerdict.USABLE, 4)
        assert result.support > 0.6
        errors = [off_rad(found, heading + turn, math.tau) for found in result.headings_rad]
        assert min(errors) < math.radians(2.0)
    assert usable >= usable_share * len(places)


@pytest.mark.parametrize("turn_deg", [0, 1, 20, 45, 69, 89.7])
def test_the_axis_of_a_map_turns_with_the_map(turn_deg: float) -> None:
    axis = axis_of(drawn(load_world("laboratory").walls, math.radians(turn_deg)).occupied)
    assert 0.0 <= axis.angle_rad < math.pi / 2.0
    assert off_rad(axis.angle_rad, math.radians(turn_deg), math.pi / 2.0) < math.radians(1.0)
    assert axis.share > 0.75


@settings(max_examples=25)
@given(st.floats(-math.pi, math.pi))
def test_turning_the_robot_turns_the_headings_25_cases(turn_rad: float) -> None:
    sweep = swept(load_world("office").walls, 1.6, 1.4, 0.2)
    turned = [RangeReading(0, each.bearing_rad - turn_rad, each.status, each.range_m) for each in sweep]
    one, other = (separated_orientation(readings, Axis(0.3, 1.0), SETTINGS) for readings in (sweep, turned))
    for heading in one.headings_rad:
        assert min(off_rad(heading + turn_rad, found, math.tau) for found in other.headings_rad) < math.radians(1.0)


def test_with_its_four_headings_localization_finds_the_place_by_translation_alone() -> None:
    world, heading, place_m = load_world("laboratory"), 2.2, load_world("laboratory").probes_m[0]
    binary = drawn(world.walls)
    sweep = swept(world.walls, *place_m, heading)
    result = separated_orientation(sweep, axis_of(binary.occupied), SETTINGS)
    ranks = RankGrid(PreparedMap.of_binary(binary, 3.0), result.headings_rad)
    for reading in sweep:
        ranks.add(Readings.of((reading,)))
    number, row, col = ranks.best_poses().poses[0].tolist()
    assert math.dist(binary.spec.centre_of(row, col), place_m) < 0.15
    assert off_rad(result.headings_rad[number], heading, math.tau) < math.radians(2.0)


def test_the_headings_to_search_lie_round_the_four_found_and_hold_the_true_one() -> None:
    world, heading = load_world("office"), 2.2
    sweep = swept(world.walls, *world.probes_m[0], heading)
    axis = axis_of(drawn(world.walls).occupied)
    step = math.radians(1.0 / 3.0)
    headings = separated_orientation(sweep, axis, SETTINGS).headings_near(step, SETTINGS)
    assert len(headings) == 4 * 19
    assert sorted(headings) == list(headings)
    assert min(off_rad(found, heading, math.tau) for found in headings) <= step
    assert separated_orientation(sweep[:1], axis, SETTINGS).headings_near(step, SETTINGS) == ()
    found = separated_orientation(sweep, axis, SETTINGS)
    assert found.headings_near(step, OrientationSettings(heading_error_rad=0.0)) == found.headings_rad


def clutter(seed: int) -> WallSegments:
    """Sixty short walls in all directions, none near the robot at the origin."""
    chance = random.Random(seed)
    segments: list[tuple[Point, Point, float]] = []
    while len(segments) < 60:
        x, y, angle, length = (
            chance.uniform(-5.0, 5.0),
            chance.uniform(-5.0, 5.0),
            chance.uniform(0.0, math.pi),
            chance.uniform(0.2, 0.8),
        )
        if math.hypot(x, y) > 1.0:
            segments.append(((x, y), (x + length * math.cos(angle), y + length * math.sin(angle)), math.inf))
    return WallSegments.of(segments)


def round_room() -> WallSegments:
    corners = [(3.0 * math.cos(k * math.tau / 40), 3.0 * math.sin(k * math.tau / 40)) for k in range(41)]
    return WallSegments.of((one, other, math.inf) for one, other in itertools.pairwise(corners))


@pytest.mark.parametrize("walls", [*(clutter(seed) for seed in range(6)), round_room()])
def test_among_clutter_and_in_a_round_room_it_says_that_it_must_not_be_used(walls: WallSegments) -> None:
    sweep = swept(walls, 0.3, 0.1, 0.4)
    result = separated_orientation(sweep, Axis(0.0, 1.0), SETTINGS)
    assert (result.verdict, result.headings_rad) == (WallsVerdict.READINGS_CLUTTERED, ())
    assert result.support < SETTINGS.share_min
    cluttered = axis_of(drawn(walls).occupied)
    assert cluttered.share < SETTINGS.share_min
    assert separated_orientation(sweep, cluttered, SETTINGS) == SeparatedOrientation(
        WallsVerdict.MAP_CLUTTERED, (), cluttered.share
    )


def test_solid_obstacles_have_the_directions_of_their_outlines() -> None:
    block = np.zeros((60, 60), np.bool_)
    block[10:50, 15:40] = True
    axis = axis_of(block)
    assert off_rad(axis.angle_rad, 0.0, math.pi / 2.0) < math.radians(0.5)


def test_little_in_sight_and_a_map_without_walls_are_no_reason_to_guess() -> None:
    sweep = swept(load_world("laboratory").walls, 3.0, 4.0, 0.0, cut_off_m=0.5)
    for readings in (sweep, sweep[:1], []):
        assert separated_orientation(readings, Axis(0.0, 1.0), SETTINGS).verdict is WallsVerdict.LITTLE_IN_SIGHT
    assert readings_axis([], SETTINGS) is None
    assert map_axis(np.zeros((5, 5), np.bool_), RESOLUTION_M, SETTINGS) is None
    assert separated_orientation(sweep, None, SETTINGS).verdict is WallsVerdict.MAP_CLUTTERED


@pytest.mark.parametrize(
    ("field", "value"),
    [("window_m", 0.0), ("tolerance_rad", 0.8), ("share_min", 1.1), ("walls_min_m", 0.0), ("heading_error_rad", 0.8)],
)
def test_impossible_settings_are_refused(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=field):
        OrientationSettings(**{field: value})
