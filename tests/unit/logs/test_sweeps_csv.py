"""Tables of sweeps: columns by their names and units, sweeps one way each, gaps left open, damage named."""

import math
from pathlib import Path

import numpy as np
import pytest

from robotd.core.errors import RecordingError
from robotd.logs.sweeps_csv import is_header, parse_sweeps
from robotd.sim.buildings.log_file import read_log
from tests.support.carmen_room import POSES, angles_rad, assert_the_room_is_seen, ranges_m

HEADER = "sweep,x_m,y_m,heading_rad,bearing_rad,range_m"


def table(*, units: tuple[str, str] = ("m", "rad"), clockwise: bool = False) -> list[str]:
    length, angle = units
    metre, radian = {"m": 1.0, "cm": 100.0, "mm": 1000.0}[length], {"rad": 1.0, "deg": math.degrees(1.0)}[angle]
    lines = [f"stop,robot_x_{length},robot_y_{length},theta_{angle},strength,angle_{angle},range_{length}"]
    for number, pose in enumerate(POSES):
        bearings = angles_rad()[::-1] if clockwise else angles_rad()
        place = f"{pose.x_m * metre},{pose.y_m * metre},{pose.heading_rad * radian}"
        beams = zip(bearings * radian, ranges_m(pose, bearings) * metre, strict=True)
        lines += [f"{number},{place},77,{bearing},{range_}" for bearing, range_ in beams]
    return lines


@pytest.mark.parametrize("clockwise", [False, True])
@pytest.mark.parametrize("units", [("m", "rad"), ("cm", "deg"), ("mm", "deg")])
def test_every_reading_lies_on_the_walls(units: tuple[str, str], clockwise: bool) -> None:
    log = parse_sweeps(["# by hand", "", *table(units=units, clockwise=clockwise)])
    assert_the_room_is_seen(log)
    assert list(log.remarks()) == []


def test_a_file_is_known_by_its_first_line(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("# notes\n" + "\n".join(table()))
    assert_the_room_is_seen(read_log(tmp_path / "a.txt"))
    assert not is_header("# sweep,range_m in metres")


def test_what_was_not_measured_is_neither_hit_nor_missed() -> None:
    ranges = ["1.5", "", "nan", "inf", "0", "1.5"]
    rows = [f"0,0,0,0,{at / 10},{range_}" for at, range_ in enumerate(ranges)]
    [scan] = parse_sweeps([HEADER, *rows]).scans
    assert scan.hit.tolist() == [True, False, False, False, False, True]
    assert scan.missed.tolist() == [False, False, False, True, False, False]


def test_forth_and_back_are_two_sweeps_and_lines_left_out_are_gaps() -> None:
    forth = [f"3,0,0,0,{at / 10},2.0" for at in range(10) if at != 4]
    back = [f"3,0,0,0,{at / 10},2.0" for at in range(9, -1, -1)]
    first, second = parse_sweeps([HEADER, *forth, *back]).scans
    np.testing.assert_allclose(first.angles_rad, np.arange(10) / 10)
    assert first.hit.tolist() == [at != 4 for at in range(10)]
    assert len(second.angles_rad) in {9, 10}  # the reading at the turning point is of one of them
    assert second.hit.all()


def test_damaged_lines_are_named_and_left_out() -> None:
    rows = [f"0,0,0,0,{at / 10},2.0" for at in range(9)]
    rows[3:5] = ["0,0,zero,0,0.3,2.0", "0,0"]
    log = parse_sweeps([HEADER, *rows])
    assert [str(problem) for problem in log.problems] == [
        "line 5: 'zero' is no number",
        "line 6: 2 fields, fewer than columns",
    ]
    assert log.damaged_lines == 2


def test_bearings_without_order_are_no_sweep() -> None:
    rows = [f"0,0,0,0,{bearing},2.0" for bearing in (0.0, 0.1, 0.2, 0.21, 0.22, 0.5, 0.6)]
    with pytest.raises(RecordingError, match="line 2: a sweep whose bearings lie neither evenly"):
        parse_sweeps([HEADER, *rows])


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ("range_m,x_m,y_m", "no column names bearing_rad"),
        ("bearing_deg,range_m", "no column names x_m and y_m"),
    ],
)
def test_a_missing_column_is_named(header: str, words: str) -> None:
    with pytest.raises(RecordingError, match=words):
        parse_sweeps([header, "1,2,3"])


def test_sweeps_by_taped_stops_are_twelve(laser_data: Path) -> None:
    log = read_log(laser_data / "pibot-tfluna-stops" / "stops.csv")
    assert [len(scan.angles_rad) for scan in log.scans] == [200] * 12
    assert any("taken to be 0 at every stop" in remark for remark in log.remarks())
