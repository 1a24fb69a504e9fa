"""A recording's events as a bag: a file of ROS 1, or the directory of one of ROS 2 with MCAP inside."""

import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robotd.core.errors import RecordingError
from robotd.interop.bags_extra import require_bags
from robotd.interop.ros_messages import FRAMES, MAP, TYPES, RosMessages

_FRAMES_TEXT = "geometry_msgs/TransformStamped[] transforms"


def is_ros1(path: Path) -> bool:
    """Return whether a bag of that name is one of ROS 1."""
    return path.suffix == ".bag"


def write_bag(path: Path, events: Iterable[Any], wall_offset_ns: int) -> int:
    """Write events that a robot told as a bag, which appears whole or not at all; return how many messages it has.

    Args:
        path: ending with ``.bag`` a bag of ROS 1, else the directory of one of ROS 2.
        events: as they were told.
        wall_offset_ns: from monotonic to Unix time.

    Raises:
        RecordingError: it cannot be written, or there is nothing to write.
        RobotdError: the extra ``bags`` is not installed.
    """
    require_bags()
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # Beside its place, so that what is whole gets there by a rename.
        with tempfile.TemporaryDirectory(prefix=f".{path.name}.", dir=path.parent) as beside:
            made = Path(beside) / path.name
            with (_ros1 if is_ros1(path) else _ros2)(made) as bag:
                count = _write(bag, events, wall_offset_ns)
            if not count:
                raise RecordingError(f"{path}: there is nothing to write that a bag has a message for")
            made.replace(path)
    except OSError as error:
        raise RecordingError(f"cannot write {path}: {error.strerror or error}") from error
    return count


@dataclass(frozen=True, slots=True)
class _Bag:
    """An open bag, of either ROS."""

    types: Mapping[str, type]
    channel: Callable[[str, str], Any]
    """Makes the channel of a topic and its type."""
    serialized: Callable[[Any, str], bytes | memoryview]
    write: Callable[[Any, int, bytes | memoryview], None]


def _write(bag: _Bag, events: Iterable[Any], wall_offset_ns: int) -> int:
    told, channels, count = RosMessages(wall_offset_ns, bag.types), dict[str, Any](), 0
    for event in events:
        for message in told.messages(event):
            topic, kind = message.topic, TYPES[message.topic]
            # Only for what comes: other programs list the topics of a bag, and would show what was never told.
            if topic not in channels:
                channels[topic] = bag.channel(topic, kind)
            bag.write(channels[topic], told.unix_ns(event.time_ns), bag.serialized(message.content, kind))
            count += 1
    return count


@contextmanager
def _ros1(path: Path) -> Iterator[_Bag]:
    from rosbags.rosbag1 import Writer  # noqa: PLC0415  # an extra
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: PLC0415  # as above

    store = get_typestore(Stores.ROS1_NOETIC)
    store.register(get_types_from_msg(_FRAMES_TEXT, TYPES[FRAMES]))  # which the core of ROS 1 has not
    with Writer(path) as writer:

        def channel(topic: str, kind: str) -> Any:
            return writer.add_connection(topic, kind, typestore=store, latching=int(topic == MAP))

        yield _Bag(store.types, channel, store.serialize_ros1, writer.write)


@contextmanager
def _ros2(path: Path) -> Iterator[_Bag]:
    from rosbags.rosbag2 import StoragePlugin, Writer  # noqa: PLC0415  # an extra
    from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415  # as above

    store = get_typestore(Stores.ROS2_HUMBLE)
    with Writer(path, version=8, storage_plugin=StoragePlugin.MCAP) as writer:

        def channel(topic: str, kind: str) -> Any:
            return writer.add_connection(topic, kind, typestore=store, offered_qos_profiles=_profiles(topic))

        yield _Bag(store.types, channel, store.serialize_cdr, writer.write)


def _profiles(topic: str) -> tuple[Any, ...]:
    """Return how a topic was offered: who comes late gets the map all the same."""
    from rosbags import interfaces as ros  # noqa: PLC0415  # an extra

    if topic != MAP:
        return ()
    never = ros.QosTime(0, 0)
    return (
        ros.Qos(
            history=ros.QosHistory.KEEP_LAST,
            depth=1,
            reliability=ros.QosReliability.RELIABLE,
            durability=ros.QosDurability.TRANSIENT_LOCAL,
            deadline=never,
            lifespan=never,
            liveliness=ros.QosLiveliness.SYSTEM_DEFAULT,
            liveliness_lease_duration=never,
            avoid_ros_namespace_conventions=False,
        ),
    )
