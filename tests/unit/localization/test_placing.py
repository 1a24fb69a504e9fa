import math

import numpy as np
import pytest

from robotd.contract.area import Area
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.readings import Readings
from robotd.grid.settings import GridSettings
from robotd.grid.wall_field import WallField
from robotd.localization.outcome import Outcome
from robotd.localization.placing import (
    Believed,
    Ground,
    PlacingSettings,
    found_within,
    place,
)
from robotd.localization.settings import LocalizationSettings
from tests.support.surveyed_room import SPEC, room, sweep_at

WALLS = room()
HERE = Pose2(2.0, 3.0, 0.4)
COVARIANCE = np.diag([0.1**2, 0.1**2, 0.07**2])
USUAL = PlacingSettings()


def ground_of(*poses: Pose2, seed: int = 0) -> Ground:
    """Return the map that sweeps at poses make."""
    random = np.random.default_rng(seed)
    grid = OccupancyGrid(SPEC, settings=GridSettings(raise_alpha=0.5, lower_alpha=0.9))
    for pose in poses:
        grid.lay(sweep_at(WALLS, pose, random), pose)
    return Ground(grid, LocalizationSettings())


def seen_from(pose: Pose2, seed: int = 7) -> Readings:
    return sweep_at(WALLS, pose, np.random.default_rng(seed))


def rooms_alike() -> WallField:
    """Return two rooms of 7 m x 6 m, each with a doorway in the wall between them, which is a metre thick."""
    walls = np.ones((140, 340), np.bool_)
    for west in (20, 180):
        walls[10:130, west : west + 140] = False
    walls[54:82, 160:180] = False
    return WallField.of(GridSpec(0.05, -1.0, -0.5, walls.shape), walls, walls)


def off(pose: Pose2, other: Pose2) -> tuple[float, float]:
    return pose.distance_m(other), abs(math.remainder(pose.heading_rad - other.heading_rad, math.tau))


def test_a_sweep_is_placed_where_it_was_taken_and_surer_than_odometry() -> None:
    prior = Believed(HERE @ Pose2(0.12, -0.1, 0.08), COVARIANCE)
    placed = place(ground_of(HERE, Pose2(3.0, 2.0, 0.0)), seen_from(HERE), prior, USUAL)
    assert placed.outcome is Outcome.PLACED
    far_m, far_rad = off(placed.believed.pose, HERE)
    assert far_m < 0.03
    assert far_rad < 0.015
    assert placed.believed.deviation_m < prior.deviation_m / 2
    assert placed.agreement.consent > 0.9


@pytest.mark.parametrize("off_m", [-0.1, 0.0, 0.1])
def test_along_the_wall_of_a_hall_odometry_has_the_say_and_nobody_is_sure(off_m: float) -> None:
    """A wall that goes on where nobody has looked drew each sweep back to where the map ended, by 24 cm, sure to 4."""
    spec, random = GridSpec(0.05, -1.0, -1.0, (280, 640)), np.random.default_rng(0)
    solid = np.ones(spec.shape, np.bool_)
    solid[20:-20, 20:-20] = False
    hall = WallField.of(spec, solid, solid)
    grid = OccupancyGrid(spec, settings=GridSettings(raise_alpha=0.5, lower_alpha=0.9))
    for x_m in (9.0, 12.0):
        grid.lay(sweep_at(hall, Pose2(x_m, 8.0, 1.0), random), Pose2(x_m, 8.0, 1.0))
    here = Pose2(15.4, 8.0, 0.4)
    prior = Believed(Pose2(15.4 + off_m, 7.9, 0.42), np.diag([0.25**2, 0.25**2, 0.15**2]))
    placed = place(Ground(grid, LocalizationSettings()), sweep_at(hall, here, random), prior, USUAL)
    assert placed.outcome is Outcome.PLACED
    assert placed.believed.pose.x_m == pytest.approx(prior.pose.x_m, abs=0.05)
    assert placed.believed.pose.y_m == pytest.approx(here.y_m, abs=0.05)
    assert placed.believed.deviation_m > 0.15
    assert math.sqrt(placed.believed.covariance[1, 1]) < 0.1


def test_where_odometry_is_far_off_it_is_found_by_looking_wider() -> None:
    prior = Believed(HERE @ Pose2(1.1, 0.9, 0.5), COVARIANCE)
    placed = place(ground_of(HERE, Pose2(3.0, 2.0, 0.0)), seen_from(HERE), prior, USUAL)
    assert placed.outcome is Outcome.WIDE
    assert off(placed.believed.pose, HERE)[0] < 0.05


