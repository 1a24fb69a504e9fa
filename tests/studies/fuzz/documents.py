"""The parsers of requests, replies and files."""

import tempfile
import zlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from robotd.children.message_framing import Unframer, header
from robotd.cli.exact_inputs import read_beams, read_map
from robotd.config import Config, effective_text, loads
from robotd.contract.answers import Done
from robotd.contract.arguments import PoseArgument
from robotd.contract.envelope import (
    BadRequest,
    decode_reply,
    decode_request,
    encode_error,
    encode_request,
    encode_result,
)
from robotd.contract.missions import DriveTo, Localize, MapStart
from robotd.contract.request import Request
from robotd.contract.requests import Hello, MapLoad, RecordStart, Stop
from robotd.core.errors import (
    ChildError,
    ConfigError,
    MapError,
    RecordingError,
    RemoteProtocolError,
    RobotdError,
    ServerError,
)
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry
from robotd.front.messages import answer, event, said
from robotd.hardware.link.tap import Direction
from robotd.logs.scan import RecordedLog
from robotd.maps.manifest import FileSum, Manifest, decode_manifest
from robotd.maps.stops_file import decode_stops, encode_stops
from robotd.recording.entries import BytesEntry, CommandEntry, LineEntry, RecordingHeader
from robotd.recording.reader import read
from robotd.recording.recorder import Recorder
from robotd.server.zmtp import GREETING, Ping, Reader, Violation, message, pong, ready
from robotd.sim.buildings.building import RecordedBuilding, encode_recorded_building, select_stops
from robotd.sim.buildings.log_file import read_log
from robotd.sim.buildings.world import parse_world
from tests.studies.fuzz.target import KIB, MIB, ROOT, Target
from tests.support.made_maps import made_stops

_REQUEST_MAX_BYTES = 64 * KIB
_HEADER = RecordingHeader("0.1.0", "", 5, 1_700_000_000_000_000_001, 1000)


@cache
def _directory() -> "tempfile.TemporaryDirectory[str]":
    return tempfile.TemporaryDirectory(prefix="fuzz-")


def _in_file(name: str, reader: Callable[[Path], object]) -> Callable[[bytes], object]:
    def run(data: bytes) -> object:
        file = Path(_directory().name) / name
        file.write_bytes(data)
        return reader(file)

    return run


def _text(data: bytes) -> str:
    return data.decode("utf-8", errors="replace")


def _requests() -> list[bytes]:
    commands: list[Request[Any]] = [
        Hello(),
        Stop("because"),
        MapStart("lab-2", ((1.0, 2.0), (3.0, -4.5)), PoseArgument(1.0, 0.0, 0.5)),
        Localize(-0.75, 1.0),
        DriveTo(1.5, -2.5),
        MapLoad("a", 3, PoseArgument(0.0, 1.0)),
        RecordStart("somewhere/new.mcap"),
    ]
    return [encode_request(number, command) for number, command in enumerate(commands)]


def _answered(data: bytes) -> object:
    """Whatever a client sends is understood, or has an error for an answer that can be sent."""
    request = decode_request(data, _REQUEST_MAX_BYTES)
    return decode_reply(encode_error(request.id, request.error)) if isinstance(request, BadRequest) else request


def _replies() -> list[bytes]:
    return [encode_result(1, {"maps": [1, 2.5, "a"]}), encode_error(None, ServerError("busy", "not now"))]


def _configured(data: bytes) -> object:
    """What is understood can be written, and is understood as the same again."""
    config = loads(_text(data))
    assert loads(effective_text(config)) == config
    return config


def _configurations() -> list[bytes]:
    return [b"", b'[drive]\nport = "/dev/ttyS0"\ncounts_per_m = 35000\n', effective_text(Config()).encode()]


def _recordings() -> list[bytes]:
    file = Path(_directory().name) / "seed.mcap"
    file.unlink(missing_ok=True)
    recorder = Recorder(file, _HEADER)
    recorder.note(LineEntry(1000, "drive", up=True))
    recorder.note(BytesEntry(1001, "drive", Direction.FROM_BOARD, bytes(range(64))))
    recorder.note(CommandEntry(1002, "localize", {"heading_rad": 0.1}))
    recorder.close()
    return [file.read_bytes()]


def _logs() -> list[bytes]:
    lines = (
        b"PARAM robot_front_laser_max 20.0",
        b"ODOM 1.0 2.0 0.5 0 0 0 1.0 host 1.0",
        b"FLASER 4 1.0 2.0 3.0 81.9 1.0 2.0 0.5 1.0 2.0 0.5 1.0 host 1.0",
        b"ROBOTLASER1 0 -1.57 3.14 1.57 8.0 0.01 0 3 1.0 2.0 8.0 0 1 2 0.5 1 2 0.5 0 0 0 0 0 1.0 host 1.0",
        b"RLASER 3 1.0 nan inf 1.0 2.0 0.5 1.0 2.0 0.5 1.0 host 1.0",
        b"RAWLASER1 0 1.57 3.14 -1.57 0 0.01 0 3 1.0 2.0 8.0 1.0 host 1.0",
        b"PARAM laser_front_laser_fov 270",
    )
    odom, front, raw = lines[1], lines[2], lines[5]
    return [b"\n".join(text) + b"\n" for text in (lines, [front, odom, front], [lines[3]], [odom, raw, odom])]


def _log_read(data: bytes) -> object:
    """What is read can be said, and makes a building."""
    log = _in_file("a.log", read_log)(data)
    assert isinstance(log, RecordedLog)
    assert all(len(remark.splitlines()) == 1 for remark in log.remarks())
    return encode_recorded_building(RecordedBuilding("a.log", select_stops(log)))


