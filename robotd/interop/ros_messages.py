"""What the daemon tells as messages of ROS, the same ones for ROS 1 and ROS 2 but for how they are packed.

Frames are those of REP 105: ``map``, ``odom``, ``base_link``. A sweep takes a minute, in which the robot may turn under
its head: it is told in a frame of its own, ``sweep``, where the robot stood when it began. A pose is told only where
there is one; where several are possible they are all told, on a topic of another name.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotd.contract.estimate import PoseEstimate
from robotd.contract.events import MapChanged, SweepDone
from robotd.core.clock import NS_PER_S
from robotd.core.pose import Odometry, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.tables import NO_INFORMATION
from robotd.interop.fan import BeamFan, from_axis_m
from robotd.interop.foxglove_messages import quaternion
from robotd.interop.scene import Scene

MAP, ODOMETRY, FRAMES, SCAN, POSE, PLACES = "/map", "/odom", "/tf", "/scan", "/pose", "/pose/possible"
TYPES: Mapping[str, str] = {
    MAP: "nav_msgs/msg/OccupancyGrid",
    ODOMETRY: "nav_msgs/msg/Odometry",
    FRAMES: "tf2_msgs/msg/TFMessage",
    SCAN: "sensor_msgs/msg/LaserScan",
    POSE: "geometry_msgs/msg/PoseWithCovarianceStamped",
    PLACES: "geometry_msgs/msg/PoseArray",
}
"""Topics, and what is told on each."""
_PLANAR = (0, 1, 5)
"""Which of the six numbers of a pose are x, y and heading."""


@dataclass(frozen=True, slots=True)
class RosMessage:
    """A message and its topic."""

    topic: str
    content: Any
    """Of the type that its topic has, as the library makes it."""


class RosMessages:
    """Turns events into messages, one after the other."""

    def __init__(self, wall_offset_ns: int, types: Mapping[str, type]) -> None:
        """Take from monotonic to Unix time [ns], and the types of a ROS by their names."""
        self._wall_offset_ns = wall_offset_ns
        self._types = types
        self._scene = Scene()
        # ROS 1 counts its headers, and differs in nothing else.
        self._counts = {"seq": 0} if "seq" in types["std_msgs/msg/Header"].__dataclass_fields__ else {}  # type: ignore[attr-defined]  # a dataclass

    def messages(self, event: object) -> Iterator[RosMessage]:
        """Yield what an event is told as; nothing for what has no form there."""
        self._scene.take(event)
        match event:
            case Odometry():
                yield self._odometry(event)
                yield self._frames(event.time_ns)
            case PoseEstimate():
                yield from self._estimate(event)
            case SweepDone() if len(event.sweep.readings) >= 2:
                yield from self._sweep(event.sweep)
            case MapChanged():
                yield self._map(event)

    def unix_ns(self, time_ns: int) -> int:
        """Return a monotonic time as Unix time [ns]."""
        return time_ns + self._wall_offset_ns

    def _odometry(self, odometry: Odometry) -> RosMessage:
        linear = self._of("Vector3", "geometry_msgs", x=odometry.twist.speed_mps, y=0.0, z=0.0)
        angular = self._of("Vector3", "geometry_msgs", x=0.0, y=0.0, z=odometry.twist.turn_radps)
        twist = self._of("Twist", "geometry_msgs", linear=linear, angular=angular)
        content = self._types[TYPES[ODOMETRY]](
            header=self._header(odometry.time_ns, "odom"),
            child_frame_id="base_link",
            pose=self._uncertain("Pose", self._pose(odometry.in_odom)),
            twist=self._uncertain("Twist", twist),
        )
        return RosMessage(ODOMETRY, content)

    def _frames(self, time_ns: int) -> RosMessage:
        ties = [("map", "odom", self._scene.map_from_odom), ("odom", "base_link", self._scene.in_odom)]
        return self._tied(time_ns, ties)

    def _tied(self, time_ns: int, ties: list[tuple[str, str, Pose2]]) -> RosMessage:
        transforms = [
            self._of(
                "TransformStamped",
                "geometry_msgs",
                header=self._header(time_ns, parent),
                child_frame_id=child,
                transform=self._of(
                    "Transform",
                    "geometry_msgs",
                    translation=self._of("Vector3", "geometry_msgs", x=pose.x_m, y=pose.y_m, z=0.0),
                    rotation=self._turn(pose),
                ),
            )
            for parent, child, pose in ties
        ]
        return RosMessage(FRAMES, self._types[TYPES[FRAMES]](transforms=transforms))

    def _estimate(self, estimate: PoseEstimate) -> Iterator[RosMessage]:
        header = self._header(estimate.time_ns, "map")
        if estimate.best is None:
            poses = [self._pose(region.pose) for region in estimate.regions]
            yield RosMessage(PLACES, self._types[TYPES[PLACES]](header=header, poses=poses))
            return
        yield self._frames(estimate.time_ns)
        covariance = np.zeros((6, 6))
        if estimate.regions:
            covariance[np.ix_(_PLANAR, _PLANAR)] = estimate.regions[0].covariance
        pose = self._uncertain("Pose", self._pose(estimate.best), covariance)
        yield RosMessage(POSE, self._types[TYPES[POSE]](header=header, pose=pose))

    def _sweep(self, sweep: Sweep) -> Iterator[RosMessage]:
        fan = BeamFan.of(sweep.readings)
        begun_ns, ended_ns = sweep.readings[0].time_ns, sweep.readings[-1].time_ns
        yield self._tied(begun_ns, [("odom", "sweep", sweep.in_odom)])
        ranges_m = np.array([_told_m(reading) for reading in fan.readings], np.float32)
        content = self._types[TYPES[SCAN]](
            header=self._header(begun_ns, "sweep"),
            angle_min=fan.first_rad,
            angle_max=fan.first_rad + fan.step_rad * (len(ranges_m) - 1),
            angle_increment=fan.step_rad,
            time_increment=0.0,  # the head goes its own way, and stops at each reading
            scan_time=(ended_ns - begun_ns) / NS_PER_S,
            range_min=0.0,
            range_max=_limit_m(fan.readings),
            ranges=ranges_m,
            intensities=np.array([float(reading.strength or 0) for reading in fan.readings], np.float32),
        )
        yield RosMessage(SCAN, content)

    def _map(self, change: MapChanged) -> RosMessage:
        spec, cells = change.spec, self._scene.cells
        info = self._of(
            "MapMetaData",
            "nav_msgs",
            map_load_time=self._stamp(change.time_ns),
            resolution=spec.resolution_m,
            width=spec.cols,
            height=spec.rows,
            origin=self._pose(Pose2(spec.origin_x_m, spec.origin_y_m, 0.0)),
        )
        header = self._header(change.time_ns, "map")
        return RosMessage(MAP, self._types[TYPES[MAP]](header=header, info=info, data=_occupancy(cells).ravel()))

    def _header(self, time_ns: int, frame: str) -> Any:
        return self._of("Header", "std_msgs", **self._counts, stamp=self._stamp(time_ns), frame_id=frame)

    def _stamp(self, time_ns: int) -> Any:
        seconds, nanoseconds = divmod(self.unix_ns(time_ns), NS_PER_S)
        return self._of("Time", "builtin_interfaces", sec=seconds, nanosec=nanoseconds)

    def _pose(self, pose: Pose2) -> Any:
        place = self._of("Point", "geometry_msgs", x=pose.x_m, y=pose.y_m, z=0.0)
        return self._of("Pose", "geometry_msgs", position=place, orientation=self._turn(pose))

    def _turn(self, pose: Pose2) -> Any:
        return self._of("Quaternion", "geometry_msgs", **quaternion(pose.heading_rad))

    def _uncertain(self, kind: str, content: Any, covariance: NDArray[np.float64] | None = None) -> Any:
        flat = np.zeros(36) if covariance is None else covariance.ravel()
        return self._of(f"{kind}WithCovariance", "geometry_msgs", **{kind.lower(): content}, covariance=flat)

    def _of(self, kind: str, package: str, **fields: Any) -> Any:
        return self._types[f"{package}/msg/{kind}"](**fields)


def _told_m(reading: RangeReading) -> float:
    """Return a range as REP 117 has it."""
    match reading.status:
        case ReadingStatus.OK:
            return from_axis_m(reading)
        case ReadingStatus.MISS:
            return np.inf
        case ReadingStatus.TOO_NEAR:
            return -np.inf
    return np.nan


def _limit_m(readings: tuple[RangeReading, ...]) -> float:
    """Return the range beyond which nothing is measured: what lies there was not met, and what was met lies nearer."""
    farthest_m = max((from_axis_m(reading) for reading in readings if reading.is_measured), default=1.0)
    return float(np.nextafter(np.float32(farthest_m), np.float32(np.inf)))


def _occupancy(cells: NDArray[np.uint8]) -> NDArray[np.int8]:
    """Return the cells in per cent, -1 where nothing is known."""
    percent = np.rint(np.arange(256) * (100 / 255)).astype(np.int8)
    percent[NO_INFORMATION] = -1
    occupancy: NDArray[np.int8] = percent[cells]
    return occupancy
