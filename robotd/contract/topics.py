r"""What is published: events of the mission and lines of the log, as single frames ``topic\0msgpack``.

The payload is one flat map: ``v``, ``session``, ``seq`` (counts the messages of its topic since the daemon started),
``event`` (which type of event), and the event's own fields, whose names carry their units. A subscription is a prefix:
``pose\0`` is one topic, the empty string is all.
"""

import enum
from dataclasses import dataclass
from typing import Any

import msgpack
import msgspec

from robotd.contract.estimate import PoseEstimate
from robotd.contract.events import (
    Event,
    LoopClosed,
    LoopHeld,
    MapChanged,
    MissionProgress,
    RangeMeasured,
    RankMap,
    Reconciled,
    Status,
    StopPlaced,
    SweepBegun,
    SweepDone,
    SweepProgress,
    SweepReadings,
)
from robotd.contract.explored import ExploringEnded, StopChosen
from robotd.contract.plain import VERSION, from_plain, to_plain
from robotd.contract.ways import MissionPlan
from robotd.core.errors import RemoteProtocolError
from robotd.core.pose import Odometry

# Ends the prefix, so that a topic may be named as another one begins.
_END_OF_TOPIC = b"\0"


class Topic(enum.StrEnum):
    """Where an event is published."""

    POSE = "pose"
    ODOMETRY = "odometry"
    SWEEP = "sweep"
    MAP = "map"
    MISSION = "mission"
    RANK = "rank"
    STATUS = "status"
    LOG = "log"

    @property
    def prefix(self) -> bytes:
        """What to subscribe to for this topic and no other."""
        return self.encode() + _END_OF_TOPIC


@dataclass(frozen=True, slots=True)
class LogEntry:
    """A line of the daemon's log."""

    time_ns: int
    level: str
    """``INFO``, ``WARNING``, ``ERROR`` or ``CRITICAL``."""
    logger: str
    message: str


Published = Event | LogEntry

EVENTS: dict[type[Published], tuple[Topic, str]] = {
    PoseEstimate: (Topic.POSE, "pose_estimate"),
    Odometry: (Topic.ODOMETRY, "odometry"),
    SweepBegun: (Topic.SWEEP, "sweep_begun"),
    SweepReadings: (Topic.SWEEP, "sweep_readings"),
    SweepProgress: (Topic.SWEEP, "sweep_progress"),
    SweepDone: (Topic.SWEEP, "sweep_done"),
    RangeMeasured: (Topic.SWEEP, "range_measured"),
    MapChanged: (Topic.MAP, "map_changed"),
    StopPlaced: (Topic.MAP, "stop_placed"),
    LoopHeld: (Topic.MAP, "loop_held"),
    LoopClosed: (Topic.MAP, "loop_closed"),
    Reconciled: (Topic.MAP, "reconciled"),
    StopChosen: (Topic.MISSION, "stop_chosen"),
    ExploringEnded: (Topic.MISSION, "exploring_ended"),
    MissionProgress: (Topic.MISSION, "mission_progress"),
    MissionPlan: (Topic.MISSION, "plan"),
    RankMap: (Topic.RANK, "rank_map"),
    Status: (Topic.STATUS, "status"),
    LogEntry: (Topic.LOG, "log"),
}
"""Every type of event, with its topic and its name on the wire."""

_KINDS = {name: kind for kind, (_, name) in EVENTS.items()}


class _Envelope(msgspec.Struct, frozen=True):
    v: int
    session: str = ""
    seq: int = -1
    event: str = ""


@dataclass(frozen=True, slots=True)
class Frame:
    """A published message as it came, of which the envelope alone was read."""

    topic: str
    session: str
    """Changes with each start of the daemon: then ``seq`` begins again."""
    seq: int
    """Counts the messages of its topic; a number left out is a message missed."""
    event: str
    """The name of its event."""
    data: bytes
    """All of it, topic and envelope included."""

    @classmethod
    def of(cls, data: bytes) -> "Frame":
        """Return the message of these bytes; RemoteProtocolError if it is none, or of another version."""
        topic, _, packed = data.partition(_END_OF_TOPIC)
        try:
            # The envelope alone: who hands messages on need not take a map apart.
            envelope = msgspec.msgpack.decode(packed, type=_Envelope)
            name = topic.decode()
        except ValueError as error:
            raise RemoteProtocolError(f"not a message: {error!r}") from error
        if envelope.v != VERSION:
            raise RemoteProtocolError(f"the server speaks version {envelope.v}, this client {VERSION}")
        if envelope.seq < 0:
            raise RemoteProtocolError("not a message: it has no number")
        return cls(name, envelope.session, envelope.seq, envelope.event, data)

    @property
    def published(self) -> Published | None:
        """What it says; None for a type of event that this version does not know. RemoteProtocolError if it lies."""
        try:
            fields = msgpack.unpackb(memoryview(self.data)[len(self.topic.encode()) + 1 :])
        except ValueError as error:
            raise RemoteProtocolError(f"not a message: {error!r}") from error
        return from_wire(fields)


def to_wire(event: Published) -> tuple[Topic, dict[str, Any]]:
    """Return the topic of an event and its fields."""
    topic, name = EVENTS[type(event)]
    return topic, {"event": name, **to_plain(event)}


def from_wire(fields: dict[str, Any]) -> Published | None:
    """Return the event of a payload, or None if this version does not know its type.

    Raises:
        RemoteProtocolError: it is not what its name promises.
    """
    kind = _KINDS.get(fields.get("event", ""))
    # None and no error: a daemon of a later version tells more, and clients of today go on.
    if kind is None:
        return None
    try:
        return from_plain(kind, fields)
    except ValueError as error:
        raise RemoteProtocolError(f"{fields['event']}: {error}") from error


def encode_frame(topic: Topic, session: str, seq: int, fields: dict[str, Any]) -> bytes:
    """Return the one frame of a message."""
    packed: bytes = msgpack.packb({"v": VERSION, "session": session, "seq": seq, **fields})
    return topic.prefix + packed
