from dataclasses import replace

import pytest

from robotd.core.errors import RecordingError
from robotd.core.pose import Pose2
from robotd.logs.carmen import parse_carmen
from robotd.logs.relations import Relation, parse_relations
from robotd.logs.scan import Scan
from tests.support.recorded_room import drive_lines

SCANS = parse_carmen(drive_lines(6)).scans


def timed(*times_s: float | None) -> list[Scan]:
    return [replace(scan, time_s=time_s) for scan, time_s in zip(SCANS, times_s, strict=False)]


def test_times_of_scans_come_out_of_the_log() -> None:
    assert all(scan.time_s is not None for scan in SCANS)


def test_times_are_joined_to_the_millisecond_in_file_order_and_never_sorted() -> None:
    scans = timed(976052857.336341, 976052857.300001, 12.0, 12.0)
    lines = ["# by hand", "", "976052857.3364 976052857.3 1.5 -0.2 0 0 0 3.5", "12 976052857.336 0 0 0 0 0 0"]
    relations = parse_relations(lines, scans)
    first, second = relations.known
    assert (first.one, first.other, first.step.x_m, first.step.y_m) == (0, 1, 1.5, -0.2)
    assert first.step.heading_rad == pytest.approx(3.5 - 6.283185307179586)
    assert second == Relation(2, 0, Pose2(0.0, 0.0, 0.0))  # the first of two scans of one time


def test_relations_of_unknown_times_are_counted_and_too_many_refused() -> None:
    lines = ["1 2 0 0 0 0 0 0"] * 99 + ["1 77 0 0 0 0 0 0"]
    relations = parse_relations(lines, timed(1.0, 2.0, None))
    assert (len(relations.known), relations.unknown) == (99, 1)
    with pytest.raises(RecordingError, match=r"a\.relations: 2 of 100 .* another log's"):
        parse_relations(lines[1:] + lines[-1:], timed(1.0, 2.0), "a.relations")


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("1 2 0 0 0 0 0", "2: 7 fields; expected time_1 time_2 x y z roll pitch yaw"),
        ("1 2 0 0 0 0 0 east", "2: .*east.*; expected time_1"),
        ("1 2 nan 0 0 0 0 0", "2: not all of it is finite"),
        ("inf 2 0 0 0 0 0 0", "2: not all of it is finite"),
    ],
)
def test_a_damaged_line_is_named(line: str, said: str) -> None:
    with pytest.raises(RecordingError, match=f"x.relations:{said}"):
        parse_relations(["1 2 0 0 0 0 0 0", line], timed(1.0, 2.0), "x.relations")


def test_a_file_without_any_is_refused() -> None:
    with pytest.raises(RecordingError, match="no relation in it"):
        parse_relations(["# nothing"], timed(1.0))
