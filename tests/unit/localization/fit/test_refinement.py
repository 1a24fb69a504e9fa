import math
from typing import Any, cast

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from robotd.contract.estimate import Extent
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.readings import Readings
from robotd.grid.wall_field import WallField
from robotd.localization.fit.refinement import PoseBox, RefinedPoses, expected_ranges, refine
from robotd.localization.fit.refinement_settings import RefinementSettings, Walls

SPEC = GridSpec(0.05, -1.0, 2.0, (120, 150))
DRAWN = RefinementSettings(walls=Walls.FACES, map_error_m=0.0, map_error_rad=0.0)
MIDDLE = Pose2(2.0, 4.6, 0.3)
PLAIN = GridSpec(0.05, 0.0, 0.0, (120, 150))
WIDTH_M, HEIGHT_M = 7.5, 6.0
CHI_SQUARE_3_OF_95 = 7.815
MIRROR = np.outer((-1.0, 1.0, -1.0), (-1.0, 1.0, -1.0))


def room() -> NDArray[np.bool_]:
    """Return a room with a pillar, a niche and a cupboard: it looks like itself from one place only."""
    walls = np.ones(SPEC.shape, np.bool_)
    walls[10:105, 12:130] = False
    walls[80:105, 12:30] = True
    walls[30:36, 90:98] = True
    walls[10:20, 60:75] = True
    return walls


def field_of(walls: NDArray[np.bool_], spec: GridSpec = SPEC) -> WallField:
    return WallField.of(spec, walls, walls)


def sweep_from(
    field: WallField, pose: Pose2, *, sigma_m: float = 0.0, outliers: float = 0.0, seed: int = 0, beams: int = 300
) -> NDArray[np.float64]:
    """Return exact ranges, made worse."""
    random = np.random.default_rng(seed)
    readings = np.zeros((beams, 5))
    readings[:, 0] = math.tau * np.arange(beams) / beams
    exact = expected_ranges(field, Readings(readings), np.array([[pose.x_m, pose.y_m, pose.heading_rad]]), 1).ranges_m[
        0
    ]
    short = random.random(beams) < outliers
    shortened = np.where(short, exact * random.uniform(0.2, 1.0, beams), exact)
    readings[:, 1] = np.maximum(shortened + sigma_m * random.normal(size=beams), 0.01)
    return readings


def error_of(refined: RefinedPoses, truth: Pose2, number: int = 0) -> tuple[float, float]:
    pose = refined.pose(number)
    return pose.distance_m(truth), abs(math.remainder(pose.heading_rad - truth.heading_rad, math.tau))


def moved(pose: Pose2, x_m: float, y_m: float, heading_rad: float) -> Pose2:
    return Pose2(pose.x_m + x_m, pose.y_m + y_m, pose.heading_rad + heading_rad)


@pytest.mark.parametrize("away", [(0.02, -0.015, 0.008), (-0.1, 0.08, -0.02), (0.15, 0.15, 0.05)])
def test_readings_without_noise_lead_to_the_true_pose(away: tuple[float, float, float]) -> None:
    field = field_of(room())
    refined = refine(
        field, Readings(sweep_from(field, MIDDLE)), [PoseBox.around(moved(MIDDLE, *away), 0.3, 0.1)], DRAWN
    )
    error_m, error_rad = error_of(refined, MIDDLE)
    assert error_m < 0.001
    assert error_rad < 0.0005


def test_all_boxes_are_refined_in_one_call_as_they_would_be_one_by_one() -> None:
    field = field_of(room())
    readings = sweep_from(field, MIDDLE, sigma_m=0.02, outliers=0.1)
    boxes = [PoseBox.around(moved(MIDDLE, 0.03 * k, -0.02 * k, 0.01 * k), 0.1, 0.03) for k in range(5)]
    together = refine(field, Readings(readings), boxes, DRAWN)
    for number, box in enumerate(boxes):
        alone = refine(field, Readings(readings), [box], DRAWN)
        np.testing.assert_array_equal(together.poses[number], alone.poses[0])
        np.testing.assert_array_equal(together.covariances[number], alone.covariances[0])
        np.testing.assert_array_equal(together.beyond_m[number], alone.beyond_m[0])


