"""What a gateway reads: of browsers, of Foxglove's app, of what people bring, and of the daemon."""

import io
import json
import zipfile

from robotd.contract.topics import Frame, Topic, encode_frame
from robotd.core.errors import MapError, RobotdError, ServerError
from robotd.gateway.access.origins import check_host, check_origin
from robotd.gateway.access.roles import Role
from robotd.gateway.browser.asked_by_page import request_of
from robotd.gateway.browser.console_protocol import Command, StartMission, said
from robotd.gateway.browser.foxglove_protocol import MOST_SUBSCRIPTIONS, Subscriptions
from robotd.gateway.feed.foxglove_channels import FoxgloveChannels
from robotd.gateway.feed.heard_frames import HeardFrame
from robotd.gateway.feed.snapshot import Snapshot
from robotd.interop.map_bundle import map_of_files
from tests.studies.fuzz.target import KIB, MIB, Target

_YAML = b"image: a.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
_TOLD_BADLY = (RobotdError, ValueError, KeyError, TypeError)
"""What a frame that is not what its name promises may come to: it is left out (``FanOut``)."""


def _texts() -> list[bytes]:
    texts = (
        {"type": "answer", "n": 3},
        {"type": "stop", "id": 1},
        {"type": "command", "id": 2, "cmd": "map_load", "args": {"name": "office", "version": 3}},
        {"type": "mission", "id": 3, "cmd": "drive_to", "args": {"x_m": 1.5, "y_m": -2}, "attended": True},
        {"type": "hand_over", "id": 4, "give": True},
        {"type": "look", "rank": True},
    )
    return [json.dumps(text).encode() for text in texts]


def _text_taken(data: bytes) -> object:
    found = said(data.decode("utf-8", "replace"))
    if isinstance(found, Command | StartMission):
        return request_of(found.cmd, found.args, Role.ADMIN)
    return found


def _app_taken(data: bytes) -> object:
    subscriptions = Subscriptions()
    wanted = subscriptions.take(data.decode("utf-8", "replace"))
    assert len(subscriptions.of(wanted[0])) <= MOST_SUBSCRIPTIONS if wanted else True
    return wanted


def _headers_read(data: bytes) -> None:
    """Two lines: a host and an origin, as anybody may write them."""
    host, _, origin = data.decode("latin-1").partition("\n")
    check_host(host, ("robot.lab",))
    check_origin("POST", {"Host": host, "Origin": origin}, "https", is_socket=True)
    assert origin.lower().startswith("https://")


def _zips() -> list[bytes]:
    made = []
    for kind in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        written = io.BytesIO()
        with zipfile.ZipFile(written, "w", kind) as archive:
            archive.writestr("a.yaml", _YAML)
            archive.writestr("a.pgm", b"P5 2 2 255\n\x00\xfe\xcd\xfe")
        made.append(written.getvalue())
    return made


def _frames() -> list[bytes]:
    place = {"map_id": "m", "generation": 0, "whole": False, "resolution_m": 0.05, "origin_x_m": 0.0, "origin_y_m": 0.0}
    cells = {"rows": 2, "cols": 2, "cells_zlib": b"", "indices_u32le": bytes(4), "values_u8": b"\x07", "stops": None}
    mission = {"mission_id": 1, "kind": "drive", "phase": "driving", "stop": 0, "stops": 1, "message": "on its way"}
    pose, twist = {"x_m": 0.0, "y_m": 0.0, "heading_rad": 0.0}, {"speed_mps": 0.0, "turn_radps": 0.0}
    return [
        encode_frame(Topic.MAP, "s", 1, {"event": "map_changed", "time_ns": 1, **place, **cells}),
        encode_frame(Topic.MISSION, "s", 2, {"event": "mission_progress", "time_ns": 1, **mission}),
        encode_frame(Topic.ODOMETRY, "s", 3, {"event": "odometry", "time_ns": 1, "in_odom": pose, "twist": twist}),
    ]


def _frame_told(data: bytes) -> object:
    frame = Frame.of(data)
    snapshot = Snapshot()
    snapshot.accept(HeardFrame.read(frame), 0)
    return list(snapshot.frames()), FoxgloveChannels(0).take(frame)


BROWSERS = (
    Target(
        "console-text",
        _text_taken,
        _texts,
        ("robotd/gateway/browser/console_protocol.py", "robotd/gateway/browser/asked_by_page.py"),
        typed=(ServerError,),
        tokens=(b'"stop"', b'"type"', b'"args"', b"NaN", b"1e999", b"\\u0000", b"[" * 40, b'"explore"'),
    ),
    Target(
        "foxglove-text",
        _app_taken,
        lambda: [
            b'{"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 2}]}',
            b'{"op": "unsubscribe", "subscriptionIds": [1]}',
        ],
        ("robotd/gateway/browser/foxglove_protocol.py",),
        typed=(ServerError,),
    ),
    Target(
        "browser-headers",
        _headers_read,
        lambda: [b"robot.lab:8470\nhttps://robot.lab:8470", b"[::1]:8470\nhttps://[::1]:8470"],
        ("robotd/gateway/access/origins.py",),
        typed=(ServerError,),
        tokens=(b"[", b"]", b"@", b":", b"//", b"https://", b"\n", b"null"),
        size_max=200,
    ),
    Target(
        "map-zip",
        lambda data: map_of_files({"a.zip": data}, None),
        _zips,
        ("robotd/interop/map_bundle.py",),
        typed=(MapError,),
        tokens=(b"PK\x01\x02", b"PK\x03\x04", b"PK\x05\x06", b"../a.pgm", b"\xff\xff\xff\xff"),
        size_max=KIB,
        peak_max=64 * MIB,
    ),
    Target(
        "told-frames",
        _frame_told,
        _frames,
        ("robotd/gateway/feed",),
        typed=_TOLD_BADLY,
        tokens=(b"map_changed\0", b"status\0", b"\xcb\x7f\xf8", b"\xdf\xff\xff\xff\xff"),
    ),
)
