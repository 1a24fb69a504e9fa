"""What requests are answered, beside events: one frozen struct each; and why they are not carried out."""

import enum
from dataclasses import dataclass

import msgspec

from robotd.contract.events import MissionProgress


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
    """Too much is under way; nothing was done, and a repeat may find room."""
    INTERNAL = "internal"
    """A mistake of ours; the log has its traceback."""


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
    """Every stored version of every map, the oldest first, damaged ones among them."""

    maps: tuple[MapEntryInfo, ...]


class RecordingFile(msgspec.Struct, frozen=True):
    """Where a recording is; None when there was none to stop."""

    path: str | None


class RecordingInfo(msgspec.Struct, frozen=True):
    """A file that was recorded to."""

    path: str
    """From ``recording.dir`` on."""
    size_bytes: int
    changed_unix_ns: int
    """When it was written to last."""
    is_open: bool
    """Whether it is being recorded to now."""


class RecordingList(msgspec.Struct, frozen=True):
    """What was recorded, the newest first."""

    recordings: tuple[RecordingInfo, ...]
    left_out: int
    """Older ones beyond those."""


class ConfigText(msgspec.Struct, frozen=True):
    """The effective configuration, as TOML."""

    text: str
