"""Logs as other programs write them: each strange thing that was met, and those that are like it."""

import math

import numpy as np
import pytest

from robotd.core.errors import RecordingError
from robotd.core.pose import Pose2
from robotd.logs.carmen import parse_carmen
from robotd.logs.scan import PoseSource
from tests.support.carmen_room import (
    POSES,
    angles_rad,
    assert_the_room_is_seen,
    flaser,
    newer,
    ranges_m,
    remarks,
    robotlaser,
    text,
)


def with_range(line: str, beam: int, value: str) -> str:
    fields = line.split()
    fields[2 + beam] = value
    return " ".join(fields)


def test_a_plain_log_needs_no_remark() -> None:
    assert_the_room_is_seen(parse_carmen(flaser()))
    assert remarks(flaser()) == ""


@pytest.mark.parametrize("word", ["nan", "-nan", "NaN", "1.#QNAN", "-1.#IND", "1.#IND00", "-inf", "-1.#INF"])
def test_no_number_is_nothing_measured(word: str) -> None:
    log = parse_carmen([with_range(line, 7, word) for line in flaser()])
    assert_the_room_is_seen(log)
    assert not any(scan.hit[7] or scan.missed[7] for scan in log.scans)


@pytest.mark.parametrize("word", ["inf", "+inf", "Infinity", "1.#INF", "1.#J", "1.#INF00"])
def test_infinity_is_a_miss(word: str) -> None:
    log = parse_carmen([with_range(line, 7, word) for line in flaser()])
    assert_the_room_is_seen(log)
    assert all(scan.missed[7] and not scan.hit[7] and scan.missed.sum() == 1 for scan in log.scans)


@pytest.mark.parametrize("word", ["0", "-1", "-0.0", "0.006", "0.019"])
def test_zero_and_less_is_nothing_measured(word: str) -> None:
    log = parse_carmen([with_range(line, 7, word) for line in flaser()])
    assert not any(scan.hit[7] or scan.missed[7] for scan in log.scans)


@pytest.mark.parametrize(("count", "fov_deg"), [(541, 270.0), (769, 270.0), (1081, 270.0), (682, 239.4140625)])
def test_scanners_are_known_by_their_count_of_beams_and_that_is_said(count: int, fov_deg: float) -> None:
    lines = flaser(count=count, fov_deg=fov_deg)
    assert_the_room_is_seen(parse_carmen(lines))
    assert remarks(lines).startswith(
        f"{count} beams and no PARAM for them: taken for a scanner that sees {fov_deg:.4g}"
    )
    assert len(remarks(lines).splitlines()) == 1


@pytest.mark.parametrize("count", [180, 181, 360, 361])
def test_half_a_turn_is_what_these_always_see_and_needs_no_remark(count: int) -> None:
    lines = flaser(count=count)
    assert_the_room_is_seen(parse_carmen(lines))
    assert remarks(lines) == ""


def test_an_unknown_count_is_taken_for_half_a_turn_and_that_is_said_in_one_line() -> None:
    assert remarks(flaser(count=512)).splitlines() == [
        "512 beams and no PARAM for them: taken to span 180 deg; --fov-deg says what it is"
    ]


def test_the_caller_knows_best_what_the_scanner_sees() -> None:
    lines = ["PARAM laser_front_laser_fov 90 nohost 0", *flaser(count=513, fov_deg=240.0)]
    log = parse_carmen(lines, fov_rad=math.radians(240.0))
    assert_the_room_is_seen(log)
    assert not log.assumed


WITHOUT_STEP = (
    {"laser_front_laser_fov": "4.712389"},
    {"front_laser_fov": "270"},
    {"laser1_fov": "4.712389"},
    {"robot_frontlaser_fov": "270"},
)
WITH_STEP = (
    {"laser_front_laser_fov": "4.712389", "laser_front_laser_resolution": "0.5000"},
    {"laser_front_laser_fov": "270.0", "laser_front_laser_resolution": "0.0087266"},
    {"laser_front_laser_resolution": "0.5"},
    {"laser_laser1_fov": "270.0", "laser_laser1_resolution": "0.5"},
)