def test_a_short_reading_lies_short_of_the_walls_and_a_miss_lies_nowhere() -> None:
    field = field_of(room())
    readings = sweep_from(field, MIDDLE)
    readings[7, 1] -= 0.1
    readings[9, 4] = 1.0
    refined = refine(field, Readings(readings), [PoseBox.around(MIDDLE, 0.05, 0.02)], DRAWN)
    assert refined.beyond_m[0, 7] < -0.05
    assert math.isnan(refined.beyond_m[0, 9])
    assert abs(refined.beyond_m[0, 8]) < 0.01


def test_ranges_are_expected_to_the_sides_of_cells() -> None:
    field = field_of(room())
    readings = np.zeros((2, 5))
    readings[:, 0] = (0.0, math.pi)
    ranges = expected_ranges(field, Readings(readings), np.array([[2.0, 4.6, 0.0]]), 1)
    np.testing.assert_allclose(
        ranges.ranges_m[0], (SPEC.origin_x_m + 130 * 0.05 - 2.0, 2.0 - (SPEC.origin_x_m + 12 * 0.05))
    )
    assert ranges.ends.all()


@settings(max_examples=40, deadline=None)
@given(
    st.integers(0, 2**32),
    st.tuples(st.floats(0.0, 0.3), st.floats(0.0, 0.3), st.floats(0.0, 0.2)),
    st.sampled_from([0.0, 0.02, 0.5]),
    st.sampled_from(list(Walls)),
)
def test_a_pose_never_leaves_its_box(seed: int, half: tuple[float, float, float], sigma_m: float, walls: Walls) -> None:
    random = np.random.default_rng(seed)
    field = field_of(room())
    readings = sweep_from(field, MIDDLE, sigma_m=sigma_m, outliers=0.3, seed=seed, beams=60)
    start = moved(MIDDLE, *random.uniform(-0.5, 0.5, 3).tolist())
    low, high = -np.array(half) * random.random(3), np.array(half) * random.random(3)
    at = np.array([start.x_m, start.y_m, start.heading_rad])
    box = PoseBox(start, Extent(*np.stack((at + low, at + high), axis=1).ravel().tolist()))
    refined = refine(field, Readings(readings), [box], RefinementSettings(walls=walls))
    assert (refined.poses[0] >= at + low - 1e-12).all()
    assert (refined.poses[0] <= at + high + 1e-12).all()
    assert (np.linalg.eigvalsh(refined.covariances[0]) > 0.0).all()


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32))
def test_in_any_furnished_room_readings_without_noise_lead_within_a_millimetre(seed: int) -> None:
    random = np.random.default_rng(seed)
    field, truth = furnished(random)
    away = random.uniform(-1.0, 1.0, 3) * (0.1, 0.1, 0.03)
    readings = sweep_from(field, truth)
    refined = refine(field, Readings(readings), [PoseBox.around(moved(truth, *away.tolist()), 0.2, 0.06)], DRAWN)
    error_m, error_rad = error_of(refined, truth)
    assert error_m < 0.001
    assert error_rad < 0.001


