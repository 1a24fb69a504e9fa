import math
from dataclasses import replace
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
from robotd.localization.fit.refinement import PoseBox, expected_ranges
from robotd.localization.fit.refinement_settings import RefinementSettings, Walls
from robotd.localization.fit.tracking import NotHere, Tracked, TrackingSettings, track

SPEC = GridSpec(0.05, -2.0, 1.0, (130, 170))
DRAWN = RefinementSettings(walls=Walls.FACES, map_error_m=0.0, map_error_rad=0.0)
USUAL = TrackingSettings()
HALF_M, HALF_RAD = 0.3, math.radians(10.0)


def furnished(seed: int) -> tuple[WallField, Pose2]:
    """Return a room with furniture, and a pose at least 0.3 m from everything."""
    random = np.random.default_rng(seed)
    walls = np.ones(SPEC.shape, np.bool_)
    walls[8:-8, 8:-8] = False
    for row, col in random.integers((8, 8), (110, 150), (9, 2)).tolist():
        height, width = random.integers(4, 14, 2).tolist()
        walls[row : row + height, col : col + width] = True
    field = WallField.of(SPEC, walls, walls)
    row, col = random.choice(np.argwhere(field.codes > 36)).tolist()
    return field, Pose2(*SPEC.centre_of(row, col), float(random.uniform(-3.0, 3.0)))


def sweep_from(field: WallField, pose: Pose2, seed: int) -> NDArray[np.float64]:
    """Return 300 readings: sigma 2 cm, 5 % outliers, nothing beyond 6 m."""
    random = np.random.default_rng(seed)
    readings = np.zeros((300, 5))
    readings[:, 0] = math.tau * np.arange(300) / 300
    exact = expected_ranges(field, Readings(readings), np.array([[pose.x_m, pose.y_m, pose.heading_rad]]), 1).ranges_m[
        0
    ]
    short = np.where(random.random(300) < 0.05, random.uniform(0.2, 1.0, 300), 1.0)
    readings[:, 1] = np.maximum(exact * short + 0.02 * random.normal(size=300), 0.05)
    readings[:, 4] = readings[:, 1] > 6.0
    readings[:, 1] = np.minimum(readings[:, 1], 6.0)
    return readings


def somewhere_near(pose: Pose2, seed: int) -> Pose2:
    x, y, turn = np.random.default_rng(seed).uniform(-1.0, 1.0, 3).tolist()
    return Pose2(pose.x_m + HALF_M * x, pose.y_m + HALF_M * y, pose.heading_rad + HALF_RAD * turn)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32), st.integers(0, 2**32))
def test_within_0_3_m_and_10_degrees_the_robot_is_found_to_the_centimetre(room: int, seed: int) -> None:
    field, truth = furnished(room)
    prior = PoseBox.around(somewhere_near(truth, seed), HALF_M, HALF_RAD)
    found = track(field, Readings(sweep_from(field, truth, seed)), prior, USUAL, DRAWN)
    assert isinstance(found, Tracked)
    assert found.pose.distance_m(truth) < 0.012
    assert abs(math.remainder(found.pose.heading_rad - truth.heading_rad, math.tau)) < 0.005
    assert found.explained_share > 0.85
    assert found.explained.mean() == pytest.approx(found.explained_share)
    assert found.residual_m < 0.04


def test_the_mean_error_is_below_5_mm() -> None:
    errors_m = []
    for seed in range(60):
        field, truth = furnished(seed)
        prior = PoseBox.around(somewhere_near(truth, seed), HALF_M, HALF_RAD)
        found = track(field, Readings(sweep_from(field, truth, seed)), prior, USUAL, DRAWN)
        assert isinstance(found, Tracked)
        errors_m.append(found.pose.distance_m(truth))
    assert np.mean(errors_m) < 0.005


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32), st.integers(0, 2**32))
def test_the_pose_never_leaves_the_prior_box(room: int, seed: int) -> None:
    field, truth = furnished(room)
    x, y, turn = np.random.default_rng(seed).uniform(-1.0, 1.0, 3).tolist()
    start = Pose2(truth.x_m + x, truth.y_m + y, truth.heading_rad + turn)
    prior = PoseBox(
        start, Extent(start.x_m - 0.11, start.x_m + 0.3, start.y_m, start.y_m + 0.07, start.heading_rad, 9.0)
    )
    found = track(field, Readings(sweep_from(field, truth, seed)), prior, replace(USUAL, here_share=0.001), DRAWN)
    if isinstance(found, Tracked):
        assert found.pose.x_m - start.x_m + 1e-9 >= -0.11
        assert found.pose.x_m - start.x_m <= 0.3 + 1e-9
        assert -1e-9 <= found.pose.y_m - start.y_m <= 0.07 + 1e-9


