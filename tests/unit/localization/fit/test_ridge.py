"""How well walls hold a pose: all round in a room, and not at all along a wall."""

import numpy as np
import pytest

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.wall_field import WallField
from robotd.localization.fit.agreement import agreement, agreements
from robotd.localization.fit.refinement import PoseBox
from robotd.localization.fit.refinement_settings import RefinementSettings, Walls
from robotd.localization.fit.ridge import ridge_of
from tests.support.surveyed_room import room, sweep_at

WALLS = room()
VACANT = WALLS.codes > 0
HERE = Pose2(2.0, 3.0, 0.4)
SWEEP = sweep_at(WALLS, HERE, np.random.default_rng(1))
DRAWN = RefinementSettings(walls=Walls.FACES)
BOX = PoseBox.around(Pose2(HERE.x_m + 0.2, HERE.y_m - 0.1, HERE.heading_rad), 0.5, 0.05)


def hall() -> WallField:
    """Return one of 24 m x 18 m, with nothing in it."""
    solid = np.ones((400, 520), np.bool_)
    solid[20:-20, 20:-20] = False
    return WallField.of(GridSpec(0.05, -1.0, -1.0, solid.shape), solid, solid)


def test_a_room_holds_a_pose_in_all_directions() -> None:
    pose, scatter = ridge_of(WALLS, VACANT, SWEEP, BOX, DRAWN)
    assert pose.distance_m(HERE) < 0.02
    assert np.sqrt(np.diag(scatter)[:2]).max() < 0.02


def test_a_wall_holds_it_across_and_leaves_the_box_along() -> None:
    walls, here = hall(), Pose2(3.0, 9.0, 0.2)
    seen = sweep_at(walls, here, np.random.default_rng(3))
    box = PoseBox.around(Pose2(3.1, 9.1, 0.2), 0.5, 0.05)
    pose, scatter = ridge_of(walls, walls.codes > 0, seen, box, DRAWN)
    across_m, along_m = np.sqrt(np.diag(scatter)[:2])
    assert pose.x_m == pytest.approx(here.x_m, abs=0.03)
    assert across_m < 0.05
    # As of any place between the ends of the box: half its width by the root of three.
    assert pose.y_m == pytest.approx(box.start.y_m, abs=0.05)
    assert along_m == pytest.approx(0.5 / np.sqrt(3.0), rel=0.2)


def test_misses_have_no_say() -> None:
    hits = SWEEP[SWEEP.is_hit]
    assert 0 < len(hits) < len(SWEEP)
    one, other = (ridge_of(WALLS, VACANT, readings, BOX, DRAWN) for readings in (SWEEP, hits))
    assert one[0] == other[0]
    assert one[1] == pytest.approx(other[1])


def test_what_a_map_says_at_many_poses_is_what_it_says_at_each() -> None:
    random = np.random.default_rng(2)
    poses = np.array([HERE.x_m, HERE.y_m, HERE.heading_rad]) + random.normal(0.0, 0.2, (20, 3))
    explained, contradicted = agreements(WALLS, VACANT, SWEEP, poses)
    for number, pose in enumerate(poses.tolist()):
        alone = agreement(WALLS, VACANT, SWEEP, Pose2(*pose))
        assert alone.explained.tolist() == explained[number].tolist()
        assert alone.contradicted.tolist() == contradicted[number].tolist()
