import gzip
import itertools
import math
from pathlib import Path

import numpy as np
import pytest

from robotd.core.errors import RecordingError
from robotd.core.pose import Pose2
from robotd.logs.carmen import parse_carmen
from robotd.logs.scan import RecordedLog
from robotd.sim.buildings.log_file import read_log

BEARINGS = {4: (-90, -45, 0, 45), 5: (-90, -45, 0, 45, 90)}


def flaser(ranges: list[float], laser: Pose2, odom: Pose2 | None = None, time: float = 1.0) -> str:
    odom = odom or laser
    poses = (laser.x_m, laser.y_m, laser.heading_rad, odom.x_m, odom.y_m, odom.heading_rad)
    return f"FLASER {len(ranges)} {' '.join(map(str, ranges))} {' '.join(map(str, poses))} {time} host {time}"


def odom(pose: Pose2, time: float = 1.0) -> str:
    return f"ODOM {pose.x_m} {pose.y_m} {pose.heading_rad} 0 0 0 {time} host {time}"


def test_a_plain_log_is_read() -> None:
    log = parse_carmen(["# a comment", "", flaser([1.0, 2.0, 3.0, 4.0], Pose2(1.0, 2.0, 0.5)), "SYNC now 1 host 1"])
    [scan] = log.scans
    assert scan.robot_pose == scan.laser_pose == scan.odometry == Pose2(1.0, 2.0, 0.5)
    assert scan.ranges_m.tolist() == [1.0, 2.0, 3.0, 4.0]
    assert scan.hit.all()
    assert not scan.missed.any()


@pytest.mark.parametrize("count", [4, 5])
def test_beams_begin_at_the_robots_right_and_their_step_depends_on_parity(count: int) -> None:
    [scan] = parse_carmen([flaser([1.0] * count, Pose2(0.0, 0.0, 0.0))]).scans
    assert np.degrees(scan.angles_rad) == pytest.approx(BEARINGS[count])


def test_real_scanners_have_half_and_whole_degree_steps() -> None:
    for count, step_deg in ((180, 1.0), (181, 1.0), (360, 0.5), (361, 0.5)):
        [scan] = parse_carmen([flaser([1.0] * count, Pose2(0.0, 0.0, 0.0))]).scans
        assert math.degrees(scan.angles_rad[1] - scan.angles_rad[0]) == pytest.approx(step_deg)


def test_the_robot_is_the_laser_moved_back_by_its_offset() -> None:
    lines = ["PARAM robot_frontlaser_offset -0.04 1.0 host 1.0", flaser([1.0] * 4, Pose2(1.0, 2.0, math.pi / 2))]
    [scan] = parse_carmen(lines).scans
    assert (scan.robot_pose.x_m, scan.robot_pose.y_m) == pytest.approx((1.0, 2.04))
    assert (scan.laser_pose.x_m, scan.laser_pose.y_m) == pytest.approx((1.0, 2.0))


@pytest.mark.parametrize("code", [81.83, 81.91, 50.0, 51.1, 32.76])
def test_codes_for_nothing_came_back_are_misses_in_every_log(code: float) -> None:
    log = parse_carmen([flaser([1.0, code, code - 0.06, 25.0], Pose2(0.0, 0.0, 0.0))])
    [scan] = log.scans
    assert scan.missed.tolist() == [False, True, True, False]
    assert scan.hit.tolist() == [True, False, False, True]


def test_a_log_that_names_its_largest_range_is_believed() -> None:
    lines = ["PARAM robot_front_laser_max 20.0 1 host 1", flaser([1.0, 19.9, 20.0, 25.0], Pose2(0.0, 0.0, 0.0))]
    assert parse_carmen(lines).scans[0].missed.tolist() == [False, False, True, True]


def test_a_short_sighted_scanner_that_uses_no_codes_keeps_its_largest_range() -> None:
    assert parse_carmen([flaser([1.0, 2.0, 5.5, 5.5], Pose2(0.0, 0.0, 0.0))]).scans[0].hit.all()


