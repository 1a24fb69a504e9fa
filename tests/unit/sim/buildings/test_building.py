import gzip
import json
import math
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.core.errors import RecordingError
from robotd.core.pose import IDENTITY, Pose2
from robotd.logs.carmen import parse_carmen
from robotd.sim.buildings.building import (
    RecordedBuilding,
    RecordedStop,
    encode_recorded_building,
    load_recorded_building,
    select_stops,
    view_from,
)
from robotd.sim.buildings.log_file import read_log
from robotd.sim.physics.walls import Point

LASER = Pose2(-0.04, 0.0, 0.0)
STOP = RecordedStop(
    scan=7,
    pose=Pose2(1.0, 2.0, 0.3),
    odometry=Pose2(1.1, 2.1, 0.4),
    kept_out=False,
    laser=LASER,
    first_rad=-math.pi / 2,
    step_rad=math.pi / 4,
    ranges_m=(1.0, None, 2.0, None),
    missed=(3,),
)


def line_log(steps: int, step_m: float = 0.25) -> str:
    """A robot that goes straight ahead and sees a wall at its left."""
    poses = (f"{index * step_m} 0 0 {index * step_m} 0 0" for index in range(steps))
    return "\n".join(f"FLASER 4 81.83 5.0 {4.0 + index} 1.5 {pose} 1 h 1" for index, pose in enumerate(poses))


def building(steps: int, spacing_m: float = 1.0) -> RecordedBuilding:
    return RecordedBuilding("line.log", select_stops(parse_carmen(line_log(steps).splitlines()), spacing_m))


def test_seen_from_the_recorded_place_by_a_centred_scanner_a_view_is_the_scan_itself() -> None:
    view = view_from(replace(STOP, laser=IDENTITY), IDENTITY)
    assert view.bearings_rad == pytest.approx([-math.pi / 2, 0.0, math.pi / 4])
    assert view.ranges_m.tolist() == pytest.approx([1.0, 2.0, math.inf])


def rounded_and_sorted(points_m: Iterable[Point]) -> list[Point]:
    """Rounded first, so that what differs by rounding errors is put in the same order."""
    return sorted((round(x_m, 6), round(y_m, 6)) for x_m, y_m in points_m)


@given(
    st.floats(-0.15, 0.15),
    st.floats(-0.15, 0.15),
    st.floats(-3.1, 3.1),
    st.lists(st.floats(0.5, 9.0), min_size=4, max_size=4),
)
def test_from_wherever_it_is_seen_each_beam_ends_where_it_ended(
    x_m: float, y_m: float, heading_rad: float, ranges_m: list[float]
) -> None:
    stop = replace(STOP, ranges_m=tuple(ranges_m), missed=())
    in_stop = Pose2(x_m, y_m, heading_rad)
    recorded = rounded_and_sorted(
        stop.laser.transform(range_m * math.cos(angle), range_m * math.sin(angle))
        for beam, range_m in enumerate(ranges_m)
        for angle in [stop.first_rad + beam * stop.step_rad]
    )
    view = view_from(stop, in_stop)
    seen = rounded_and_sorted(
        in_stop.transform(range_m * math.cos(bearing), range_m * math.sin(bearing))
        for bearing, range_m in zip(view.bearings_rad.tolist(), view.ranges_m.tolist(), strict=True)
    )
    assert np.array(seen) == pytest.approx(np.array(recorded), abs=2e-6)
    assert np.all(np.diff(view.bearings_rad) >= 0.0)


def test_a_miss_keeps_its_direction() -> None:
    view = view_from(STOP, Pose2(0.1, 0.1, 0.5))
    assert view.bearings_rad[np.isinf(view.ranges_m)].tolist() == pytest.approx([math.pi / 4 - 0.5])


def test_the_nearest_beam_is_found_across_the_seam_and_none_where_the_scanner_did_not_look() -> None:
    view = view_from(replace(STOP, laser=IDENTITY, first_rad=math.pi - 0.01, step_rad=0.1), IDENTITY)
    assert view.nearest(-math.pi + 0.001) == view.nearest(math.pi - 0.001) is not None
    assert view.nearest(0.0) is None
    assert view_from(replace(STOP, ranges_m=(None,), missed=()), IDENTITY).nearest(0.0) is None


