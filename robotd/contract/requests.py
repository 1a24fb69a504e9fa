"""The commands that clients send and what they are answered: one frozen struct each, checked on arrival.

The envelope is in :mod:`robotd.contract.envelope`, the events in :mod:`robotd.contract.topics`. ``docs/api.md`` says
the same for people; a test holds the two together.
"""

import enum
import math
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Generic, TypeVar

import msgspec
from msgspec import Meta

from robotd.contract.area import Area
from robotd.contract.events import MissionProgress, Status
from robotd.contract.map_wire import MapPayload
from robotd.contract.missions import DriveMission, Legs, LocalizeMission, MapMission, Mission, PriorHeading
from robotd.core.pose import IDENTITY, Pose2
from robotd.core.text import LONGEST, printable, printable_bytes

LONGEST_REASON = LONGEST
"""Letters of the reason for a stop that are kept."""
VERSION = 1
"""Major version of the wire: carried by every message, refused when it is not ours."""

R = TypeVar("R")

Coordinate = Annotated[float, Meta(ge=-100_000.0, le=100_000.0)]
Heading = Annotated[float, Meta(ge=-2.0 * math.pi, le=2.0 * math.pi)]
LeaseTime = Annotated[float, Meta(ge=0.1, le=10.0)]
MapName = Annotated[str, Meta(pattern=r"\A[A-Za-z0-9][A-Za-z0-9._-]{0,63}\Z")]
Number = Annotated[int, Meta(ge=0, le=2**53)]
Stops = Annotated[tuple[tuple[Coordinate, Coordinate], ...], Meta(max_length=1000)]


class ErrorCode(enum.StrEnum):
    """Why a request was not carried out."""

    MALFORMED = "malformed"
    TOO_LARGE = "too_large"
    UNSUPPORTED_VERSION = "unsupported_version"
    UNKNOWN_COMMAND = "unknown_command"
    BAD_ARGUMENT = "bad_argument"
    REFUSED = "refused"
    NOT_FOUND = "not_found"
    BUSY = "busy"
    INTERNAL = "internal"


@dataclass(frozen=True, slots=True)
class MapEntryInfo:
    """A stored version of a map."""

    name: str
    version: int
    digest: str
    """What the map is known by in ``map_id``."""
    created_unix_ns: int
    rows: int
    cols: int
    resolution_m: float
    damage: str | None = None
    """Why this version cannot be read; its other numbers are then zero."""
    unsaved: bool = False
    """Whether nobody saved it: it was kept so that it is not lost."""
    stops: int | None = None
    """How many stops it was made of; None if that was not stored with it."""