@pytest.mark.parametrize(
    ("params", "count"),
    [*((params, 541) for params in WITHOUT_STEP), *((params, count) for params in WITH_STEP for count in (540, 541))],
)
def test_param_lines_say_what_the_scanner_sees(params: dict[str, str], count: int) -> None:
    bearings = np.radians(-135.0 + 0.5 * np.arange(count))
    lines = [f"PARAM {name} {value} nohost 0" for name, value in params.items()]
    for pose in POSES:
        seen = " ".join(map(str, ranges_m(pose, bearings)))
        lines.append(f"FLASER {count} {seen} {text(pose)} {text(pose)} 0 h 0")
    log = parse_carmen(lines)
    assert_the_room_is_seen(log)
    assert not log.assumed


def test_settings_of_the_rear_scanner_are_not_those_of_the_front_one() -> None:
    lines = ["PARAM laser_rear_laser_fov 90 nohost 0", "PARAM laser_laser2_fov 90 nohost 0", *flaser()]
    assert_the_room_is_seen(parse_carmen(lines))
    rear = ["PARAM laser_front_laser_fov 90 h 0", "PARAM laser_rear_laser_fov 240 h 0", *flaser("RLASER", 513, 240.0)]
    assert_the_room_is_seen(parse_carmen(rear))


def test_a_pile_of_equal_greatest_values_is_a_code_and_said_in_one_line() -> None:
    coded = [
        " ".join(["5.60" if n % 6 == 2 and n < 182 else f for n, f in enumerate(line.split())]) for line in flaser()
    ]
    near = [
        " ".join([min(f, "5.60", key=float) if 1 < n < 182 else f for n, f in enumerate(line.split())])
        for line in coded
    ]
    log = parse_carmen(near)
    assert log.no_return_from_m == pytest.approx(5.6, abs=0.01)
    assert_the_room_is_seen(log)
    assert all(scan.missed[0] and scan.missed[6] for scan in log.scans)
    assert len(log.assumed) == 1
    assert "5.60 m on are the scanner's code" in log.assumed[0]


def test_a_code_below_a_code_is_found_too() -> None:
    lines = [
        " ".join(["81.83" if n == 9 else "7.9" if n % 5 == 2 and n < 182 else f for n, f in enumerate(line.split())])
        for line in flaser()
    ]
    nearer = [
        " ".join(
            [f if n < 2 or n > 181 or float(f) < 7.9 or float(f) > 80 else "7.9" for n, f in enumerate(line.split())]
        )
        for line in lines
    ]
    log = parse_carmen(nearer)
    assert log.no_return_from_m == pytest.approx(7.9, abs=0.01)
    assert all(scan.missed[7] for scan in log.scans)


@pytest.mark.parametrize("ranges", [[2.0] * 180, [1.0] + [2.0] * 179, [2.0, 3.0] * 2])
def test_few_ranges_and_such_as_are_nearly_all_the_same_are_no_code(ranges: list[float]) -> None:
    line = f"FLASER {len(ranges)} {' '.join(map(str, ranges))} {text(POSES[0])} {text(POSES[0])} 0 h 0"
    assert all(scan.hit.all() for scan in parse_carmen([line]).scans)


def test_a_range_that_no_scanner_has_is_a_miss() -> None:
    log = parse_carmen([with_range(line, 7, "1e300") for line in flaser()])
    assert_the_room_is_seen(log)
    assert all(scan.missed[7] for scan in log.scans)
    assert not log.assumed


def test_the_farthest_corner_seen_from_one_place_again_and_again_is_no_code() -> None:
    lines = flaser(poses=[POSES[0]] * 40)
    assert parse_carmen(lines).no_return_from_m == math.inf
    assert remarks(lines) == ""


