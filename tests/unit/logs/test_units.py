"""Ranges and poses that are no metres, and angles that are no radians, are refused with the unit they likely are."""

import numpy as np
import pytest

from robotd.core.errors import RecordingError
from robotd.core.pose import Pose2
from robotd.logs.carmen import parse_carmen
from tests.support.carmen_room import (
    HEAD,
    POSES,
    angles_rad,
    assert_the_room_is_seen,
    flaser,
    ranges_m,
    robotlaser,
    text,
)

UNITS = {"centimetres": 100.0, "millimetres": 1000.0}


def scaled(lines: list[str], factor: float, first: int, count: int = 180) -> list[str]:
    """The lines with ``count`` fields from ``first`` on as whole numbers of another unit."""
    changed = []
    for line in lines:
        fields = line.split()
        fields[first : first + count] = [f"{float(text) * factor:.0f}" for text in fields[first : first + count]]
        changed.append(" ".join(fields))
    return changed


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize(
    ("lines", "first"),
    [(flaser(), 2), (flaser("RLASER"), 2), (robotlaser(), 9), (robotlaser(limit="0"), 9)],
    ids=["FLASER", "RLASER", "ROBOTLASER1", "ROBOTLASER1 without a limit"],
)
def test_ranges_that_are_no_metres_are_refused_with_their_unit(lines: list[str], first: int, unit: str) -> None:
    assert_the_room_is_seen(parse_carmen(lines))
    with pytest.raises(
        RecordingError, match=rf"mine\.log: its ranges cannot be metres, .*; {unit}\? then [2-5]\.\d\d m"
    ):
        parse_carmen(scaled(lines, UNITS[unit], first), file="mine.log")


def test_a_hall_in_millimetres_is_not_taken_for_nothing_but_misses() -> None:
    hall = [
        " ".join(line.split()[:2] + [f"{15000 + 37 * beam}" for beam in range(180)] + line.split()[182:])
        for line in flaser()
    ]
    with pytest.raises(RecordingError, match=r"millimetres\? then 18\.\d\d m"):
        parse_carmen(hall)


@pytest.mark.parametrize("code", [1000.0, 8191.0, 65535.0, 1e9])
def test_a_log_in_metres_that_is_nearly_all_codes_is_in_metres(code: float) -> None:
    lines = []
    for line in flaser():
        fields = line.split()
        fields[2:162] = [f"{code}"] * 160
        lines.append(" ".join(fields))
    log = parse_carmen(lines)
    assert all(scan.missed[:160].all() and scan.hit[160:].all() for scan in log.scans)


def test_a_place_outdoors_is_in_metres() -> None:
    seen = " ".join(f"{1.0 + 0.43 * beam:.2f}" for beam in range(180))
    lines = [f"FLASER 180 {seen} {text(pose)} {text(pose)} 0 h 0" for pose in POSES]
    assert len(parse_carmen(lines).scans) == len(POSES)


def test_poses_in_millimetres_are_refused() -> None:
    lines = []
    for pose in POSES:
        seen = " ".join(map(str, ranges_m(pose, angles_rad())))
        there = text(Pose2(1000.0 * pose.x_m, 1000.0 * pose.y_m, pose.heading_rad))
        lines.append(f"FLASER 180 {seen} {there} {there} 0 h 0")
    with pytest.raises(
        RecordingError, match=r"its poses cannot be metres.* typical step is 403; millimetres\? then 0\.40"
    ):
        parse_carmen(lines)


def test_angles_in_degrees_are_damage_that_names_them() -> None:
    seen = " ".join(map(str, np.full(180, 2.0)))
    head = HEAD.format(first=-90.0, fov=180.0, step=1.0, limit="81.9")
    lines = [f"ROBOTLASER1 {head} 180 {seen} 0 {text(pose)} {text(pose)} 0 0 0 0 0 0 h 0" for pose in POSES]
    with pytest.raises(RecordingError, match=r"180 beams from -90 rad on, 1 rad apart; degrees\? they must be radians"):
        parse_carmen(lines)
