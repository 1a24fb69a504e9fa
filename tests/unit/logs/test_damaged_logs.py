"""Logs with lines that are cut, torn or counted wrongly: these lines are left out, counted, and named."""

import re

import pytest

from robotd.core.errors import RecordingError
from robotd.logs.carmen import parse_carmen
from tests.support.carmen_room import (
    POSES,
    assert_the_room_is_seen,
    flaser,
    remarks,
    text,
)

CUTS = {
    "the last line is cut": lambda lines: [*lines[:-1], lines[-1][: len(lines[-1]) // 2]],
    "a line is cut in the middle": lambda lines: [*lines[:4], lines[4][: len(lines[4]) // 2], *lines[5:]],
    "two lines are one": lambda lines: [*lines[:4], lines[4][:300] + lines[5], *lines[6:]],
    "a line is torn in two": lambda lines: [
        *lines[:4],
        lines[4][:300].rsplit(" ", 1)[0],
        lines[4][300:].split(" ", 1)[1],
        *lines[5:],
    ],
    "a pose is cut": lambda lines: [*lines[:4], " ".join(lines[4].split()[:-4]), *lines[5:]],
    "host and time are cut": lambda lines: [*lines[:4], " ".join(lines[4].split()[:-2]), *lines[5:]],
    "the times are cut": lambda lines: [*lines[:4], " ".join(lines[4].split()[:-3]), *lines[5:]],
    "a number is missing": lambda lines: [
        *lines[:4],
        " ".join(lines[4].split()[:9] + lines[4].split()[10:]),
        *lines[5:],
    ],
    "a number is doubled": lambda lines: [
        *lines[:4],
        " ".join([*lines[4].split()[:9], *lines[4].split()[8:]]),
        *lines[5:],
    ],
    "two numbers are missing": lambda lines: [
        *lines[:4],
        " ".join(lines[4].split()[:9] + lines[4].split()[11:]),
        *lines[5:],
    ],
    "letters": lambda lines: [*lines[:4], lines[4].replace("1", "l"), *lines[5:]],
    "decimal commas": lambda lines: [*lines[:4], lines[4].replace(".", ","), *lines[5:]],
    "a pose is no place": lambda lines: [*lines[:4], lines[4].replace(text(POSES[4]), "nan 0 0"), *lines[5:]],
    "a pose is beyond the earth": lambda lines: [*lines[:4], lines[4].replace(text(POSES[4]), "1e300 0 0"), *lines[5:]],
}


@pytest.mark.parametrize("cut", CUTS.values(), ids=CUTS)
def test_damaged_lines_are_left_out_counted_and_named(cut: object) -> None:
    assert callable(cut)
    lines = cut(flaser())
    log = parse_carmen(lines)
    assert_the_room_is_seen(log, len(log.scans))
    assert len(POSES) - 2 <= len(log.scans) <= len(POSES) - 1
    assert 1 <= len(log.problems) <= 2
    at = len(lines) if lines[-1] == cut(flaser())[-1] != flaser()[-1] else 5
    assert log.problems[0].line == at
    assert re.search(rf"left out: line {at}: ", remarks(lines))


@pytest.mark.parametrize("by", [1, 2, 3, -1, -2, -3, 100, -100])
def test_a_count_that_is_wrong_never_makes_a_range_of_a_pose(by: int) -> None:
    lines = flaser()
    lines[6] = lines[6].replace("FLASER 180", f"FLASER {180 + by}")
    log = parse_carmen(lines)
    assert_the_room_is_seen(log, len(POSES) - 1)
    assert [problem.line for problem in log.problems] == [7]


def test_where_every_count_is_wrong_the_log_is_refused_and_the_first_named() -> None:
    with pytest.raises(RecordingError) as caught:
        parse_carmen([line.replace("FLASER 180", "FLASER 181") for line in flaser()])
    assert "the first of 12 damaged lines is line 1: FLASER: 181 ranges are announced, and 8 fields" in str(
        caught.value
    )


def test_of_many_damaged_lines_only_some_are_named() -> None:
    lines = [line for whole in flaser() for line in (whole, "FLASER 4 1 2")]
    said = remarks(lines)
    assert said.startswith("12 damaged lines were left out: line 2: FLASER: 4 numbers are announced, 2 follow")
    assert said.count("line ") == 5
    assert said.endswith("; ...")


def test_very_many_damaged_lines_cost_no_memory() -> None:
    log = parse_carmen([*flaser(), *["FLASER 4 1 2"] * 5000])
    assert log.damaged_lines == 5000
    assert len(log.problems) == 100


def test_a_damaged_setting_is_left_out_and_named() -> None:
    log = parse_carmen(["PARAM robot_frontlaser_offset far 1 h 1", "PARAM robot_name far", *flaser()])
    assert_the_room_is_seen(log)
    assert [str(problem)[:30] for problem in log.problems] == ["line 1: PARAM: 'far' is no num"]


@pytest.mark.parametrize("word", ["1_03", "1_0.5"])
def test_a_number_that_only_python_reads_is_damage(word: str) -> None:
    lines = flaser()
    fields = lines[2].split()
    lines[2] = " ".join([*fields[:5], word, *fields[6:]])
    assert [problem.line for problem in parse_carmen(lines).problems] == [3]
    lines[2] = " ".join(["FLASER", f"{fields[1][:1]}_{fields[1][1:]}", *fields[2:]])
    assert [problem.line for problem in parse_carmen(lines).problems] == [3]


@pytest.mark.parametrize(("name", "value"), [("offset", "25"), ("side_offset", "-300"), ("angular_offset", "180")])
def test_a_scanner_that_sits_nowhere_on_a_robot_is_told(name: str, value: str) -> None:
    log = parse_carmen([f"PARAM robot_frontlaser_{name} {value} h 1", *flaser()])
    assert_the_room_is_seen(log)
    [problem] = log.problems
    assert problem.line == 1
    assert f"{value} is no place of a scanner on a robot" in problem.message
    assert {"25": "cm? then 0.25 m", "-300": "cm? then -3 m", "180": "degrees? then 3.14 rad"}[value] in problem.message
