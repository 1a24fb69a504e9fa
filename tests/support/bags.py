"""Bags of a robot in the room of :mod:`tests.support.carmen_room`, written by rosbags: nothing of ours is in them."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from robotd.core.pose import IDENTITY, Pose2
from tests.support.carmen_room import POSES, angles_rad, ranges_m

TF = "tf2_msgs/msg/TFMessage"
STEP_S = 0.5


@dataclass(frozen=True, slots=True)
class Recorded:
    """What the recorded robot did and has."""

    drift: Pose2 = IDENTITY
    """How odometry's frame lies on the map at the end; it goes there evenly."""
    has_map: bool = False
    has_odometry: bool = True
    pose_every: int = 1
    """Which scans odometry and frames have a pose for."""
    mount: Pose2 | None = field(default_factory=lambda: Pose2(0.2, -0.05, 0.3))
    upside_down: bool = False
    clockwise: bool = False
    spoil: Callable[[np.ndarray[Any, Any]], None] = lambda _: None
    scan_topics: Sequence[str] = ("/scan",)
    slash: str = ""
    """What some put before the names of frames in ROS 1."""

    def map_from_odom(self, number: int) -> Pose2:
        share = number / (len(POSES) - 1)
        return Pose2(*(share * value for value in (self.drift.x_m, self.drift.y_m, self.drift.heading_rad)))


class _Messages:
    def __init__(self, types: Any, slash: str) -> None:
        self._types = types
        self._slash = slash
        self._seq = {"seq": 0} if "seq" in types["std_msgs/msg/Header"].__dataclass_fields__ else {}

    def of(self, name: str, **fields: Any) -> Any:
        package, kind = name.split("/")
        return self._types[f"{package}/msg/{kind}"](**fields)

    def header(self, time_s: float, frame: str) -> Any:
        stamp = self.of("builtin_interfaces/Time", sec=int(time_s), nanosec=round(time_s % 1.0 * 1e9))
        return self.of("std_msgs/Header", **self._seq, stamp=stamp, frame_id=self._slash + frame)

    def turn(self, heading_rad: float, *, upside_down: bool = False) -> Any:
        sin, cos = math.sin(heading_rad / 2), math.cos(heading_rad / 2)
        # A half turn about x first: (cos, 0, 0, sin) * (0, 1, 0, 0).
        told = (cos, sin, 0.0, 0.0) if upside_down else (0.0, 0.0, sin, cos)
        return self.of("geometry_msgs/Quaternion", **dict(zip("xyzw", told, strict=True)))

    def pose(self, pose: Pose2) -> Any:
        point = self.of("geometry_msgs/Point", x=pose.x_m, y=pose.y_m, z=0.0)
        return self.of("geometry_msgs/Pose", position=point, orientation=self.turn(pose.heading_rad))

    def tie(self, time_s: float, parent: str, child: str, pose: Pose2, *, upside_down: bool = False) -> Any:
        place = self.of("geometry_msgs/Vector3", x=pose.x_m, y=pose.y_m, z=0.3)
        turn = self.turn(pose.heading_rad, upside_down=upside_down)
        transform = self.of("geometry_msgs/Transform", translation=place, rotation=turn)
        tied = self.of(
            "geometry_msgs/TransformStamped",
            header=self.header(time_s, parent),
            child_frame_id=self._slash + child,
            transform=transform,
        )
        return self.of("tf2_msgs/TFMessage", transforms=[tied])

    def odometry(self, time_s: float, pose: Pose2) -> Any:
        zero = self.of("geometry_msgs/Vector3", x=0.0, y=0.0, z=0.0)
        twist = self.of("geometry_msgs/Twist", linear=zero, angular=zero)
        return self.of(
            "nav_msgs/Odometry",
            header=self.header(time_s, "odom"),
            child_frame_id=f"{self._slash}base_link",
            pose=self.of("geometry_msgs/PoseWithCovariance", pose=self.pose(pose), covariance=np.zeros(36)),
            twist=self.of("geometry_msgs/TwistWithCovariance", twist=twist, covariance=np.zeros(36)),
        )

    def scan(self, time_s: float, first_rad: float, step_rad: float, ranges: np.ndarray[Any, Any]) -> Any:
        return self.of(
            "sensor_msgs/LaserScan",
            header=self.header(time_s, "laser"),
            angle_min=first_rad,
            angle_max=first_rad + step_rad * (len(ranges) - 1),
            angle_increment=step_rad,
            time_increment=0.0,
            scan_time=0.1,
            range_min=0.05,
            range_max=30.0,
            ranges=ranges.astype(np.float32),
            intensities=np.zeros(0, np.float32),
        )


def write_room_bag(path: Path, recorded: Recorded | None = None) -> Path:
    """Write a bag of ROS 1 if its name ends with ``.bag``, else one of ROS 2: in sqlite3 where it ends with ``3``."""
    recorded = recorded or Recorded()
    if path.suffix == ".bag":
        store = get_typestore(Stores.ROS1_NOETIC)
        store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", TF))
        writer: Any = Writer1(path)
        serialized: Any = store.serialize_ros1
    else:
        store = get_typestore(Stores.ROS2_HUMBLE)
        plugin = StoragePlugin.SQLITE3 if path.name.endswith("3") else StoragePlugin.MCAP
        writer, serialized = Writer2(path, version=9, storage_plugin=plugin), store.serialize_cdr
    connections: dict[str, Any] = {}
    with writer as bag:
        for topic, kind, time_s, message in _told(_Messages(store.types, recorded.slash), recorded):
            if topic not in connections:
                connections[topic] = bag.add_connection(topic, kind, typestore=store)
            bag.write(connections[topic], round(time_s * 1e9), serialized(message, kind))
    return path


def _told(messages: _Messages, recorded: Recorded) -> Any:
    mount = recorded.mount or IDENTITY
    if recorded.mount is not None:  # by way of a frame between
        yield "/tf_static", TF, 100.0, messages.tie(0.0, "base_link", "plate", Pose2(0.1, 0.0, 0.0))
        on_plate = Pose2(0.1, 0.0, 0.0).inverse() @ mount
        tie = messages.tie(0.0, "plate", "laser", on_plate, upside_down=recorded.upside_down)
        yield "/tf_static", TF, 100.0, tie
    for number, pose in enumerate(POSES):
        time_s, tie_on_map = 100.0 + number * STEP_S, recorded.map_from_odom(number)
        in_odom = tie_on_map.inverse() @ pose
        if recorded.has_map:
            yield "/tf", TF, time_s, messages.tie(time_s, "map", "odom", tie_on_map)
        if number % recorded.pose_every == 0:
            yield "/tf", TF, time_s, messages.tie(time_s, "odom", "base_link", in_odom)
        if number % recorded.pose_every == 0 and recorded.has_odometry:
            yield "/odom", "nav_msgs/msg/Odometry", time_s, messages.odometry(time_s, in_odom)
        angles = angles_rad()
        seen_at = -angles if recorded.upside_down else angles  # as seen from above
        ranges = ranges_m(pose @ mount, seen_at)
        recorded.spoil(ranges)
        first_rad, step_rad = float(angles[0]), float(angles[1] - angles[0])
        if recorded.clockwise:
            first_rad, step_rad, ranges = float(angles[-1]), -step_rad, ranges[::-1]
        for topic in recorded.scan_topics:
            yield topic, "sensor_msgs/msg/LaserScan", time_s, messages.scan(time_s, first_rad, step_rad, ranges)
