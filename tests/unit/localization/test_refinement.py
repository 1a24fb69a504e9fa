import math

import numpy as np
import pytest
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.grid.spec import GridSpec
from robotd.grid.wall_field import WallField
from robotd.localization.refinement import (
    PoseBox,
    RefinedPoses,
    RefinementSettings,
    Walls,
    expected_ranges,
    refine,
)

SPEC = GridSpec(0.05, -1.0, 2.0, (120, 150))
DRAWN = RefinementSettings(walls=Walls.FACES, map_error_m=0.0, map_error_rad=0.0)
MIDDLE = Pose2(2.0, 4.6, 0.3)


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
    exact = expected_ranges(field, readings, np.array([[pose.x_m, pose.y_m, pose.heading_rad]]), 1).ranges_m[0]
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
    refined = refine(field, sweep_from(field, MIDDLE), [PoseBox.around(moved(MIDDLE, *away), 0.3, 0.1)], DRAWN)
    error_m, error_rad = error_of(refined, MIDDLE)
    assert error_m < 0.001
    assert error_rad < 0.0005


def test_all_boxes_are_refined_in_one_call_as_they_would_be_one_by_one() -> None:
    field = field_of(room())
    readings = sweep_from(field, MIDDLE, sigma_m=0.02, outliers=0.1)
    boxes = [PoseBox.around(moved(MIDDLE, 0.03 * k, -0.02 * k, 0.01 * k), 0.1, 0.03) for k in range(5)]
    together = refine(field, readings, boxes, DRAWN)
    for number, box in enumerate(boxes):
        alone = refine(field, readings, [box], DRAWN)
        np.testing.assert_array_equal(together.poses[number], alone.poses[0])
        np.testing.assert_array_equal(together.covariances[number], alone.covariances[0])
        np.testing.assert_array_equal(together.beyond_m[number], alone.beyond_m[0])


def test_a_short_reading_lies_short_of_the_walls_and_a_miss_lies_nowhere() -> None:
    field = field_of(room())
    readings = sweep_from(field, MIDDLE)
    readings[7, 1] -= 0.1
    readings[9, 4] = 1.0
    refined = refine(field, readings, [PoseBox.around(MIDDLE, 0.05, 0.02)], DRAWN)
    assert refined.beyond_m[0, 7] < -0.05
    assert math.isnan(refined.beyond_m[0, 9])
    assert abs(refined.beyond_m[0, 8]) < 0.01


def test_ranges_are_expected_to_the_sides_of_cells() -> None:
    field = field_of(room())
    readings = np.zeros((2, 5))
    readings[:, 0] = (0.0, math.pi)
    ranges = expected_ranges(field, readings, np.array([[2.0, 4.6, 0.0]]), 1)
    np.testing.assert_allclose(
        ranges.ranges_m[0], (SPEC.origin_x_m + 130 * 0.05 - 2.0, 2.0 - (SPEC.origin_x_m + 12 * 0.05))
    )
    assert ranges.ends.all()
