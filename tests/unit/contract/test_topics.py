"""Events survive the wire whole, and a broken one is named."""

from dataclasses import replace
from typing import Any, get_args

import msgpack
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.contract.estimate import Circle, Cover, Extent, PoseEstimate, PoseState, Region
from robotd.contract.events import Event, MapChanged, MissionPhase, MissionProgress, Status, SweepDone, SweepProgress
from robotd.contract.map_wire import MapPayload, pack_map, unpack_map
from robotd.contract.modes import MODE_WORDS
from robotd.contract.topics import (
    EVENTS,
    Frame,
    LogEntry,
    Published,
    Topic,
    encode_frame,
    from_wire,
    to_wire,
)
from robotd.core.errors import RemoteProtocolError
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Odometry, Pose2, Twist2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.tables import NO_INFORMATION
from tests.unit.server.conftest import whole_map

numbers = st.floats(-1e6, 1e6)
times = st.integers(0, 2**62)
poses = st.builds(Pose2, numbers, numbers, st.floats(-3.2, 3.2))
counts = st.integers(0, 300)
regions = st.builds(
    Region,
    belief=numbers,
    pose=poses,
    covariance=st.tuples(*[st.tuples(*[numbers] * 3)] * 3),
    residual_m=numbers,
    centre=poses,
    extent=st.builds(Extent, *[numbers] * 6),
    circle=st.builds(Circle, *[numbers] * 3),
    cover=st.builds(Cover, st.just(2), st.lists(st.tuples(counts, counts, counts), max_size=3).map(tuple)),
    cells=counts,
    poses=counts,
    best_rank=counts,
    explained=st.lists(st.booleans(), max_size=9).map(tuple),
)
devices = st.builds(
    DeviceStatus,
    st.just("drive"),
    st.sampled_from(LinkState),
    st.booleans(),
    st.tuples(st.text(max_size=9)),
    st.text(max_size=9),
    st.tuples(st.tuples(st.text(max_size=9), st.integers(0, 9))),
)
readings = st.builds(RangeReading, times, numbers, st.just(ReadingStatus.OK), st.floats(0.01, 50.0)) | st.builds(
    RangeReading, times, numbers, st.just(ReadingStatus.WEAK), st.none(), st.integers(0, 9)
)
events: st.SearchStrategy[Published] = st.one_of(
    st.builds(Odometry, times, poses, st.builds(Twist2, numbers, numbers)),
    st.builds(
        PoseEstimate,
        times,
        st.sampled_from(PoseState),
        st.none() | poses,
        st.lists(regions, max_size=3).map(tuple),
        st.integers(0, 300),
        st.integers(0, 300),
        st.booleans(),
        st.text(max_size=8),
        counts,
        numbers,
        numbers,
        st.none() | numbers,
        st.lists(numbers, max_size=4).map(tuple),
    ),
    st.builds(
        Status,
        time_ns=times,
        mode=st.sampled_from(MODE_WORDS),
        reason=st.text(max_size=9),
        devices=st.lists(devices, max_size=3).map(tuple),
        battery_v=st.none() | numbers,
        bumpers_rad=st.lists(numbers, max_size=3).map(tuple),
        mission_id=st.none() | st.integers(1, 9),
        map_id=st.none() | st.text(max_size=9),
        map_name=st.none() | st.text(max_size=9),
        recording=st.none() | st.text(max_size=9),
    ),
    st.builds(SweepProgress, times, *[st.integers(0, 300)] * 6),
    st.builds(SweepDone, times, st.builds(Sweep, st.integers(0, 9), poses, st.lists(readings, max_size=4).map(tuple))),
    st.builds(
        MissionProgress,
        times,
        st.integers(1, 9),
        st.just("map"),
        st.sampled_from(MissionPhase),
        *[st.integers(0, 9)] * 2,
    ),
    st.builds(LogEntry, times, st.just("INFO"), st.just("robotd.x"), st.text(max_size=20)),
)


@given(events, st.integers(0, 2**53))
@settings(max_examples=200)
def test_an_event_survives_the_wire(event: Published, seq: int) -> None:
    topic, fields = to_wire(event)
    message = Frame.of(encode_frame(topic, "session", seq, fields))
    assert (message.topic, message.session, message.seq, message.published) == (topic, "session", seq, event)
    assert message.event == EVENTS[type(event)][1]


