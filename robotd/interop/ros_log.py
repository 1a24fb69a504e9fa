"""What was heard of a bag as a log: each scan at its place on the robot, and the robot where it was at its time.

Ranges mean what REP 117 says: infinite, or beyond ``range_max``, that nothing came back; NaN, or nearer than
``range_min``, that nothing was measured. Each scan is taken to have been made at its stamp, as one.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from robotd.core.errors import RecordingError
from robotd.core.pose import Pose2
from robotd.interop.ros_frames import ON_THE_AXIS, Chain, Mount
from robotd.interop.ros_heard import HeardBag, HeardLaser
from robotd.logs.no_returns import code_from_m, code_remark
from robotd.logs.pose_track import PoseTrack
from robotd.logs.provenance import Fit, fit_of
from robotd.logs.scan import PoseSource, RecordedLog, Scan


@dataclass(frozen=True, slots=True)
class _Way:
    """Where the robot was."""

    odometry: PoseTrack
    odometry_name: str
    map_from_odom: PoseTrack | None
    """How a localizer tied odometry to its map, while it ran; None if none did."""

    def at(self, time_s: float) -> tuple[Pose2, Pose2] | None:
        """Return the pose by odometry, and on the map; None where one is not known."""
        odometry = self.odometry.at(time_s)
        if odometry is None:
            return None
        if self.map_from_odom is None:
            return odometry, odometry
        tie = self.map_from_odom.at(time_s)
        return None if tie is None else (odometry, tie @ odometry)


@dataclass(frozen=True, slots=True, eq=False)
class _Placed:
    """A scan, and where the robot was: by odometry, and on the map."""

    laser: HeardLaser
    odometry: Pose2
    robot: Pose2


def log_of(heard: HeardBag, odometry_topic: str | None, remarks: Sequence[str] = ()) -> RecordedLog:
    """Return what was heard as a log.

    Args:
        heard: at least one whole scan.
        odometry_topic: which topic said what was heard of odometry, if one did.
        remarks: what must be told of it already.

    Raises:
        RecordingError: no scan is whole, or nothing says where the robot was at any.
    """
    if not heard.lasers:
        raise RecordingError(f"none of its {heard.damaged} scans is whole")
    # Of one scanner: scans of two at different heights are no one's view of the room.
    frame = heard.lasers[0].frame
    chain = heard.frames.chain(frame, heard.robot)
    way = _way(heard, chain, odometry_topic)
    placed = [
        _Placed(laser, *poses)
        for laser in heard.lasers
        if laser.frame == frame
        for poses in [way.at(laser.time_s)]
        if poses is not None
    ]
    if not placed:
        raise RecordingError(
            f"at the time of no scan it is known where the robot was: {way.odometry_name} is of others"
        )
    mount = chain.mount if heard.frames.knows(frame) else None
    limits_m = [one.laser.farthest_m for one in placed]
    code_m = code_from_m([one.laser.ranges_m for one in placed], [one.robot for one in placed], limits_m)
    scans = tuple(
        _scan(one, mount or ON_THE_AXIS, min(limit_m, code_m)) for one, limit_m in zip(placed, limits_m, strict=True)
    )
    source, why = _provenance(way, scans)
    assumed = (
        *remarks,
        *_left_out(heard, len(placed)),
        *_mounted(mount, frame),
        *code_remark(code_m),
    )
    return RecordedLog(scans, min(code_m, *limits_m), source, why, assumed=assumed)


def _way(heard: HeardBag, chain: Chain, odometry_topic: str | None) -> _Way:
    """Return where the robot was by what says it best: odometry's own messages, if they are of this robot's frame.

    Raises:
        RecordingError: nothing does.
    """
    tie = chain.moving[1][1] if len(chain.moving) > 1 else None
    # Messages before frames: they come at the odometry's own rate, frames at whatever somebody published them.
    if heard.odometry and (chain.robot == heard.robot or not chain.moving):
        return _Way(PoseTrack.of(heard.odometry), f"{odometry_topic}", tie)
    if chain.moving:
        frame, track = chain.moving[0]
        return _Way(track, f"frame {frame}", tie)
    raise RecordingError(
        f"nothing says where the robot was: there is no nav_msgs/Odometry, and no frame in which {chain.robot} moved"
    )


def _scan(placed: _Placed, mount: Mount, limit_m: float) -> Scan:
    laser = placed.laser
    first_rad, ranges_m = laser.first_rad, laser.ranges_m
    if mount.is_upside_down:  # seen from above the last beam is the first
        first_rad, ranges_m = -(first_rad + laser.step_rad * (len(ranges_m) - 1)), ranges_m[::-1]
    missed = ranges_m >= limit_m
    return Scan(
        robot_pose=placed.robot,
        robot_from_laser=mount.robot_from_laser,
        odometry=placed.odometry,
        angles_rad=first_rad + laser.step_rad * np.arange(len(ranges_m), dtype=np.float64),
        ranges_m=ranges_m,
        hit=np.isfinite(ranges_m) & (ranges_m >= laser.nearest_m) & (ranges_m > 0.0) & ~missed,
        missed=missed,
        time_s=laser.time_s,
    )


def _provenance(way: _Way, scans: tuple[Scan, ...]) -> tuple[PoseSource, str]:
    if way.map_from_odom is not None:
        return PoseSource.CORRECTED, "a localizer tied odometry to its map while it was recorded"
    if fit_of(scans) is Fit.GOOD:
        return PoseSource.LOG, "where the robot came by again, its scans fit each other"
    return PoseSource.RAW_ODOMETRY, f"they are those of {way.odometry_name}, and no map frame corrects them"


def _left_out(heard: HeardBag, placed: int) -> Iterator[str]:
    if heard.damaged:
        yield f"{heard.damaged} scans were left out: their angles or ranges are none"
    if placed < len(heard.lasers):
        yield f"{len(heard.lasers) - placed} scans were left out: it is not known where the robot was at their time"


def _mounted(mount: Mount | None, frame: str) -> Iterator[str]:
    if mount is None:
        yield f"no frame says where {frame or 'the scanner'} sits on the robot: taken to be on its axis, looking ahead"
    elif mount.is_upside_down:
        yield f"{frame} hangs upside down: its beams are taken the other way round"
    if mount is not None and mount.tilt_rad:
        yield f"{frame} is {math.degrees(mount.tilt_rad):.1f} deg from level: its ranges are taken as if it were not"