def _manifest() -> list[bytes]:
    spec = GridSpec(0.05, -1.0, -2.0, (4, 5))
    files = {"cells.bin": FileSum.of((b"cells",))}
    return [Manifest("lab", 3, 1_700_000_000_000_000_000, "ab", spec, files, {"note": "a"}, None).encode()]


def _stops() -> list[bytes]:
    return [encode_stops(made_stops(1, 1, 4)), encode_stops(made_stops(1, 0))]


def _stops_unpacked() -> list[bytes]:
    return [zlib.decompress(data.partition(b"\n")[2]) for data in _stops()]


def _stops_of(content: bytes) -> object:
    """Whatever is read as stops can be written, and is read as the same."""
    stops = decode_stops(b"robotd stops 1\n" + zlib.compress(content, 0))
    assert decode_stops(encode_stops(stops)) == stops
    return stops


def _of_clients(data: bytes) -> object:
    return list(Reader(longest_bytes=4096, most_frames=4).feed(data))


def _clients() -> list[bytes]:
    hello = GREETING + ready(b"DEALER")
    return [GREETING, hello, hello + message(b"\x01pose\0"), hello + message(b"", b"request") + pong(Ping(b"abc"))]


def _of_front(data: bytes) -> object:
    return list(Unframer(4096).feed(data))


DOCUMENTS = (
    Target("zmtp", _of_clients, _clients, ("robotd/server/zmtp.py",), typed=(Violation,), size_max=512),
    Target(
        "channel",
        _of_front,
        lambda: [header(3) + b"abc" + header(0)],
        ("robotd/children/message_framing.py",),
        typed=(RemoteProtocolError,),
        size_max=512,
    ),
    Target(
        "front-messages",
        said,
        lambda: [b"".join(event(Odometry(1, IDENTITY, STANDSTILL))), b"".join(answer(1, Done()))],
        ("robotd/front/messages.py",),
        typed=(ChildError,),
        size_max=512,
    ),
    Target("requests", _answered, _requests, ("robotd/contract/envelope.py",), size_max=512),
    Target(
        "replies", decode_reply, _replies, ("robotd/contract/envelope.py",), typed=(RemoteProtocolError,), size_max=512
    ),
    Target(
        "configuration",
        _configured,
        _configurations,
        ("robotd/config",),
        typed=(ConfigError,),
        tokens=(b"[drive]\n", b"[sweep]\n", b"dialect = ", b"readings = ", b"true", b"[[drive]]\n", b"''", b'"'),
        size_max=8 * KIB,
        peak_max=4 * MIB,
    ),
    Target(
        "world",
        lambda data: parse_world(_text(data), file="world"),
        lambda: [(ROOT / "robotd/sim/buildings/worlds/laboratory.toml").read_bytes()],
        ("robotd/sim/buildings/world.py",),
        typed=(ConfigError,),
        tokens=(b"[start]\n", b"[[wall]]\n", b"points_m = ", b"[1.0, 2.0]"),
        size_max=8 * KIB,
        peak_max=4 * MIB,
    ),
    Target(
        "carmen-log",
        _log_read,
        _logs,
        ("robotd/logs", "robotd/sim/buildings/log_file.py"),
        typed=(RecordingError,),
        tokens=(
            b"FLASER ",
            b"ROBOTLASER1 ",
            b"ODOM ",
            b"PARAM ",
            b"RLASER ",
            b"RAWLASER1 ",
            b" nan ",
            b" inf ",
            b" 0 ",
            b"laser_front_laser_resolution ",
            b"robot_front_laser_max ",
            b"robot_frontlaser_offset ",
            b"\n",
            b"\x1f\x8b\x08",
            b"BZh9",
            b"\xfd7zXZ\x00",
        ),
    ),
    Target(
        "recording",
        _in_file("a.mcap", read),
        _recordings,
        ("robotd/recording/reader.py", "robotd/recording/encoding.py"),
        typed=(RecordingError,),
        tokens=(b"\x04\0\0\0zstd", b"\x03\0\0\0lz4"),
        size_max=8 * KIB,
    ),
    Target("stops-file", decode_stops, _stops, ("robotd/maps/stops_file.py",), typed=(MapError,)),
    Target(
        "stops",
        _stops_of,
        _stops_unpacked,
        ("robotd/maps/stops_file.py", "robotd/maps/stop_columns.py"),
        typed=(MapError,),
        tokens=(b"\xa7columns", b"\xa6counts", b"\xa8statuses", b"\xc4\x08", b"\xa4miss", b"\xa2ok"),
        size_max=1536,
        peak_max=4 * MIB,
    ),
    Target("manifest", decode_manifest, _manifest, ("robotd/maps/manifest.py",), typed=(MapError,)),
    Target(
        "polygons",
        _in_file("a.wkt", read_map),
        lambda: [
            b"POLYGON ((0 0, 1 0, 1 1, 0 0))",
            b"MULTIPOLYGON (((0 0, 2 0, 2 2, 0 0), (1 0.5, 1.5 0.5, 1.5 1, 1 0.5)))",
        ],
        ("robotd/exact/formats.py", "robotd/cli/exact_inputs.py"),
        typed=(RobotdError,),
        tokens=(b"POLYGON ", b"MULTIPOLYGON ", b"GEOMETRYCOLLECTION (", b" Z ", b"((", b"))", b"EMPTY", b", "),
        size_max=256,
    ),
    Target(
        "beams",
        _in_file("a.txt", read_beams),
        lambda: [b"bearing_deg,range_m\n0,1.5\n90,2\n"],
        ("robotd/exact/readings_table.py", "robotd/cli/exact_inputs.py"),
        typed=(RobotdError,),
        size_max=256,
    ),
)
