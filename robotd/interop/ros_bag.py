"""Bags of ROS 1 and ROS 2 as logs: laser scans, each where odometry or a localizer's frames say that it was taken.

Read are ``sensor_msgs/LaserScan``, ``nav_msgs/Odometry`` and the frames of ``tf``.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from robotd.core.errors import RecordingError, RobotdError
from robotd.core.text import printable
from robotd.interop.bags_extra import require_bags
from robotd.interop.ros_heard import FRAMES, ODOMETRY, SCAN, HeardBag
from robotd.interop.ros_log import log_of
from robotd.logs.scan import RecordedLog

if TYPE_CHECKING:
    from rosbags.highlevel import AnyReader


@dataclass(frozen=True, slots=True)
class _Topics:
    """Which topics are read."""

    scan: str
    odometry: str | None
    others: tuple[str, ...]
    """Of further scanners."""


def read_bag(path: Path, scan_topic: str | None = None) -> RecordedLog:
    """Return the scans of a bag: a ``.bag`` of ROS 1, or the directory of one of ROS 2.

    Args:
        path: the bag.
        scan_topic: which scanner, where there are several; None for the one that scanned most.

    Raises:
        RecordingError: it cannot be read, or there is no scan in it with a pose; says what is missing.
        RobotdError: the extra ``bags`` is not installed.
    """
    require_bags()
    try:
        heard, topics = _heard(path, scan_topic)
    except RobotdError as error:
        raise type(error)(f"{path}: {error}") from error
    except Exception as error:  # the reader of others raises what it happens to meet
        why = printable(str(error)) or type(error).__name__
        raise RecordingError(f"{path}: not a bag that can be read: {why}") from error
    remarks = (
        (f"scans are those of {topics.scan}; --scan-topic takes {' or '.join(topics.others)}",) if topics.others else ()
    )
    try:
        return log_of(heard, topics.odometry, remarks)
    except RecordingError as error:
        raise RecordingError(f"{path}: {error}") from error


def _heard(path: Path, scan_topic: str | None) -> tuple[HeardBag, _Topics]:
    from rosbags.highlevel import AnyReader  # noqa: PLC0415  # an extra
    from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415  # as above

    heard = HeardBag()
    with AnyReader([path], default_typestore=get_typestore(Stores.LATEST)) as reader:
        topics = _chosen(reader, scan_topic)
        kept = {topics.scan, topics.odometry}
        connections = [one for one in reader.connections if one.msgtype in FRAMES or one.topic in kept]
        for connection, time_ns, data in reader.messages(connections):
            heard.take(connection.msgtype, reader.deserialize(data, connection.msgtype), time_ns * 1e-9)
    return heard, topics


def _chosen(reader: "AnyReader", scan_topic: str | None) -> _Topics:
    """Choose the topics: of each kind the one that said most.

    Raises:
        RecordingError: there is no scan, or not that one.
    """
    counts: dict[str, dict[str, int]] = {SCAN: {}, ODOMETRY: {}}
    for one in reader.connections:
        if one.msgtype in counts:
            counts[one.msgtype][one.topic] = counts[one.msgtype].get(one.topic, 0) + one.msgcount
    scans, odometry = counts[SCAN], counts[ODOMETRY]
    if not scans:
        kinds = ", ".join(sorted({one.msgtype for one in reader.connections})[:8]) or "nothing"
        raise RecordingError(f"there is no sensor_msgs/LaserScan in it; it has {printable(kinds)}")
    if scan_topic is not None and scan_topic not in scans:
        raise RecordingError(
            f"there is no LaserScan on {scan_topic}; there is on {printable(', '.join(sorted(scans)))}"
        )
    scan = scan_topic or _most(scans)
    return _Topics(scan, _most(odometry) if odometry else None, tuple(sorted(set(scans) - {scan})))


def _most(counts: Mapping[str, int]) -> str:
    # By name where two said as much: the same bag is read the same way each time.
    return max(sorted(counts), key=lambda topic: counts[topic])