def test_95_of_100_errors_lie_within_the_ellipse_that_is_meant_to_hold_95() -> None:
    inside = []
    for seed in range(300):
        random = np.random.default_rng(seed)
        field, truth = furnished(random)
        readings = sweep_from(field, truth, sigma_m=0.02, outliers=0.05, seed=seed)
        refined = refine(field, Readings(readings), [PoseBox.around(truth, 0.1, 0.03)], DRAWN)
        error = refined.poses[0] - (truth.x_m, truth.y_m, truth.heading_rad)
        inside.append(error @ np.linalg.solve(refined.covariances[0], error) < CHI_SQUARE_3_OF_95)
    # Between a little too sure and a little too modest.
    assert 0.92 <= np.mean(inside) <= 0.995


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32))
def test_a_mirrored_room_gives_the_mirrored_pose(seed: int) -> None:
    random = np.random.default_rng(seed)
    walls, readings, start = noisy(random)
    refined = refine(field_of(walls, PLAIN), Readings(readings), [PoseBox.around(start, 0.1, 0.03)], DRAWN)
    mirrored = readings[::-1].copy()
    mirrored[:, 0] = -mirrored[:, 0]
    other_start = Pose2(WIDTH_M - start.x_m, start.y_m, math.pi - start.heading_rad)
    field = field_of(np.ascontiguousarray(walls[:, ::-1]), PLAIN)
    other = refine(field, Readings(mirrored), [PoseBox.around(other_start, 0.1, 0.03)], DRAWN)
    x_m, y_m, heading_rad = refined.poses[0].tolist()
    np.testing.assert_allclose(other.poses[0], (WIDTH_M - x_m, y_m, math.pi - heading_rad), atol=1e-5)
    np.testing.assert_allclose(other.covariances[0], refined.covariances[0] * MIRROR, rtol=0.05, atol=1e-9)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32))
def test_a_room_turned_by_a_quarter_gives_the_pose_turned_by_a_quarter(seed: int) -> None:
    random = np.random.default_rng(seed)
    walls, readings, start = noisy(random)
    refined = refine(field_of(walls, PLAIN), Readings(readings), [PoseBox.around(start, 0.1, 0.03)], DRAWN)
    # Counter-clockwise: x becomes y, and y the distance from the right side.
    turned = np.ascontiguousarray(walls.T[:, ::-1])
    spec = GridSpec(PLAIN.resolution_m, 0.0, 0.0, (turned.shape[0], turned.shape[1]))
    other_start = Pose2(HEIGHT_M - start.y_m, start.x_m, start.heading_rad + math.pi / 2)
    other = refine(field_of(turned, spec), Readings(readings), [PoseBox.around(other_start, 0.1, 0.03)], DRAWN)
    x_m, y_m, heading_rad = refined.poses[0].tolist()
    np.testing.assert_allclose(other.poses[0], (HEIGHT_M - y_m, x_m, heading_rad + math.pi / 2), atol=1e-5)


@pytest.mark.parametrize("share", [0.1, 0.2, 0.3])
def test_outliers_move_the_pose_by_less_than_a_quarter_of_a_cell(share: float) -> None:
    field = field_of(room())
    for seed in range(20):
        readings = sweep_from(field, MIDDLE, outliers=share, seed=seed)
        refined = refine(
            field, Readings(readings), [PoseBox.around(moved(MIDDLE, 0.04, -0.03, 0.01), 0.1, 0.03)], DRAWN
        )
        assert error_of(refined, MIDDLE)[0] < 0.0125


def test_along_a_corridor_the_pose_stays_in_its_box_and_says_that_it_does_not_know() -> None:
    walls = np.ones((40, 400), np.bool_)
    walls[10:30, :] = False
    field = field_of(walls, GridSpec(0.05, 0.0, 0.0, walls.shape))
    middle = Pose2(10.0, 1.0, 0.0)
    readings = sweep_from(field, middle, sigma_m=0.02)
    readings = readings[readings[:, 1] < 5.0]
    refined = refine(field, Readings(readings), [PoseBox.around(moved(middle, 0.03, 0.02, 0.01), 0.05, 0.02)], DRAWN)
    along_m, across_m = np.sqrt(np.diag(refined.covariances[0]))[:2].tolist()
    assert along_m > 1.0
    assert across_m < 0.01
    assert abs(refined.poses[0, 0] - 10.03) <= 0.05
    assert abs(refined.poses[0, 1] - 1.0) < 0.01