def test_new_ground_is_no_contradiction_and_odometry_stands() -> None:
    far = Pose2(10.5, 1.0, 0.0)
    prior = Believed(far, COVARIANCE)
    placed = place(ground_of(HERE), seen_from(far), prior, USUAL)
    assert placed.outcome is Outcome.NEW_GROUND
    assert placed.believed.pose == far
    assert placed.believed.covariance == pytest.approx(2.0 * COVARIANCE)
    assert placed.agreement.contradicted_share < 0.12


@pytest.mark.parametrize("heading_rad", [-0.6, -0.01, 0.1, 0.7])
def test_a_room_seen_through_a_doorway_does_not_draw_in_a_stop_of_the_next_one_that_is_like_it(
    heading_rad: float,
) -> None:
    walls, random = rooms_alike(), np.random.default_rng(1)
    grid = OccupancyGrid(walls.spec, settings=GridSettings(raise_alpha=0.5, lower_alpha=0.9))
    for x_m, y_m in ((1.2, 1.6), (3.4, 2.9), (2.5, 4.6), (5.6, 2.9)):
        grid.lay(sweep_at(walls, Pose2(x_m, y_m, 0.0), random), Pose2(x_m, y_m, 0.0))
    there = Pose2(9.2, 2.9, heading_rad)
    prior = Believed(there, np.diag([0.31**2, 0.31**2, 0.6**2]))  # after four metres and a turn
    placed = place(Ground(grid, LocalizationSettings()), sweep_at(walls, there, random), prior, USUAL)
    assert off(placed.believed.pose, there)[0] < 0.3


def test_a_sweep_of_somewhere_else_contradicts_and_leaves_odometrys_word() -> None:
    ground = ground_of(*(Pose2(x, y, 0.0) for x in (1.0, 2.5, 4.0) for y in (1.3, 4.3, 7.5)))
    elsewhere = Readings(np.column_stack((np.arange(300) * math.tau / 300, np.full(300, 3.0), *np.zeros((3, 300)))))
    prior = Believed(Pose2(2.5, 4.3, 0.0), COVARIANCE)
    placed = place(ground, elsewhere, prior, USUAL)
    assert placed.outcome is Outcome.CONTRADICTS
    assert placed.believed.pose == prior.pose
    assert placed.agreement.contradicted_share > 0.4


def test_with_too_few_readings_odometry_stands() -> None:
    placed = place(ground_of(HERE), seen_from(HERE)[:11], Believed(HERE, COVARIANCE), USUAL)
    assert placed.outcome is Outcome.NEW_GROUND


def test_along_a_corridor_odometry_has_the_say() -> None:
    cells = np.full(SPEC.shape, 60, np.uint8)
    cells[[82, 117]] = 250  # two straight walls, 1.75 m apart, as long as the map
    bearings = np.linspace(-1.0, 1.0, 150)
    bearings = np.concatenate((bearings - math.pi / 2, bearings + math.pi / 2))
    ranges_m = 0.875 / np.abs(np.sin(bearings))
    corridor = Readings(np.column_stack((bearings, ranges_m, *np.zeros((3, 300)))))
    ground = Ground(OccupancyGrid(SPEC, cells), LocalizationSettings())
    prior = Believed(Pose2(3.43, 4.1, 0.03), COVARIANCE)
    placed = place(ground, corridor, prior, USUAL)
    assert placed.outcome is Outcome.PLACED
    assert placed.believed.pose.x_m == pytest.approx(3.43, abs=0.05)
    assert placed.believed.pose.y_m == pytest.approx(4.0, abs=0.03)
    assert placed.believed.covariance[0, 0] > 4.0 * placed.believed.covariance[1, 1]


def test_a_place_is_found_within_a_disk_or_not_at_all() -> None:
    ground = ground_of(HERE, Pose2(3.0, 2.0, 0.0), Pose2(2.5, 4.8, 0.0))
    found = found_within(ground, seen_from(HERE), Area(2.4, 2.4, 1.5), (0.0, 0.7), 0.5)
    assert found is not None
    assert off(found.pose, HERE)[0] < 0.05
    assert found_within(ground, seen_from(Pose2(9.0, 6.5, 2.0)), Area(2.4, 2.4, 1.5), (0.0, 0.7), 0.5) is None


def test_fusing_takes_each_direction_by_how_sure_it_is() -> None:
    prior = Believed(Pose2(0.0, 0.0, 3.1), np.diag([0.01, 0.04, 0.01]))
    fused = prior.fused(Pose2(0.3, 0.3, -3.1), np.diag([1e6, 1e-9, 0.01]))
    assert fused.pose.x_m == pytest.approx(0.0, abs=1e-4)
    assert fused.pose.y_m == pytest.approx(0.3, abs=1e-4)
    assert abs(fused.pose.heading_rad) == pytest.approx(math.pi, abs=1e-6)  # across pi, not through 0
    assert np.diag(fused.covariance) == pytest.approx([0.01, 0.0, 0.005], abs=1e-4)
