"""A recording written for other programs, read back by their readers or ours: nothing is lost, nothing is made up."""

import base64
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader

from robotd.app.replaying import replay_events
from robotd.cli.main import main
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import Event, MapChanged, SweepDone
from robotd.core.clock import NS_PER_S
from robotd.core.pose import Odometry
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.logs.carmen import parse_carmen
from robotd.logs.scan import PoseSource
from robotd.sim.buildings.log_file import read_log
from tests.support.recorded_session import laid_together, record_session
from tests.support.tum_reader import decode_tum

pytestmark = pytest.mark.slow


@pytest.fixture(name="recorded")
def _recorded(tmp_path: Path) -> Path:
    return record_session(tmp_path)


@pytest.fixture(name="told")
def _told(recorded: Path) -> list[Event]:
    events: list[Event] = []
    replay_events(recorded, events.append)
    return events


def test_a_recording_goes_out_in_three_forms(recorded: Path, told: list[Event], tmp_path: Path) -> None:
    offset_ns = replay_events(recorded, lambda _: None).wall_offset_ns
    sweeps = [event for event in told if isinstance(event, SweepDone)]
    assert len(sweeps) == 2
    for check in (_tum_is_true, _carmen_is_true, _foxglove_is_true, _bags_are_true):
        check(recorded, told, offset_ns, tmp_path)


def _tum_is_true(recorded: Path, told: list[Event], offset_ns: int, place: Path) -> None:
    sure = [event for event in told if isinstance(event, PoseEstimate) and event.state is PoseState.LOCALIZED]
    assert main(["export", "tum", str(recorded), str(place / "a.tum")]) == 0
    read = list(decode_tum((place / "a.tum").read_text().splitlines()))
    assert len(read) == len(sure) > 0
    for timed, event in zip(read, sure, strict=True):
        assert event.best is not None
        assert timed.time_s == pytest.approx((event.time_ns + offset_ns) / NS_PER_S, abs=1e-6)
        assert (timed.pose.x_m, timed.pose.y_m) == (event.best.x_m, event.best.y_m)
        assert math.isclose(math.remainder(timed.pose.heading_rad - event.best.heading_rad, math.tau), 0, abs_tol=1e-9)
    assert main(["export", "tum", str(recorded), str(place / "all.tum"), "--predicted"]) == 0
    assert len(list(decode_tum((place / "all.tum").read_text().splitlines()))) > len(sure)


def _carmen_is_true(recorded: Path, told: list[Event], offset_ns: int, place: Path) -> None:
    sweeps = [event.sweep for event in told if isinstance(event, SweepDone)]
    assert main(["export", "carmen", str(recorded), str(place / "a.clf")]) == 0
    log = parse_carmen((place / "a.clf").read_text().splitlines())
    assert log.damaged_lines == 0
    assert len(log.scans) == len(sweeps)
    for scan, sweep in zip(log.scans, sweeps, strict=True):
        assert scan.robot_pose.distance_m(sweep.in_odom) < 1e-9
        met = [reading for reading in sweep.readings if reading.status is ReadingStatus.OK]
        ends = np.array([_end(reading) for reading in met])
        # The log goes round counter-clockwise, the head in whichever way was shorter.
        ends = ends if np.unwrap([reading.bearing_rad for reading in met])[-1] > met[0].bearing_rad else ends[::-1]
        told_ends = (scan.ranges_m * np.exp(1j * scan.angles_rad))[scan.hit]
        # One laser at one place, at even steps: the head's offset across its beam, and its aim's error, are lost.
        assert np.abs(told_ends - ends).max() < 0.02
    # The sweep that made the map was localized on none, the second on that.
    assert main(["export", "carmen", str(recorded), str(place / "map.clf"), "--on-map"]) == 0
    [scan] = parse_carmen((place / "map.clf").read_text().splitlines()).scans
    assert any(isinstance(event, PoseEstimate) and event.best == scan.robot_pose for event in told)


def _end(reading: RangeReading) -> complex:
    start = complex(reading.origin_x_m, reading.origin_y_m)
    return start + (reading.range_m or 0.0) * complex(math.cos(reading.bearing_rad), math.sin(reading.bearing_rad))


def _foxglove_is_true(recorded: Path, told: list[Event], offset_ns: int, place: Path) -> None:
    out = place / "fox.mcap"
    assert main(["export", "foxglove", str(recorded), str(out)]) == 0
    messages: dict[str, list[Any]] = {}
    with out.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            assert schema is not None
            assert set(json.loads(schema.data)["properties"]) >= set(json.loads(message.data))
            messages.setdefault(channel.topic, []).append((message.log_time, json.loads(message.data)))
    assert len(messages["/sweep"]) == sum(isinstance(event, SweepDone) for event in told)
    grids = [event for event in told if isinstance(event, MapChanged)]
    assert [time_ns for time_ns, _ in messages["/map"]] == [event.time_ns + offset_ns for event in grids]
    # The last picture is the sum of all changes, which a slow reader lays on one another.
    last = np.frombuffer(base64.b64decode(messages["/map"][-1][1]["data"]), np.uint8)
    np.testing.assert_array_equal(last, laid_together(grids).ravel())
    frames = messages["/tf"][-1][1]["transforms"]
    assert [(tie["parent_frame_id"], tie["child_frame_id"]) for tie in frames] == [("map", "odom"), ("odom", "robot")]
    # Written again it is ours to replace; a recording is not.
    assert main(["export", "foxglove", str(recorded), str(out)]) == 0
    assert main(["export", "foxglove", str(recorded), str(recorded)]) != 0


def _bags_are_true(recorded: Path, told: list[Event], offset_ns: int, place: Path) -> None:
    sweeps = [event.sweep for event in told if isinstance(event, SweepDone)]
    for name in ("a.bag", "a_ros2"):
        assert main(["export", "bag", str(recorded), str(place / name)]) == 0
        log = read_log(place / name)
        assert log.poses is PoseSource.CORRECTED
        assert len(log.scans) == len(sweeps)
        for scan, sweep in zip(log.scans, sweeps, strict=True):
            # Where it stood by odometry comes back; the rest is the scanner's form, as in a CARMEN log.
            assert scan.odometry.distance_m(sweep.in_odom) < 1e-6
            assert scan.time_s == pytest.approx((sweep.readings[0].time_ns + offset_ns) / NS_PER_S, abs=1e-6)
            assert int(scan.hit.sum()) == sweep.count(ReadingStatus.OK)
            assert int(scan.missed.sum()) == sweep.count(ReadingStatus.MISS)
        _messages_are_true(place / name, told)
        assert main(["export", "bag", str(recorded), str(place / name)]) == 1  # somebody may have added to it


def _messages_are_true(bag: Path, told: list[Event]) -> None:
    with AnyReader([bag]) as reader:
        counts = {topic: info.msgcount for topic, info in reader.topics.items()}
        maps = [one for one in reader.connections if one.topic == "/map"]
        [*_, (connection, _, data)] = reader.messages(maps)
        last: Any = reader.deserialize(data, connection.msgtype)
    assert counts["/odom"] == sum(isinstance(event, Odometry) for event in told)
    assert counts["/pose"] == sum(isinstance(event, PoseEstimate) and event.best is not None for event in told)
    cells = laid_together([event for event in told if isinstance(event, MapChanged)])
    assert (last.info.height, last.info.width) == cells.shape
    np.testing.assert_array_equal(last.data == -1, cells.ravel() == 128)
    known = cells.ravel() != 128
    assert np.abs(last.data[known] / 100 - cells.ravel()[known] / 255).max() <= 0.005