@pytest.mark.parametrize("limit", ["0.00", "0", "-1", "nan", "inf"])
def test_a_largest_range_of_zero_is_none(limit: str) -> None:
    log = parse_carmen(robotlaser(limit=limit))
    assert_the_room_is_seen(log)
    assert not any(scan.missed.any() for scan in log.scans)


def test_zero_is_no_limit_in_a_param_either() -> None:
    assert_the_room_is_seen(parse_carmen(["PARAM robot_front_laser_max 0.0 h 0", *flaser()]))


@pytest.mark.parametrize("echoes", ["", "0", "3 1 2 3", f"180 {' '.join(['7'] * 180)}"])
def test_both_layouts_of_the_newer_records_are_told_apart_by_their_fields(echoes: str) -> None:
    assert_the_room_is_seen(parse_carmen(robotlaser(echoes=echoes)))


def test_a_line_that_lost_one_number_is_not_taken_for_the_other_layout() -> None:
    lines = robotlaser(echoes="0")
    fields = lines[4].split()
    lines[4] = " ".join(fields[:-9] + fields[-8:])
    log = parse_carmen(lines)
    assert_the_room_is_seen(log, len(POSES) - 1)
    assert [problem.line for problem in log.problems] == [5]


def test_a_clockwise_scan_is_the_same_scan_told_from_its_other_end() -> None:
    clockwise, counter = parse_carmen(robotlaser(clockwise=True)), parse_carmen(robotlaser())
    assert_the_room_is_seen(clockwise)
    for one, other in zip(clockwise.scans, counter.scans, strict=True):
        assert one.ranges_m.tolist() == other.ranges_m.tolist()
        assert one.angles_rad == pytest.approx(other.angles_rad, abs=1e-4)


def test_a_step_of_zero_is_computed_from_the_field_of_view_and_said() -> None:
    lines = [line.replace(" 0.017453 ", " 0.000000 ") for line in robotlaser()]
    assert_the_room_is_seen(parse_carmen(lines))
    assert remarks(lines).startswith("12 scans say that their beams are 0 deg apart")


@pytest.mark.parametrize("step", ["nan", "inf", "0.5", "-1.0"])
def test_a_step_that_no_scanner_has_is_damage(step: str) -> None:
    lines = robotlaser()
    lines[3] = lines[3].replace(" 0.017453 ", f" {step} ")
    log = parse_carmen(lines)
    assert_the_room_is_seen(log, len(POSES) - 1)
    assert str(log.problems[0]).startswith("line 4: ROBOTLASER1: no scanner has 180 beams")


def odom(pose: Pose2, time_s: float) -> str:
    return f"ODOM {text(pose)} 0 0 0 {time_s} nohost {time_s}"


def rawlaser() -> list[str]:
    return newer("RAWLASER1", lambda pose: "")


def test_scans_without_poses_have_those_of_the_odometry_about_them_and_are_marked() -> None:
    lines = [line for n, (p, raw) in enumerate(zip(POSES, rawlaser(), strict=True)) for line in (odom(p, n / 2), raw)]
    log = parse_carmen(lines)
    assert_the_room_is_seen(log)
    assert log.poses is PoseSource.RAW_ODOMETRY
    assert "RAW ODOMETRY" in remarks(lines)
    assert [scan.odometry for scan in log.scans] == [scan.robot_pose for scan in log.scans]


def test_a_scan_between_two_odometries_is_where_its_time_says() -> None:
    raw = rawlaser()[0].replace("0.0 nohost 0.0", "{} nohost 1")
    before, after = Pose2(1.0, 2.0, 3.0), Pose2(2.0, 4.0, -3.0)
    for time_s, share in ((10.25, 0.25), (9.0, 0.0), (99.0, 1.0), ("unknown", 0.0)):
        [scan] = parse_carmen([odom(before, 10.0), raw.format(time_s), odom(after, 11.0)]).scans
        assert (scan.robot_pose.x_m, scan.robot_pose.y_m) == pytest.approx((1.0 + share, 2.0 + 2 * share))
        turned_rad = math.remainder(scan.robot_pose.heading_rad - 3.0, math.tau)
        assert turned_rad == pytest.approx(share * (math.tau - 6.0))