@given(st.integers(1, 9), st.integers(1, 9), st.booleans(), st.randoms(use_true_random=False))
@settings(max_examples=60)
def test_a_map_survives_the_wire(rows: int, cols: int, whole: bool, random: Any) -> None:
    spec = GridSpec(0.1, -3.0, 1 / 3, (rows, cols))
    shape: tuple[int, ...] = (rows, cols) if whole else (random.randrange(rows * cols),)
    values = np.array([random.randrange(256) for _ in range(int(np.prod(shape)))], dtype=np.uint8).reshape(shape)
    cells = np.array(random.sample(range(rows * cols), 0 if whole else shape[0]), dtype=np.intp)
    change = MapChanged(7, "d", 3, spec, whole, cells, values, random.choice([None, 0, 7]))
    topic, fields = to_wire(change)
    found = Frame.of(encode_frame(topic, "s", 0, fields)).published
    assert isinstance(found, MapChanged)
    assert replace(found, cells=cells, values=values) == replace(change, cells=cells, values=values)
    np.testing.assert_array_equal(found.cells, cells)
    np.testing.assert_array_equal(found.values, values)
    assert (found.cells.dtype, found.values.dtype) == (np.dtype(np.intp), np.dtype(np.uint8))


def test_that_no_map_is_in_use_survives_the_wire() -> None:
    topic, fields = to_wire(MapChanged.none(7))
    assert (fields["map_id"], fields["whole"]) == (None, True)
    found = Frame.of(encode_frame(topic, "s", 0, fields)).published
    assert isinstance(found, MapChanged)
    assert found.map_id is None
    assert found.values.tolist() == [[NO_INFORMATION]]


def test_every_event_of_the_mission_has_a_topic() -> None:
    assert set(EVENTS) == {*get_args(Event), LogEntry}
    assert {topic for topic, _ in EVENTS.values()} == set(Topic)


def test_a_frame_begins_with_its_topic_and_a_zero() -> None:
    topic, fields = to_wire(LogEntry(1, "INFO", "robotd", "hello"))
    frame = encode_frame(topic, "s", 4, fields)
    assert frame.startswith(b"log\0")
    assert msgpack.unpackb(frame[4:]) == {
        "v": 1,
        "session": "s",
        "seq": 4,
        "event": "log",
        "time_ns": 1,
        "level": "INFO",
        "logger": "robotd",
        "message": "hello",
    }


def test_no_topic_begins_another() -> None:
    assert not [(a, b) for a in Topic for b in Topic if a is not b and b.prefix.startswith(a.prefix)]


def test_numpy_numbers_are_numbers_on_the_wire() -> None:
    pose = Pose2(np.float64(1.5), float(np.float32(0.5)), 0.0)
    topic, fields = to_wire(Odometry(int(np.int64(3)), pose, Twist2(np.float64(0.0), 0.0)))
    assert Frame.of(encode_frame(topic, "s", 0, fields)).published == Odometry(3, pose, Twist2(0.0, 0.0))


def test_an_event_of_a_newer_daemon_is_nothing_to_us() -> None:
    frame = encode_frame(Topic.POSE, "s", 3, {"event": "pose_in_space", "z_m": 1.0})
    assert Frame.of(frame).published is None


def test_a_field_of_a_newer_daemon_is_ignored() -> None:
    _, fields = to_wire(LogEntry(1, "INFO", "robotd", "hello"))
    assert from_wire({**fields, "host": "x"}) == LogEntry(1, "INFO", "robotd", "hello")


@pytest.mark.parametrize(
    "frame", [b"", b"pose", b"pose\0", b"pose\0\xc0", b"pose\0\x80", b"\xff\0\x80", b"pose\0\x81\xa1v\x01"]
)
def test_what_is_no_message_is_the_servers_fault(frame: bytes) -> None:
    with pytest.raises(RemoteProtocolError):
        Frame.of(frame)


def test_a_message_of_another_version_is_refused() -> None:
    with pytest.raises(RemoteProtocolError, match="version 2"):
        Frame.of(b"pose\0" + msgpack.packb({"v": 2}))


def test_a_missing_field_is_named() -> None:
    with pytest.raises(RemoteProtocolError, match="in_odom"):
        from_wire({"event": "odometry", "time_ns": 1})


@pytest.mark.parametrize(
    "broken",
    [
        {"rows": 41},
        {"rows": 39},
        {"rows": 0},
        {"resolution_m": float("nan")},
        {"cells_zlib": b"garbage"},
        {"cells_zlib": b""},
        {"whole": False, "indices_u32le": b"\0\0\0\0", "values_u8": b""},
        {"whole": False, "indices_u32le": b"\0\0\0", "values_u8": b"\0"},
        {"whole": False, "indices_u32le": b"\xff\xff\xff\xff", "values_u8": b"\0"},
    ],
)
def test_a_map_that_contradicts_itself_is_refused(broken: dict[str, Any]) -> None:
    payload = pack_map(whole_map(1))
    fields = {name: getattr(payload, name) for name in MapPayload.__struct_fields__}
    with pytest.raises(RemoteProtocolError, match="map payload"):
        unpack_map(MapPayload(**(fields | broken)))
