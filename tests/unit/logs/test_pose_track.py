"""Poses between poses: even in between, unknown where a moving robot said nothing for long."""

import pytest

from robotd.core.pose import Pose2
from robotd.logs.pose_track import PoseTrack

HERE, THERE = Pose2(0.0, 0.0, 3.0), Pose2(2.0, 0.0, -3.0)


def test_between_two_poses_it_turns_the_short_way() -> None:
    half = PoseTrack.of([(2.0, THERE), (1.0, HERE)]).at(1.5)
    assert half is not None
    assert half.x_m == 1.0
    assert abs(half.heading_rad) == pytest.approx(3.14159265, abs=1e-6)


def test_who_moved_and_said_nothing_for_long_is_nowhere_between() -> None:
    moved, stood = PoseTrack.of([(0.0, HERE), (5.0, THERE)]), PoseTrack.of([(0.0, HERE), (5.0, HERE)])
    assert moved.at(2.0) is None
    assert moved.at(5.0) == THERE
    assert stood.at(2.0) == HERE


def test_a_little_beyond_the_ends_it_is_where_it_was_and_no_farther() -> None:
    track = PoseTrack.of([(1.0, HERE), (1.5, THERE)])
    assert (track.at(0.95), track.at(1.55)) == (HERE, THERE)
    assert (track.at(0.8), track.at(1.7)) == (None, None)
    assert PoseTrack.of([]).at(1.0) is None