def test_clocks_that_stand_still_or_jump_leave_the_odometry_before_the_scan() -> None:
    raw = rawlaser()[0]
    for times in ((5.0, 5.0), (7.0, 1.0)):
        [scan] = parse_carmen([odom(POSES[1], times[0]), raw, odom(POSES[2], times[1])]).scans
        assert scan.robot_pose.x_m == pytest.approx(POSES[1].x_m)
    [scan] = parse_carmen([raw, odom(POSES[2], 1.0)]).scans
    assert scan.robot_pose.x_m == pytest.approx(POSES[2].x_m)


def test_scans_without_poses_and_without_odometry_are_refused() -> None:
    with pytest.raises(RecordingError, match="RAWLASER1 has no poses, and there is no ODOM"):
        parse_carmen(rawlaser())


def test_a_rear_scanner_alone_is_read() -> None:
    assert_the_room_is_seen(parse_carmen(flaser("RLASER")))
    rear = [line.replace("ROBOTLASER1", "ROBOTLASER2") for line in robotlaser()]
    assert_the_room_is_seen(parse_carmen(rear))


def test_a_rear_scanner_looks_back() -> None:
    [line] = flaser("RLASER", poses=POSES[:1])
    fields = line.split()
    laser = Pose2(2.0, 3.0, 0.5)
    robot = laser @ Pose2(-0.3, 0.0, math.pi).inverse()
    fields[182:188] = f"{text(laser)} {text(robot)}".split()
    [scan] = parse_carmen([" ".join(fields)]).scans
    assert scan.laser_pose.distance_m(laser) < 1e-4
    assert scan.robot_pose.distance_m(robot) < 1e-4
    assert abs(math.remainder(scan.robot_pose.heading_rad - robot.heading_rad, math.tau)) < 1e-4


def test_of_front_and_rear_the_front_one_is_taken() -> None:
    log = parse_carmen([line for pair in zip(flaser("RLASER", 60), flaser(), strict=True) for line in pair])
    assert {len(scan.ranges_m) for scan in log.scans} == {180}


def test_comments_blank_lines_and_other_records_are_no_damage() -> None:
    noise = [
        "# FLASER 3",
        "#FLASER 4 x",
        "",
        "   ",
        "SYNC tag 1 h 1",
        "NEFF 15",
        "TRUEPOS 1 2 3",
        "# \xe9\x00\xff",
        "PARAM a",
    ]
    assert remarks([*noise, *flaser(), *noise]) == ""
    assert_the_room_is_seen(parse_carmen([*noise, *flaser()]))


def test_where_the_laser_sits_is_taken_from_the_records_if_no_param_says_it() -> None:
    mount = Pose2(0.2, 0.05, 0.0)
    lines = []
    for line, pose in zip(flaser(), POSES, strict=True):
        lines.append(line.replace(f"{text(pose)} {text(pose)}", f"{text(pose)} {text(pose @ mount.inverse())}"))
    for scan, pose in zip(parse_carmen(lines).scans, POSES, strict=True):
        assert scan.laser_pose.distance_m(pose) < 1e-4
        assert scan.robot_pose.distance_m(pose @ mount.inverse()) < 1e-4


def test_ranges_beyond_what_is_believed_are_misses() -> None:
    log = parse_carmen(flaser())
    cut = log.believed_to(2.0)
    for whole, scan in zip(log.scans, cut.scans, strict=True):
        assert scan.missed.tolist() == (whole.ranges_m > 2.0).tolist()
        assert not (scan.hit & scan.missed).any()
    assert angles_rad().tolist() == pytest.approx(cut.scans[0].angles_rad.tolist())
