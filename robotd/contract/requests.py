"""Every request of the wire: what is asked, declared once, checked on arrival.

Clients send these, the server takes them, the mission carries them out, the journal notes them, and a replay performs
them again. The envelope is in :mod:`robotd.contract.envelope`, the events in :mod:`robotd.contract.topics`.
``docs/api.md`` says the same for people; a test holds the two together.
"""

from typing import Annotated, Any

from msgspec import Meta

from robotd.contract.answers import (
    ConfigText,
    Done,
    HelloResult,
    MapEntryInfo,
    MapList,
    RecordingFile,
    RecordingList,
    Renewed,
)
from robotd.contract.arguments import Coordinate, MapName, Number, PoseArgument, RecordingPath
from robotd.contract.events import MapChanged, Status
from robotd.contract.map_import import MapImport
from robotd.contract.metrics import Metrics
from robotd.contract.missions import MISSIONS
from robotd.contract.request import Request
from robotd.contract.ways import Way
from robotd.core.pose import Pose2
from robotd.core.text import LONGEST, printable, printable_bytes

LONGEST_REASON = LONGEST
"""Letters of the reason for a stop that are kept."""


class Hello(Request[HelloResult], frozen=True):
    """Ask who is there and which versions it speaks."""

    cmd, result, only_looks = "hello", HelloResult, True


class GetStatus(Request[Status], frozen=True):
    """Ask for the whole robot in one look, as the topic ``status`` tells it."""

    cmd, result, only_looks = "status", Status, True


class Arm(Request[Done], frozen=True):
    """Allow motion."""

    cmd, result, is_noted = "arm", Done, True


class Disarm(Request[Done], frozen=True):
    """Stop and forbid motion: a stop, noted as one."""

    cmd, result = "disarm", Done

    @property
    def reason(self) -> str:
        """Why, as a stop says it."""
        return "disarmed by request"


class Stop(Request[Done], frozen=True):
    """Stop now; ahead of everything else, at any time."""

    cmd, result, is_noted = "stop", Done, True
    reason: Annotated[str, Meta(max_length=LONGEST_REASON)] = "stopped by a client"

    @classmethod
    def because(cls, reason: object = "stopped by a client") -> "Stop":
        """Return a stop for any reason: a text of whatever length and letters, bytes, nothing at all."""
        text = (
            printable_bytes(reason) if isinstance(reason, bytes) else printable("" if reason is None else str(reason))
        )
        # No reason is no reason to refuse: a stop is obeyed, whatever it says for itself.
        return cls(text) if text.strip() else cls()


class Clear(Request[Done], frozen=True):
    """Acknowledge latched faults; the robot stays disarmed."""

    cmd, result, is_noted = "clear", Done, True


class Renew(Request[Renewed], frozen=True):
    """Keep a mission's lease alive."""

    # No renewal is noted any more; recordings from before hold them, and what they hold must be one to repeat.
    cmd, result, only_looks, is_noted = "renew", Renewed, True, True
    mission_id: Number


class MapSave(Request[MapEntryInfo], frozen=True):
    """Store the map in use, under its own name or another."""

    # Longer than a writer waits for its turn (maps/lock.py) and the disk takes after that.
    cmd, result, deadline_s = "map_save", MapEntryInfo, 60.0
    name: MapName | None = None


class MapLoad(Request[MapEntryInfo], frozen=True):
    """Take a stored map into use, and say where the robot is on it if that is known."""

    cmd, result, deadline_s = "map_load", MapEntryInfo, 60.0
    name: MapName
    version: Number | None = None
    robot_in_map: PoseArgument | None = None

    @classmethod
    def of(cls, name: str, version: int | None = None, robot_in_map: Pose2 | None = None) -> "MapLoad":
        """Return the request of a robot that stands at ``robot_in_map``, or of one that does not know."""
        return cls(name, version, None if robot_in_map is None else PoseArgument.of(robot_in_map))


class MapDiscard(Request[Done], frozen=True):
    """Give up what nobody saved of the map in use."""

    cmd, result = "map_discard", Done


class ListMaps(Request[MapList], frozen=True):
    """List every stored version of every map; answered by a :class:`MapList`."""

    cmd, result, only_looks, deadline_s = "map_list", MapList, True, 30.0


class MapShow(Request[MapChanged], frozen=True):
    """Hand over the whole map in use, or a stored one."""

    cmd, result, only_looks, deadline_s = "map_show", MapChanged, True, 60.0
    name: MapName | None = None
    version: Number | None = None

    def __post_init__(self) -> None:
        """Refuse a version of nothing."""
        if self.name is None and self.version is not None:
            raise ValueError("a version needs a name")


class MapDelete(Request[Done], frozen=True):
    """Remove a stored version of a map, or all of them; never of the map in use."""

    cmd, result, deadline_s = "map_delete", Done, 60.0
    name: MapName
    version: Number | None = None


class MapRename(Request[Done], frozen=True):
    """Give a stored map another name, all of its versions; never the map in use."""

    cmd, result, deadline_s = "map_rename", Done, 60.0
    name: MapName
    new_name: MapName


class PlanTo(Request[Way], frozen=True):
    """Ask for the way from here to a place on the map in use; nothing moves."""

    cmd, result, only_looks, deadline_s = "plan_to", Way, True, 60.0
    x_m: Coordinate
    y_m: Coordinate


class RecordStart(Request[RecordingFile], frozen=True):
    """Start recording, into a new file of the daemon's or into this one, which lies below its ``recording.dir``."""

    cmd, result = "record_start", RecordingFile
    path: RecordingPath | None = None


class RecordStop(Request[RecordingFile], frozen=True):
    """Close the recording; RecordingError, as ``failed``, says if it is incomplete."""

    cmd, result, deadline_s = "record_stop", RecordingFile, 30.0


class ListRecordings(Request[RecordingList], frozen=True):
    """List what was recorded."""

    cmd, result, only_looks, deadline_s = "record_list", RecordingList, True, 30.0


class RecordDelete(Request[Done], frozen=True):
    """Remove a recording, which must not be under way."""

    cmd, result, deadline_s = "record_delete", Done, 30.0
    path: RecordingPath


class GetMetrics(Request[Metrics], frozen=True):
    """Ask for what was counted since the start."""

    cmd, result, only_looks = "metrics", Metrics, True


class GetConfig(Request[ConfigText], frozen=True):
    """Ask for the effective configuration."""

    cmd, result, only_looks = "config", ConfigText, True


REQUESTS: dict[str, type[Request[Any]]] = {
    kind.cmd: kind
    for kind in (
        *(Hello, GetStatus, GetConfig, GetMetrics),
        *(Arm, Disarm, Stop, Clear),
        *(*MISSIONS, Renew),
        *(MapSave, MapLoad, MapDiscard, ListMaps, MapShow, MapDelete, MapRename, MapImport, PlanTo),
        *(RecordStart, RecordStop, ListRecordings, RecordDelete),
    )
}
"""Every request there is, by its name on the wire."""