def test_a_range_of_zero_is_neither_hit_nor_miss() -> None:
    [scan] = parse_carmen([flaser([0.0, 1.0, 1.0, 1.0], Pose2(0.0, 0.0, 0.0))]).scans
    assert (scan.hit[0], scan.missed[0]) == (False, False)


def test_time_that_runs_backwards_changes_nothing_and_headings_are_wrapped() -> None:
    log = parse_carmen(
        [flaser([1.0] * 4, Pose2(float(x), 0.0, 7.0), time=time) for x, time in ((1, 5.0), (2, 3.0), (3, 3.0))]
    )
    assert [scan.robot_pose.x_m for scan in log.scans] == [1.0, 2.0, 3.0]
    assert log.scans[0].robot_pose.heading_rad == pytest.approx(7.0 - math.tau)


def corrected_log() -> RecordedLog:
    """Two steps of raw odometry, 1 m ahead and 1 m ahead with a quarter turn; corrected to something else each time."""
    step, turn = Pose2(1.0, 0.0, 0.0), Pose2(1.0, 0.0, math.pi / 2)
    first, second, third = Pose2(0.0, 0.0, 0.1), Pose2(1.1, 0.2, 0.2), Pose2(2.3, 0.1, 1.5)
    lines = [
        "PARAM robot_frontlaser_offset 0.1 1 host 1",
        odom(first),
        *(flaser([1.0] * 4, first), odom(first, 0.0), "NEFF 15"),
        odom(first @ Pose2(0.4, 0.0, 0.0)),
        odom(first @ step),
        *(flaser([1.0] * 4, second), odom(second, 6.5e-43), "NEFF 15"),
        odom(second @ turn),
        *(flaser([1.0] * 4, third), odom(third, -0.95), "NEFF 15"),
    ]
    return parse_carmen(lines)


def test_raw_odometry_is_chained_out_of_a_corrected_log() -> None:
    log = corrected_log()
    lasers = [scan.odometry @ scan.robot_from_laser for scan in log.scans]
    steps = [before.inverse() @ after for before, after in itertools.pairwise(lasers)]
    assert (steps[0].x_m, steps[0].y_m, steps[0].heading_rad) == pytest.approx((1.0, 0.0, 0.0))
    assert (steps[1].x_m, steps[1].y_m, steps[1].heading_rad) == pytest.approx((1.0, 0.0, math.pi / 2))


def test_corrected_poses_stay_what_the_log_says() -> None:
    assert [scan.laser_pose.x_m for scan in corrected_log().scans] == pytest.approx([0.0, 1.1, 2.3])


def test_raw_odometry_of_a_raw_log_is_the_robots_own() -> None:
    lines = []
    for x in (0.0, 1.0, 2.0):
        lines += [odom(Pose2(x - 0.1, 0.0, 0.0)), flaser([1.0] * 4, Pose2(x - 0.04, 0.0, 0.0), Pose2(x, 0.0, 0.0))]
    assert [scan.odometry.x_m for scan in parse_carmen(lines).scans] == [0.0, 1.0, 2.0]


def test_newer_logs_carry_angles_largest_range_and_both_poses() -> None:
    line = (
        "ROBOTLASER1 4 -0.5 1.0 0.25 30.0 0.01 0 4 1.0 2.0 30.0 31.0 2 7 8 1.1 2.0 0.5 1.0 2.0 0.5 0 0 0.3 0.2 1 5 h 5"
    )
    [scan] = parse_carmen([line]).scans
    assert scan.angles_rad == pytest.approx([-0.5, -0.25, 0.0, 0.25])
    assert scan.missed.tolist() == [False, False, True, True]
    assert scan.robot_pose == scan.odometry == Pose2(1.0, 2.0, 0.5)
    assert scan.laser_pose.x_m == pytest.approx(1.1)


