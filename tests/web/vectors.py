"""What Python packs, for the console's own tests to unpack: ``python -m tests.web.vectors FILE``."""

import base64
import json
import sys
import tempfile
import zlib
from pathlib import Path

import numpy as np

from robotd.app.replaying import replay_events
from robotd.contract.estimate import PoseEstimate
from robotd.contract.events import Event, MapChanged, MissionProgress, Status
from robotd.contract.topics import Topic, encode_frame, to_wire
from tests.support.recorded_session import laid_together, record_session

ROWS, COLS = 700, 530
SEED = 7


def vectors() -> dict[str, object]:
    """Frames as they go over a browser's socket, and what they say."""
    cells = np.random.default_rng(SEED).integers(0, 256, (ROWS, COLS), dtype=np.uint8)
    place = {"map_id": "m", "resolution_m": 0.05, "origin_x_m": -1.5, "origin_y_m": 2.0, "rows": ROWS, "cols": COLS}
    empty = {"indices_u32le": b"", "values_u8": b"", "cells_zlib": b""}
    whole = {**place, **empty, "generation": 4, "whole": True, "cells_zlib": zlib.compress(cells.tobytes())}
    changed = np.array([0, 5, ROWS * COLS - 1], dtype="<u4")
    change = {
        **place,
        **empty,
        "generation": 5,
        "whole": False,
        "indices_u32le": changed.tobytes(),
        "values_u8": b"\x01\x02\x03",
    }
    cells_after = cells.copy()
    cells_after.reshape(-1)[changed] = (1, 2, 3)
    pose = {"event": "pose_estimate", "time_ns": 2**53 - 1, "state": "localized", "best": {"x_m": 1.25, "y_m": -2.5}}
    readings = {
        "event": "sweep_readings",
        "number": 3,
        "first": 0,
        "bearing_f32le": np.array([0.5, -1.0], dtype="<f4").tobytes(),
        "range_f32le": np.array([2.5, np.nan], dtype="<f4").tobytes(),
        "status_u8": bytes([0, 3]),
        "origin_x_f32le": b"",
        "origin_y_f32le": b"",
    }
    return {
        **_session(),
        "pose": _socket(Topic.POSE, 412, pose),
        "whole": _socket(Topic.MAP, 1, {"event": "map_changed", **whole}),
        "change": _socket(Topic.MAP, 2, {"event": "map_changed", **change}),
        "readings": _socket(Topic.SWEEP, 9, readings),
        "sum_before": int(cells.astype(np.int64).sum()),
        "crc_after": zlib.crc32(cells_after.tobytes()),
    }


def _session() -> dict[str, object]:
    """A recorded robot that maps a stop and finds itself: all that it tells, and what that comes to."""
    told: list[Event] = []
    with tempfile.TemporaryDirectory() as directory:
        replay_events(record_session(Path(directory)), told.append)
    frames = []
    for seq, event in enumerate(told):
        topic, fields = to_wire(event)
        frames.append(_socket(topic, seq, fields))
    estimates = [event for event in told if isinstance(event, PoseEstimate)]
    missions = [event for event in told if isinstance(event, MissionProgress)]
    statuses = [event for event in told if isinstance(event, Status)]
    best = estimates[-1].best
    assert best is not None
    cells = laid_together([event for event in told if isinstance(event, MapChanged)])
    return {
        "session": frames,
        "session_map_crc": zlib.crc32(cells.tobytes()),
        "session_best": [best.x_m, best.y_m, best.heading_rad],
        "session_mission": [missions[-1].mission_id, missions[-1].kind, str(missions[-1].phase)],
        "session_mode": statuses[-1].mode,
    }


def _socket(topic: Topic, seq: int, fields: dict[str, object]) -> str:
    return base64.b64encode(b"\x01" + encode_frame(topic, "session", seq, fields)).decode()


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(json.dumps(vectors()), encoding="utf-8")