def test_stops_are_taken_every_so_many_metres_and_every_other_one_is_kept_out() -> None:
    log = parse_carmen(line_log(17).splitlines())
    stops = select_stops(log, 1.0)
    assert [stop.pose.x_m for stop in stops] == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert [stop.kept_out for stop in stops] == [False, True, False, True, False]
    assert [stop.kept_out for stop in select_stops(log, 1.0, keep_out_every=3)] == [False, False, True, False, False]
    assert not any(stop.kept_out for stop in select_stops(log, 1.0, keep_out_every=0))
    assert len(select_stops(log, 1.0, limit=3)) == 3


def test_a_building_is_read_back_as_it_was_written(tmp_path: Path) -> None:
    path = tmp_path / "line.building"
    written = building(9, spacing_m=0.5)
    path.write_bytes(encode_recorded_building(written))
    assert load_recorded_building(path) == written
    assert written.log == "line.log"
    assert written.stops[1].ranges_m == (None, 5.0, 6.0, 1.5)
    assert written.stops[1].missed == (0,)
    assert encode_recorded_building(building(9, spacing_m=0.5)) == path.read_bytes()


def test_a_damaged_building_is_refused_and_the_damage_named(tmp_path: Path) -> None:
    path = tmp_path / "line.building"
    whole = encode_recorded_building(building(9))
    content = json.loads(gzip.decompress(whole))
    wrong = {
        "version 9": content | {"version": 9},
        "found '' version 0": {"stops": []},
        "damaged.*first stop": content | {"stops": []},
        r"damaged.*missed.*stops\[0\]": content | {"stops": [content["stops"][0] | {"missed": [99]}]},
        r"damaged.*ranges_m": content | {"stops": [content["stops"][0] | {"ranges_m": [-1.0], "missed": []}]},
        r"damaged.*step_rad": content | {"stops": [content["stops"][0] | {"step_rad": 0.0}]},
    }
    for complaint, altered in wrong.items():
        path.write_bytes(gzip.compress(json.dumps(altered).encode()))
        with pytest.raises(RecordingError, match=complaint):
            load_recorded_building(path)
    for damaged in (whole[:-9], whole[:40] + b"\x00" + whole[41:], b"no gzip", gzip.compress(b'{"format": ')):
        path.write_bytes(damaged)
        with pytest.raises(RecordingError, match=r"line\.building"):
            load_recorded_building(path)
    with pytest.raises(RecordingError, match=r"none\.building"):
        load_recorded_building(tmp_path / "none.building")


def test_a_building_that_unpacks_without_end_or_is_nested_without_end_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bomb.building"
    path.write_bytes(gzip.compress(bytes(257 << 20), compresslevel=1))
    with pytest.raises(RecordingError, match="over 256 MiB"):
        load_recorded_building(path)
    path.write_bytes(gzip.compress(b'{"format": ' + b"[" * 100_000))
    with pytest.raises(RecordingError, match="damaged"):
        load_recorded_building(path)


def test_not_every_stop_can_be_kept_out_of_the_map() -> None:
    with pytest.raises(ValueError, match="every stop"):
        select_stops(parse_carmen(line_log(9).splitlines()), 1.0, keep_out_every=1)


def test_a_building_begins_with_a_stop_of_the_map() -> None:
    with pytest.raises(ValueError, match="first stop"):
        RecordedBuilding("x", (replace(STOP, kept_out=True),))


@pytest.mark.real_data
def test_a_real_log_gives_a_small_file_of_stops_along_the_way(laser_data: Path, tmp_path: Path) -> None:
    path = tmp_path / "intel.building"
    log_path = laser_data / "intel" / "intel.corrected.log.gz"
    log = read_log(log_path)
    real = RecordedBuilding("intel", select_stops(log, 1.0))
    path.write_bytes(encode_recorded_building(real))
    assert path.stat().st_size < 400_000
    assert load_recorded_building(path) == real
    for stop in real.stops:
        assert stop.pose == log.scans[stop.scan].robot_pose
    kept_out = sum(stop.kept_out for stop in real.stops)
    assert len(real.stops) > 200
    assert abs(len(real.stops) - 2 * kept_out) <= 1