def test_without_readings_the_pose_stays_where_it_was_and_nothing_is_known() -> None:
    box = PoseBox.around(MIDDLE, 0.1, 0.1)
    refined = refine(field_of(room()), Readings(np.zeros((0, 5))), [box], DRAWN)
    assert refined.pose(0) == MIDDLE
    assert refined.weight[0] == 0.0
    assert np.sqrt(refined.covariances[0, 0, 0]) > 10.0
    assert refine(field_of(room()), Readings(np.zeros((0, 5))), [], DRAWN).poses.shape == (0, 3)


def test_a_wall_made_of_readings_is_met_in_the_middle_of_its_cells() -> None:
    walls = room()
    field = field_of(walls)
    readings = sweep_from(field, MIDDLE)
    deeper = readings.copy()
    # Heads half a cell behind the faces, as those are that made the map.
    deeper[:, 1] += 0.5 * SPEC.resolution_m / np.abs(cos_of_incidence(MIDDLE, readings))
    made = RefinementSettings(walls=Walls.CENTRES, map_error_m=0.0, map_error_rad=0.0)
    refined = refine(field, Readings(deeper), [PoseBox.around(moved(MIDDLE, 0.02, 0.02, 0.01), 0.1, 0.03)], made)
    assert error_of(refined, MIDDLE)[0] < 0.003


@pytest.mark.parametrize(
    ("name", "value"), [("outlier_m", 0.0), ("map_error_m", -1.0), ("map_error_rad", -0.1), ("outlier_m", math.nan)]
)
def test_impossible_settings_are_refused(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=name):
        RefinementSettings(**cast("dict[str, Any]", {name: value}))


def test_a_box_that_holds_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="wrong order"):
        PoseBox(MIDDLE, Extent(1.0, 0.0, 0.0, 1.0, 0.0, 1.0))


def furnished(random: np.random.Generator) -> tuple[WallField, Pose2]:
    """Return a room with furniture, and a pose at least 0.3 m from everything."""
    walls = np.ones(SPEC.shape, np.bool_)
    walls[8:-8, 8:-8] = False
    for row, col in random.integers((8, 8), (105, 135), (8, 2)).tolist():
        height, width = random.integers(4, 14, 2).tolist()
        walls[row : row + height, col : col + width] = True
    field = field_of(walls)
    row, col = random.choice(np.argwhere(field.codes > 36)).tolist()
    x_m, y_m = SPEC.centre_of(row + random.uniform(-0.5, 0.5), col + random.uniform(-0.5, 0.5))
    return field, Pose2(x_m, y_m, float(random.uniform(-3.0, 3.0)))


def noisy(random: np.random.Generator) -> tuple[NDArray[np.bool_], NDArray[np.float64], Pose2]:
    """Return a furnished room at the origin, a noisy sweep in it, and a start near its pose."""
    walls = np.ones(PLAIN.shape, np.bool_)
    walls[8:-8, 8:-8] = False
    for row, col in random.integers((8, 8), (105, 135), (8, 2)).tolist():
        walls[row : row + 7, col : col + 10] = True
    field = field_of(walls, PLAIN)
    row, col = random.choice(np.argwhere(field.codes > 36)).tolist()
    truth = Pose2(*PLAIN.centre_of(row, col), float(random.uniform(-3.0, 3.0)))
    readings = sweep_from(field, truth, sigma_m=0.02, outliers=0.05, seed=int(random.integers(1000)))
    return walls, readings, moved(truth, *(random.uniform(-0.02, 0.02, 3)).tolist())


def cos_of_incidence(pose: Pose2, readings: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how squarely each beam meets the side of a cell."""
    bearings = pose.heading_rad + readings[:, 0]
    x_m, y_m = pose.x_m + readings[:, 1] * np.cos(bearings), pose.y_m + readings[:, 1] * np.sin(bearings)
    cols, rows = (x_m - SPEC.origin_x_m) / SPEC.resolution_m, (y_m - SPEC.origin_y_m) / SPEC.resolution_m
    on_col = np.abs(cols - np.rint(cols)) < np.abs(rows - np.rint(rows))
    return np.where(on_col, np.cos(bearings), np.sin(bearings))
