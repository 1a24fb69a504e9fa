"""Raw odometry is known for what it is where nobody came by again, whatever the log says of where its scanner sits."""

import math

import pytest

from robotd.core.pose import Pose2
from robotd.logs.carmen import parse_carmen
from robotd.logs.scan import PoseSource
from tests.support.carmen_room import POSES, angles_rad, assert_the_room_is_seen, ranges_m, text

MOUNTS = {"FLASER": Pose2(0.3, 0.0, 0.0), "RLASER": Pose2(-0.3, 0.0, math.pi)}
PARAMS = {"FLASER": "PARAM robot_frontlaser_offset 0.25 h 0", "RLASER": "PARAM robot_rearlaser_offset 0.25 h 0"}


def raw_log(word: str, mount: Pose2, *, order: str, own: bool) -> list[str]:
    """A robot that goes once through the room; ``own`` logs tell the robot's pose, others the laser's twice."""
    lines = []
    for number, laser in enumerate(POSES):
        robot = laser @ mount.inverse()
        seen = " ".join(map(str, ranges_m(laser, angles_rad())))
        odom = f"ODOM {text(robot)} 0 0 0 {number} h {number}"
        scan = f"{word} 180 {seen} {text(laser)} {text(robot if own else laser)} {number} h {number}"
        lines += [odom, scan] if order == "before" else [scan, odom]
    return lines


@pytest.mark.parametrize("own", [True, False], ids=["robot and laser", "laser twice"])
@pytest.mark.parametrize("order", ["before", "after"])
@pytest.mark.parametrize("has_mount", [True, False], ids=["ahead or behind", "in the middle"])
@pytest.mark.parametrize("has_param", [True, False], ids=["a PARAM that is wrong", "no PARAM"])
@pytest.mark.parametrize("word", MOUNTS)
def test_poses_that_move_with_the_odometry_are_raw(
    word: str, has_param: bool, has_mount: bool, order: str, own: bool
) -> None:
    mount = MOUNTS[word] if has_mount else Pose2(0.0, 0.0, 0.0)
    log = parse_carmen([PARAMS[word]] * has_param + raw_log(word, mount, order=order, own=own))
    assert_the_room_is_seen(log)
    assert log.poses is PoseSource.RAW_ODOMETRY
    assert "ODOM lines around them" in log.why


@pytest.mark.parametrize("word", MOUNTS)
def test_poses_that_drift_away_from_the_odometry_are_not(word: str) -> None:
    lines = []
    for number, laser in enumerate(POSES):
        odometry = laser @ Pose2(0.05 * number, 0.0, 0.03 * number)
        seen = " ".join(map(str, ranges_m(laser, angles_rad())))
        lines.append(f"ODOM {text(odometry)} 0 0 0 {number} h {number}")
        lines.append(f"{word} 180 {seen} {text(laser)} {text(laser)} {number} h {number}")
    assert parse_carmen(lines).poses is PoseSource.LOG


@pytest.mark.parametrize("word", MOUNTS)
def test_a_copy_behind_each_scan_beside_another_odometry_is_the_mark_of_a_corrected_log(word: str) -> None:
    lines = []
    for number, laser in enumerate(POSES):
        odometry = laser @ Pose2(0.05 * number, 0.0, 0.03 * number)
        seen = " ".join(map(str, ranges_m(laser, angles_rad())))
        lines.append(f"ODOM {text(odometry)} 0 0 0 {number} h {number}")
        lines.append(f"{word} 180 {seen} {text(laser)} {text(laser)} {number} h {number}")
        lines.append(f"ODOM {text(laser)} 0 0 0 {number} h {number}")
    assert parse_carmen(lines).poses is PoseSource.CORRECTED
