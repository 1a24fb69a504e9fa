"""What the daemon tells as Foxglove's well-known messages, in JSON: a recording so made opens there as it is.

Frames are ``map``, ``odom`` and ``robot``. Schemas: https://docs.foxglove.dev/docs/visualization/message-schemas.
"""

import base64
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from robotd.contract.estimate import PoseEstimate
from robotd.contract.events import MapChanged, SweepDone
from robotd.contract.topics import LogEntry
from robotd.core.clock import NS_PER_S
from robotd.core.pose import Odometry, Pose2
from robotd.core.reading import ReadingStatus
from robotd.interop.scene import Scene

_UINT8 = 1
_NUMBER = {"type": "number"}
_OBJECT = {"type": "object"}
_LIST = {"type": "array"}
_TIME = {"type": "object", "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}}}
_HEAD: dict[str, Any] = {"timestamp": _TIME, "frame_id": {"type": "string"}}
_LEVELS = {"DEBUG": 1, "INFO": 2, "WARNING": 3, "ERROR": 4, "CRITICAL": 5}


SCHEMAS: dict[str, dict[str, Any]] = {
    name: {"title": name, "type": "object", "properties": properties}
    for name, properties in {
        "foxglove.Grid": {
            **_HEAD,
            "pose": _OBJECT,
            "column_count": {"type": "integer"},
            "cell_size": _OBJECT,
            "row_stride": {"type": "integer"},
            "cell_stride": {"type": "integer"},
            "fields": _LIST,
            "data": {"type": "string", "contentEncoding": "base64"},
        },
        "foxglove.FrameTransforms": {"transforms": _LIST},
        "foxglove.PosesInFrame": {**_HEAD, "poses": _LIST},
        "foxglove.LaserScan": {
            **_HEAD,
            "pose": _OBJECT,
            "start_angle": _NUMBER,
            "end_angle": _NUMBER,
            "ranges": _LIST,
            "intensities": _LIST,
        },
        "foxglove.Log": {
            "timestamp": _TIME,
            **{name: {"type": "string"} for name in ("message", "name", "file")},
            **{name: {"type": "integer"} for name in ("level", "line")},
        },
    }.items()
}
"""JSON schemas by the names that are known there: what the messages here hold of them."""


@dataclass(frozen=True, slots=True)
class FoxgloveMessage:
    """A message, its channel, and the name of its schema."""

    topic: str
    schema: str
    content: dict[str, Any]
    """As it is in JSON."""


class FoxgloveFrames:
    """Turns events into messages, one after the other: the frames are tied by the latest that was told."""

    def __init__(self, wall_offset_ns: int) -> None:
        """Take from monotonic to Unix time [ns]."""
        self._wall_offset_ns = wall_offset_ns
        self._scene = Scene()

    def messages(self, event: object) -> Iterator[FoxgloveMessage]:
        """Yield what an event is told as; nothing for what has no form there."""
        self._scene.take(event)
        match event:
            case Odometry():
                yield self._frames(event.time_ns)
            case PoseEstimate():
                yield from self._estimate(event)
            case SweepDone():
                yield self._scan(event)
            case MapChanged():
                yield self._grid(event)
            case LogEntry():
                yield self._log(event)

    def _grid(self, change: MapChanged) -> FoxgloveMessage:
        """Return the whole map, a byte a cell: there is no message for a part of it."""
        spec = change.spec
        content = {
            "timestamp": self._time(change.time_ns),
            "frame_id": "map",
            "pose": _pose(Pose2(spec.origin_x_m, spec.origin_y_m, 0.0)),
            "column_count": spec.cols,
            "cell_size": {"x": spec.resolution_m, "y": spec.resolution_m},
            "row_stride": spec.cols,
            "cell_stride": 1,
            "fields": [{"name": "occupancy", "offset": 0, "type": _UINT8}],
            "data": base64.b64encode(self._scene.cells.tobytes()).decode(),
        }
        return FoxgloveMessage("/map", "foxglove.Grid", content)

    def _frames(self, time_ns: int) -> FoxgloveMessage:
        time = self._time(time_ns)
        ties = [("map", "odom", self._scene.map_from_odom), ("odom", "robot", self._scene.in_odom)]
        transforms = [
            {"timestamp": time, "parent_frame_id": parent, "child_frame_id": child, **_transform(pose)}
            for parent, child, pose in ties
        ]
        return FoxgloveMessage("/tf", "foxglove.FrameTransforms", {"transforms": transforms})

    def _estimate(self, estimate: PoseEstimate) -> Iterator[FoxgloveMessage]:
        if estimate.best is not None:
            yield self._frames(estimate.time_ns)
        places = [estimate.best] if estimate.best is not None else [region.pose for region in estimate.regions]
        poses = {
            "timestamp": self._time(estimate.time_ns),
            "frame_id": "map",
            "poses": [_pose(pose) for pose in places],
        }
        yield FoxgloveMessage(f"/pose/{estimate.state}", "foxglove.PosesInFrame", poses)

    def _scan(self, done: SweepDone) -> FoxgloveMessage:
        readings = done.sweep.readings
        bearings = [reading.bearing_rad for reading in readings] or [0.0]
        # Told in the frame that the sweep was taken in, which is the robot's as long as it stands there.
        content = {
            "timestamp": self._time(done.time_ns),
            "frame_id": "odom",
            "pose": _pose(done.sweep.in_odom),
            "start_angle": bearings[0],
            "end_angle": bearings[-1],
            # JSON has no infinity: what met nothing and what failed are left out as Foxglove leaves out nulls.
            "ranges": [reading.range_m if reading.status is ReadingStatus.OK else None for reading in readings],
            "intensities": [float(reading.strength or 0) for reading in readings],
        }
        return FoxgloveMessage("/sweep", "foxglove.LaserScan", content)

    def _log(self, entry: LogEntry) -> FoxgloveMessage:
        content = {
            "timestamp": self._time(entry.time_ns),
            "level": _LEVELS.get(entry.level, 0),
            "message": entry.message,
            "name": entry.logger,
            "file": "",
            "line": 0,
        }
        return FoxgloveMessage("/log", "foxglove.Log", content)

    def unix_ns(self, time_ns: int) -> int:
        """Return a monotonic time as Unix time [ns]."""
        return time_ns + self._wall_offset_ns

    def _time(self, time_ns: int) -> dict[str, int]:
        seconds, nanoseconds = divmod(self.unix_ns(time_ns), NS_PER_S)
        return {"sec": seconds, "nsec": nanoseconds}


def _pose(pose: Pose2) -> dict[str, Any]:
    return {"position": {"x": pose.x_m, "y": pose.y_m, "z": 0.0}, "orientation": quaternion(pose.heading_rad)}


def _transform(pose: Pose2) -> dict[str, Any]:
    return {"translation": {"x": pose.x_m, "y": pose.y_m, "z": 0.0}, "rotation": quaternion(pose.heading_rad)}


def quaternion(heading_rad: float) -> dict[str, float]:
    """Return a heading as a quaternion about the upright axis."""
    return {"x": 0.0, "y": 0.0, "z": math.sin(heading_rad / 2), "w": math.cos(heading_rad / 2)}