class PoseArgument(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A pose in the map frame, as an argument."""

    x_m: Coordinate
    y_m: Coordinate
    heading_rad: Heading = 0.0

    @property
    def pose(self) -> Pose2:
        """The same, as the rest of the house writes it."""
        return Pose2(self.x_m, self.y_m, self.heading_rad)

    @classmethod
    def of(cls, pose: Pose2) -> "PoseArgument":
        """Return a pose as an argument."""
        return cls(pose.x_m, pose.y_m, pose.heading_rad)


class AreaArgument(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A disk of the map, as an argument."""

    x_m: Coordinate
    y_m: Coordinate
    radius_m: Annotated[float, Meta(gt=0.0, le=100_000.0)]

    @property
    def area(self) -> Area:
        """The same, as the rest of the house writes it."""
        return Area(self.x_m, self.y_m, self.radius_m)

    @classmethod
    def of(cls, area: Area) -> "AreaArgument":
        """Return a disk as an argument."""
        return cls(area.x_m, area.y_m, area.radius_m)


class Done(msgspec.Struct, frozen=True):
    """It was done, and there is nothing more to say."""


class HelloResult(msgspec.Struct, frozen=True):
    """Who answers."""

    versions: tuple[int, ...]
    """Wire versions that it speaks."""
    robotd: str
    """Version of the program."""
    session: str
    """Changes with every start of the daemon."""
    lease_s: float
    """How long a mission may go without ``renew``, unless it is started with another lease."""
    time_ns: int
    """Its monotonic time; the time of this host, the same in every process [ns]."""
    wall_offset_ns: int
    """What to add to a monotonic time to get Unix time [ns], as of now."""


class MissionStarted(msgspec.Struct, frozen=True):
    """A mission is under way, and its lease is running."""

    mission_id: int
    lease_s: float


class Renewed(msgspec.Struct, frozen=True):
    """The lease was renewed, or the mission is over."""

    mission: MissionProgress | None
    """The mission's latest progress; ``done``, ``stopped`` and ``failed`` need no renewing."""


class MapList(msgspec.Struct, frozen=True):
    """The stored maps."""

    maps: tuple[MapEntryInfo, ...]


class RecordingFile(msgspec.Struct, frozen=True):
    """Where a recording is; None when there was none to stop."""

    path: str | None


class ConfigText(msgspec.Struct, frozen=True):
    """The effective configuration, as TOML."""

    text: str


class Command(msgspec.Struct, Generic[R], frozen=True, forbid_unknown_fields=True):
    """A request for a result of type ``R``."""

    cmd: ClassVar[str]
    result: ClassVar[Any]
    only_looks: ClassVar[bool] = False
    """Changes nothing, so a repeated request may be carried out again."""
    deadline_s: ClassVar[float] = 3.0
    """How long a client waits for the answer, repeats included."""


class Hello(Command[HelloResult], frozen=True):
    """Ask who is there and which versions it speaks."""

    cmd, result, only_looks = "hello", HelloResult, True


class GetStatus(Command[Status], frozen=True):
    """Ask for the status."""

    cmd, result, only_looks = "status", Status, True


class Arm(Command[Done], frozen=True):
    """Allow motion."""

    cmd, result, deadline_s = "arm", Done, 10.0


class Disarm(Command[Done], frozen=True):
    """Stop and forbid motion."""

    cmd, result, deadline_s = "disarm", Done, 10.0


class Stop(Command[Done], frozen=True):
    """Stop now; ahead of everything else, at any time."""

    cmd, result = "stop", Done
    reason: Annotated[str, Meta(max_length=LONGEST_REASON)] = "stopped by a client"

    @classmethod
    def because(cls, reason: object) -> "Stop":
        """Return a stop for any reason: a text of whatever length and letters, bytes, nothing at all."""
        text = (
            printable_bytes(reason) if isinstance(reason, bytes) else printable("" if reason is None else str(reason))
        )
        return cls(text) if text.strip() else cls()


class Clear(Command[Done], frozen=True):
    """Acknowledge latched faults; the robot stays disarmed."""

    cmd, result, deadline_s = "clear", Done, 10.0


class MapStart(Command[MissionStarted], frozen=True):
    """Start making a new map, stop by stop."""

    cmd, result, deadline_s = "map_start", MissionStarted, 60.0  # the map in use may have to be kept first
    name: MapName
    stops_m: Stops = ()
    start: PoseArgument = PoseArgument.of(IDENTITY)
    legs: Legs = Legs.PLANNED
    lease_s: LeaseTime | None = None

    @property
    def mission(self) -> Mission:
        """What it asks the robot to do."""
        return MapMission(self.name, self.stops_m, self.start.pose, self.legs)


class Localize(Command[MissionStarted], frozen=True):
    """Start a sweep at the present stop and say where it is."""

    cmd, result = "localize", MissionStarted
    heading_rad: Heading | None = None
    lease_s: LeaseTime | None = None
    tie: bool = True
    heading: PriorHeading = PriorHeading.ODOMETRY
    within: AreaArgument | None = None

    def __post_init__(self) -> None:
        """Refuse a heading that is known and unknown."""
        self.mission  # noqa: B018  # making it is the check

    @property
    def mission(self) -> Mission:
        """What it asks the robot to do."""
        return LocalizeMission(self.heading_rad, self.tie, self.heading, self.within.area if self.within else None)


class DriveTo(Command[MissionStarted], frozen=True):
    """Start driving to a place on the map in use."""

    cmd, result = "drive_to", MissionStarted
    x_m: Coordinate
    y_m: Coordinate
    legs: Legs = Legs.PLANNED
    lease_s: LeaseTime | None = None

    @property
    def mission(self) -> Mission:
        """What it asks the robot to do."""
        return DriveMission(self.x_m, self.y_m, self.legs)


class Renew(Command[Renewed], frozen=True):
    """Keep a mission's lease alive."""

    cmd, result, only_looks, deadline_s = "renew", Renewed, True, 2.0
    mission_id: Number


class MapSave(Command[MapEntryInfo], frozen=True):
    """Store the map in use, under its own name or another."""

    cmd, result, deadline_s = "map_save", MapEntryInfo, 60.0
    name: MapName | None = None


class MapLoad(Command[MapEntryInfo], frozen=True):
    """Take a stored map into use, and say where the robot is on it if that is known."""

    cmd, result, deadline_s = "map_load", MapEntryInfo, 60.0
    name: MapName
    version: Number | None = None
    robot_in_map: PoseArgument | None = None


class MapDiscard(Command[Done], frozen=True):
    """Give up what nobody saved of the map in use."""

    cmd, result = "map_discard", Done


class ListMaps(Command[MapList], frozen=True):
    """List the stored maps."""

    cmd, result, only_looks, deadline_s = "map_list", MapList, True, 30.0


class MapShow(Command[MapPayload], frozen=True):
    """Hand over the whole map in use, or a stored one."""

    cmd, result, only_looks, deadline_s = "map_show", MapPayload, True, 60.0
    name: MapName | None = None
    version: Number | None = None


class RecordStart(Command[RecordingFile], frozen=True):
    """Start recording, into a new file of the daemon's or into this one, which lies below its ``recording.dir``."""

    cmd, result, deadline_s = "record_start", RecordingFile, 10.0
    path: Annotated[str, Meta(min_length=1, max_length=1024, pattern=r"\A[^\x00]*\Z")] | None = None


class RecordStop(Command[RecordingFile], frozen=True):
    """Close the recording."""

    cmd, result, deadline_s = "record_stop", RecordingFile, 30.0


class GetConfig(Command[ConfigText], frozen=True):
    """Ask for the effective configuration."""

    cmd, result, only_looks = "config", ConfigText, True


StartCommand = MapStart | Localize | DriveTo

COMMANDS: dict[str, type[Command[Any]]] = {
    kind.cmd: kind
    for kind in (
        *(Hello, GetStatus, GetConfig),
        *(Arm, Disarm, Stop, Clear),
        *(MapStart, Localize, DriveTo, Renew),
        *(MapSave, MapLoad, MapDiscard, ListMaps, MapShow),
        *(RecordStart, RecordStop),
    )
}
"""Every command there is, by its name on the wire."""


def start_command(mission: Mission, lease_s: float | None) -> StartCommand:
    """Return the command that starts a mission."""
    match mission:
        case MapMission(name, stops_m, start, legs):
            return MapStart(name, stops_m, PoseArgument.of(start), legs, lease_s)
        case LocalizeMission(heading_rad, tie, heading, within):
            return Localize(heading_rad, lease_s, tie, heading, AreaArgument.of(within) if within else None)
        case DriveMission(x_m, y_m, legs):
            return DriveTo(x_m, y_m, legs, lease_s)