def test_a_scan_that_is_there_twice_is_taken_once() -> None:
    robotlaser = "ROBOTLASER1 4 -0.5 1.0 0.25 30.0 0.01 0 4 1.0 2.0 3.0 4.0 0 1 2 0.5 1 2 0.5 0 0 0.3 0.2 1 5 h 5"
    poses = [Pose2(1.0, 0.0, 0.0), Pose2(2.0, 0.0, 0.0)]
    log = parse_carmen([line for pose in poses for line in (flaser([1.5] * 4, pose), robotlaser)])
    assert [scan.laser_pose for scan in log.scans] == poses


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("FLASER 4 1.0 2.0", "FLASER: 4 numbers are announced, 2 follow"),
        ("FLASER 4 1.0 x 1 1 0 0 0 0 0 0 1 h 1", "FLASER: 'x' is no number"),
        ("FLASER 4 1.0 1.0 1 1 0 0 inf 0 0 0 1 h 1", "FLASER: 0 0 inf is no pose"),
        ("FLASER 4 1.0 1.0 1 1 0 0", "FLASER: 4 ranges are announced, and 2 fields follow them, not 9"),
        ("FLASER 1 1.0 0 0 0 0 0 0 1 h 1", "FLASER: a scan of 1 beams"),
        ("FLASER 0 0 0 0 0 0 0 1 h 1", "FLASER: a scan of 0 beams"),
        ("FLASER -2 1.0 1.0 0 0 0 0 0 0", "FLASER: -2 numbers"),
        ("FLASER", "FLASER: '' is no count"),
        ("ODOM 1 2", "ODOM: the line ends within a pose: 2 of 3 numbers"),
        ("ROBOTLASER1 4 -0.5 1.0", "ROBOTLASER1: '' is no count"),
        (
            "RAWLASER1 4 -0.5 1.0 0.1 80 0.1 0 2 1 1 0 1 h",
            "RAWLASER1: 2 ranges are announced, and 3 fields",
        ),
        ("1.23 4.5", "begins with a number"),
    ],
)
def test_damage_is_left_out_and_named_with_its_line(line: str, complaint: str) -> None:
    log = parse_carmen([flaser([1.0] * 4, Pose2(0.0, 0.0, 0.0)), line])
    assert len(log.scans) == 1
    [problem] = log.problems
    assert problem.line == 2
    assert problem.message.startswith(complaint)
    assert "; expected " in problem.message or line[0] == "1"


def test_a_file_without_scans_is_no_log() -> None:
    with pytest.raises(RecordingError, match="is this a CARMEN log"):
        parse_carmen(["hello", "world"])


@pytest.mark.real_data
@pytest.mark.parametrize(("place", "scans", "beams"), [("intel", 910, 180), ("fr079", 4791, 360)])
def test_the_real_logs_hold_what_is_known_of_them(laser_data: Path, place: str, scans: int, beams: int) -> None:
    log = read_log(laser_data / place / f"{place}.corrected.log.gz")
    assert len(log.scans) == scans
    assert {len(scan.ranges_m) for scan in log.scans} == {beams}
    assert 80.0 < log.no_return_from_m < 81.83
    assert max(float(scan.ranges_m[scan.hit].max(initial=0.0)) for scan in log.scans) < 40.0


@pytest.mark.real_data
@pytest.mark.parametrize("place", ["intel", "fr079"])
def test_raw_odometry_chained_from_the_corrected_log_is_that_of_the_raw_log(laser_data: Path, place: str) -> None:
    chained = read_log(laser_data / place / f"{place}.corrected.log.gz")
    rows = gzip.decompress((laser_data / place / "derived_poses.csv.gz").read_bytes()).decode().splitlines()[1:]
    nodes = [[float(value) for value in row.split(",")] for row in rows if row.endswith(",1")]
    raw = [Pose2(*node[4:7]) for node in nodes]
    assert len(raw) == len(chained.scans)
    for index in range(1, len(raw)):
        expected = raw[index - 1].inverse() @ raw[index]
        found = chained.scans[index - 1].odometry.inverse() @ chained.scans[index].odometry
        assert found.distance_m(expected) < 0.002
        assert abs(math.remainder(found.heading_rad - expected.heading_rad, math.tau)) < 0.002