def test_a_robot_that_is_2_m_aside_is_not_here() -> None:
    for seed in range(40):
        field, truth = furnished(seed)
        away_rad = 2.4 * seed
        aside = Pose2(truth.x_m + 2.0 * math.cos(away_rad), truth.y_m + 2.0 * math.sin(away_rad), truth.heading_rad)
        found = track(
            field, Readings(sweep_from(field, truth, seed)), PoseBox.around(aside, HALF_M, HALF_RAD), USUAL, DRAWN
        )
        assert isinstance(found, NotHere)
        assert found.explained_share < 0.6


def by_a_partition(seed: int) -> tuple[WallField, Pose2]:
    """Return a wide hall with a thin wall through it, and a pose so near to it that most readings end there."""
    random = np.random.default_rng(seed)
    walls = np.ones((300, 300), np.bool_)
    walls[3:-3, 3:-3] = False
    walls[150:153, :] = walls[:, 100:103] = True
    spec = GridSpec(0.05, 0.0, 0.0, walls.shape)
    row, col, heading_rad = random.uniform((142.0, 120.0, -3.0), (144.0, 150.0, 3.0)).tolist()
    return WallField.of(spec, walls, walls), Pose2(*spec.centre_of(row, col), heading_rad)


def test_where_the_back_of_a_wall_fits_as_well_the_pose_that_does_not_see_through_it_is_found() -> None:
    fooled = 0
    for seed in range(30):
        field, truth = by_a_partition(seed)
        readings = sweep_from(field, truth, seed)
        prior = PoseBox.around(somewhere_near(truth, seed), HALF_M, HALF_RAD)
        alone = track(field, Readings(readings), prior, replace(USUAL, rivals=0), DRAWN)
        fooled += isinstance(alone, Tracked) and abs(alone.pose.y_m - truth.y_m) > 0.1
        found = track(field, Readings(readings), prior, USUAL, DRAWN)
        assert isinstance(found, Tracked)
        assert abs(found.pose.y_m - truth.y_m) < 0.02
    assert fooled > 0


def test_a_box_of_one_pose_has_no_rivals() -> None:
    field, truth = furnished(3)
    found = track(
        field,
        Readings(sweep_from(field, truth, 3)),
        PoseBox.around(truth, 0.0, 0.0),
        replace(USUAL, settled_share=1.0),
        DRAWN,
    )
    assert isinstance(found, Tracked)
    assert found.pose.distance_m(truth) < 1e-9


@pytest.mark.parametrize("beams", [0, 11])
def test_too_few_readings_find_nobody(beams: int) -> None:
    field, truth = furnished(1)
    found = track(
        field, Readings(sweep_from(field, truth, 1)[:beams]), PoseBox.around(truth, HALF_M, HALF_RAD), USUAL, DRAWN
    )
    assert isinstance(found, NotHere)
    assert (found.best, found.explained_share, found.residual_m) == (None, 0.0, math.inf)


def test_misses_alone_find_nobody() -> None:
    field, truth = furnished(1)
    readings = sweep_from(field, truth, 1)
    readings[:, 4] = 1.0
    found = track(field, Readings(readings), PoseBox.around(truth, HALF_M, HALF_RAD), USUAL, DRAWN)
    assert isinstance(found, NotHere)
    assert found.best is None


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("step_cells", 0),
        ("step_rad", 0.0),
        ("heads", 0),
        ("explained_within_m", -1.0),
        ("unblocked_within_m", 0.0),
        ("blocked_by", 3),
        ("here_share", 0.0),
        ("settled_share", 1.1),
        ("rivals", -1),
        ("settled_residual_m", 0.0),
        ("readings_min", 0),
    ],
)
def test_impossible_settings_are_refused(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=name):
        replace(USUAL, **cast("dict[str, Any]", {name: value}))
