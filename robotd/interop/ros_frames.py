"""The frames of ROS (``tf``): who is tied to whom, where the scanner sits on the robot, and where the robot was.

A robot's frames make a tree: map, odom, base, laser. What never moves against its parent is one body with it; so the
lowest frame above the scanner that moves is the robot, the frame that it moves in is odometry's, and one more moving
frame above is the map of a localizer. https://www.ros.org/reps/rep-0105.html
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotd.core.errors import RecordingError
from robotd.core.pose import IDENTITY, Pose2
from robotd.logs.pose_track import PoseTrack

_MOVES_M = 1e-4
_MOVES_RAD = 1e-4
_LEVEL_COS = math.cos(math.radians(2.0))
_DEPTH_MAX = 100

_Turn = NDArray[np.float64]
"""``float64[4, 4]``, from the child's coordinates to the parent's."""


def stamp_s(stamp: Any) -> float:
    """Return a time of ROS in seconds."""
    return float(stamp.sec) + float(stamp.nanosec) * 1e-9


def frame_name(name: str) -> str:
    """Return the name of a frame as ROS 2 has it: without the slash that ROS 1 put before some.

    >>> frame_name("/base_link")
    'base_link'
    """
    return name.lstrip("/")


def flat_pose(position: Any, orientation: Any) -> Pose2:
    """Return a pose of ROS seen from above.

    Raises:
        RecordingError: a number is not finite, or the quaternion is nothing.
    """
    return _flat(_matrix(position, orientation))


@dataclass(frozen=True, slots=True)
class Mount:
    """Where a scanner sits on its robot."""

    robot_from_laser: Pose2
    is_upside_down: bool = False
    """Whether its beams go round clockwise, seen from above."""
    tilt_rad: float = 0.0
    """How far it is from level."""


@dataclass(frozen=True, slots=True)
class Chain:
    """What the frames say of a scanner: the robot, and what the robot moved in, from the nearest frame upwards."""

    mount: Mount
    robot: str
    """Frame of the robot."""
    moving: tuple[tuple[str, PoseTrack], ...]
    """Frames that the robot moved in, each with its track: odometry's first, then perhaps the map's."""


@dataclass(slots=True)
class Frames:
    """All that a bag says of its frames."""

    _ties: dict[str, tuple[str, list[tuple[float, _Turn]]]] = field(default_factory=dict)
    """By child: its parent, and the ties at their times."""

    def take(self, transforms: Iterable[Any]) -> None:
        """Take the transforms of a message.

        Raises:
            RecordingError: one is no transform.
        """
        for tie in transforms:
            parent, child = frame_name(tie.header.frame_id), frame_name(tie.child_frame_id)
            _, ties = self._ties.setdefault(child, (parent, []))
            ties.append((stamp_s(tie.header.stamp), _matrix(tie.transform.translation, tie.transform.rotation)))

    def knows(self, frame: str) -> bool:
        """Return whether a frame is tied to another one."""
        return frame_name(frame) in self._ties

    def chain(self, laser: str, robot: str | None) -> Chain:
        """Return what ties a scanner to the world.

        Args:
            laser: frame of the scanner.
            robot: frame of the robot, if odometry names it; it is believed if it lies above the scanner.

        Raises:
            RecordingError: the scanner moves on the robot.
        """
        above = list(self._above(frame_name(laser)))
        robot = robot if robot in {frame_name(laser), *(parent for parent, _ in above)} else None
        mount, at, frames = np.eye(4), frame_name(laser), list(above)
        while frames and at != robot and not (robot is None and _moves(frames[0][1])):
            parent, ties = frames.pop(0)
            if _moves(ties):
                raise RecordingError(f"the scanner's frame {laser} moves on the robot {robot}: it must sit still there")
            mount, at = ties[-1][1] @ mount, parent
        return Chain(_mount(mount), at, tuple(_tracks(frames)))

    def _above(self, frame: str) -> Iterator[tuple[str, list[tuple[float, _Turn]]]]:
        for _ in range(_DEPTH_MAX):  # who is their own ancestor has no end
            if frame not in self._ties:
                return
            parent, ties = self._ties[frame]
            yield parent, ties
            frame = parent


def _tracks(frames: Iterable[tuple[str, list[tuple[float, _Turn]]]]) -> Iterator[tuple[str, PoseTrack]]:
    """Yield the tracks of the frames that move; those that stand are one with the frame above them."""
    still = np.eye(4)
    for parent, ties in frames:
        if _moves(ties):
            yield parent, PoseTrack.of((time_s, _flat(turn @ still)) for time_s, turn in ties)
            still = np.eye(4)
        else:
            still = ties[-1][1] @ still


def _moves(ties: list[tuple[float, _Turn]]) -> bool:
    poses = [_flat(turn) for _, turn in ties]
    return any(
        before.distance_m(after) > _MOVES_M or abs(before.heading_rad - after.heading_rad) > _MOVES_RAD
        for before, after in pairwise(poses)
    )


def _mount(turn: _Turn) -> Mount:
    up = float(turn[2, 2])
    tilt_rad = 0.0 if abs(up) >= _LEVEL_COS else math.acos(abs(up))
    return Mount(_flat(turn), up < 0.0, tilt_rad)


def _flat(turn: _Turn) -> Pose2:
    return Pose2(float(turn[0, 3]), float(turn[1, 3]), math.atan2(float(turn[1, 0]), float(turn[0, 0])))


def _matrix(position: Any, orientation: Any) -> _Turn:
    x, y, z, w = orientation.x, orientation.y, orientation.z, orientation.w
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    place = (float(position.x), float(position.y), float(position.z))
    if not (math.isfinite(norm) and norm > 1e-6 and all(map(math.isfinite, place))):
        raise RecordingError(f"a pose is none: position {place}, quaternion {(x, y, z, w)}")
    x, y, z, w = x / norm, y / norm, z / norm, w / norm
    turn = np.eye(4)
    turn[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    turn[:3, 3] = place
    return turn


ON_THE_AXIS = Mount(IDENTITY)
"""A scanner of which nothing is said."""
