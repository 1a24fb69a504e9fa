"""What the mission tells the world, as it happens."""

import enum
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.contract.device_status import DeviceStatus
from robotd.contract.estimate import PoseEstimate
from robotd.contract.explored import ExploringEnded, StopChosen
from robotd.contract.ways import MissionPlan
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Odometry, Pose2
from robotd.core.reading import ReadingStatus, Sweep

# Not the grid's own constant: clients load this file, and nothing of the engine with it.
_UNKNOWN = 128
"""The value of a cell of which nothing is known."""


@dataclass(frozen=True, slots=True)
class Commander:
    """Who started the mission under way, and keeps it alive."""

    client: str
    """As it calls itself; as the daemon sees it, if it does not."""
    kind: str
    """What the request calls its missions, as in :class:`MissionProgress`."""
    since_ns: int
    lease_s: float


@dataclass(frozen=True, slots=True)
class Status:
    """The whole robot in one look; published on every change and once a second."""

    time_ns: int
    mode: str
    """What the robot is allowed to do: one of ``MODE_WORDS``; of a mission, what it does."""
    reason: str
    """Why it is in this mode, for people."""
    devices: tuple[DeviceStatus, ...]
    battery_v: float | None
    """Of the base; None if there is none to talk to, or it has not told yet."""
    bumpers_rad: tuple[float, ...]
    """Directions of the pressed bumpers, robot frame."""
    mission_id: int | None
    """Of the mission under way; None between missions, so a client sees that its own is over."""
    map_id: str | None
    map_name: str | None
    recording: str | None
    """File being recorded to."""
    held: str | None = None
    """Why the mission under way is held; None if it is not. It goes on by itself."""
    map_unsaved: bool = False
    """Whether the map in use has changes that nobody saved."""
    map_kept_version: int | None = None
    """The version as which they are kept nevertheless; None as long as they are in memory alone."""
    since_ns: int | None = None
    """When it came into this mode; None from a daemon that does not tell."""
    started_ns: int | None = None
    """When the daemon started."""
    commander: Commander | None = None
    """Whose mission is under way; None between missions."""


@dataclass(frozen=True, slots=True)
class SweepBegun:
    """A sweep begins; the base stands, and may turn before it ends."""

    time_ns: int
    number: int
    total: int
    """Readings of the whole sweep."""
    in_odom: Pose2
    """Where odometry placed the robot: the frame of all its readings, however the base turns for them."""
    in_map: Pose2 | None
    """The same on the map in use; None while nothing ties odometry to it."""


@dataclass(frozen=True, slots=True)
class SweepReadings:
    """Readings of a sweep under way, in columns; :mod:`robotd.contract.sweep_columns` makes and reads them."""

    time_ns: int
    """When the last of them was made."""
    number: int
    first: int
    """Which reading of the sweep the first of them is, from 0."""
    bearing_f32le: bytes
    """Directions [rad] in the robot frame of the sweep's begin, four bytes each, little-endian."""
    range_f32le: bytes
    """Ranges [m]; of a miss, how far nothing was met; NaN of every other status."""
    status_u8: bytes
    """What became of each, a byte each: its place among the words of ``ReadingStatus``."""
    origin_x_f32le: bytes
    """Where the beams start [m], robot frame; empty where all of them start at the robot's centre."""
    origin_y_f32le: bytes


@dataclass(frozen=True, slots=True)
class SweepProgress:
    """How far a sweep has come."""

    time_ns: int
    number: int
    taken: int
    """Readings made so far, failed ones included."""
    total: int
    """Readings of the whole sweep."""
    hits: int
    misses: int
    rejected: int
    """Neither: too near, weak, saturated, silent and the like."""


@dataclass(frozen=True, slots=True)
class SweepDone:
    """A whole sweep: the record of one stop."""

    time_ns: int
    sweep: Sweep
    in_map: Pose2 | None = None
    """Where the robot stood on the map in use when it began; None while nothing ties odometry to it."""


@dataclass(frozen=True, slots=True)
class RangeMeasured:
    """One measurement of the mission ``measure``, along the beam, wherever that points."""

    time_ns: int
    """When the light was sent."""
    number: int
    """Which of them, from 0."""
    total: int
    status: ReadingStatus
    range_m: float | None
    """Along the beam, the bias applied; of a miss, how far nothing was met, if the device says; None for every other
    status."""
    strength: int | None
    """As the device counts it, which differs from model to model; None if it tells none."""


class MissionPhase(enum.StrEnum):
    """What a mission is at."""

    STARTED = "started"
    DRIVING = "driving"
    SWEEPING = "sweeping"
    COMPUTING = "computing"
    DONE = "done"
    STOPPED = "stopped"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class MissionProgress:
    """A step of a mission; the last one has phase ``done``, ``stopped`` or ``failed``."""

    time_ns: int
    mission_id: int
    kind: str
    """What the request calls its missions: ``map``, ``localize``, ``drive`` and so on."""
    phase: MissionPhase
    stop: int
    """Which stop, from 0; when it is done, how many."""
    stops: int
    message: str = ""

    @property
    def is_last(self) -> bool:
        """Whether the mission ended with this."""
        return self.phase in {MissionPhase.DONE, MissionPhase.STOPPED, MissionPhase.FAILED}


@dataclass(frozen=True, slots=True)
class MapChanged:
    """Cells that changed in the map in use, or all of them."""

    time_ns: int
    map_id: str | None
    """None if no map is in use: then it is one cell of which nothing is known."""
    generation: int
    """Counts the changes of this map: a reader that missed one asks for the whole."""
    spec: GridSpec
    whole: bool
    cells: NDArray[np.intp]
    """Changed cells as flat indices ``row * cols + col``, ``intp[n]``; empty when ``whole``."""
    values: NDArray[np.uint8]
    """Their values ``uint8[n]``, or the whole grid ``uint8[rows, cols]``."""
    stops: int | None = None
    """How many stops the map is made of by now; None if that is not known."""
    packed: bytes | memoryview | None = None
    """The whole grid as :mod:`robotd.core.grid_bytes` packs it, where it was packed already; then ``values`` is empty.
    """

    @classmethod
    def none(cls, time_ns: int) -> "MapChanged":
        """Return what is told where no map is in use."""
        spec, nothing = GridSpec(1.0, 0.0, 0.0, (1, 1)), np.empty(0, np.intp)
        return cls(time_ns, None, 0, spec, True, nothing, np.full(spec.shape, _UNKNOWN, np.uint8))


@dataclass(frozen=True, slots=True)
class RankMap:
    """How many readings each place explains at its best heading: a picture, made as long as somebody looks."""

    time_ns: int
    map_id: str
    generation: int
    """The change of that map which it is on."""
    number: int
    """Of the sweep."""
    readings: int
    """Counted so far."""
    headings: int
    """Tried for each place; fewer than the estimate tries on a large map."""
    reduce: int
    """Cells of the map along the side of one of these, of which the greatest counts."""
    resolution_m: float
    """Side of one of these cells."""
    origin_x_m: float
    origin_y_m: float
    rows: int
    cols: int
    levels_zlib: bytes
    """A byte a cell, row by row, packed by zlib: 255 where all readings are explained, 0 where none is."""


@dataclass(frozen=True, slots=True)
class StopPlaced:
    """What came of placing a stop on the map so far."""

    time_ns: int
    map_id: str
    stop: int
    """From 0."""
    outcome: str
    """``placed``, ``wide`` (farther off than odometry errs), ``weak`` (explained in part), ``new_ground`` (the map says
    next to nothing: odometry's word stands) or ``contradicts`` (not laid into the map)."""
    pose: Pose2
    """Where the robot is believed to be, map frame."""
    deviation_m: float
    """Standard deviation of the place, along the worse axis of the map, relative to the stops before."""
    deviation_rad: float
    """Of the heading."""
    explained: float
    """Share of the readings that the map explains there, 0 to 1."""
    contradicted: float
    """Share against which it speaks; of the rest it says nothing."""


@dataclass(frozen=True, slots=True)
class LoopHeld:
    """A stop was found where it should not be by much: that is held until a second stop agrees."""

    time_ns: int
    map_id: str
    stop: int
    old_stop: int
    """The stop of long ago near to which it was found."""
    moved_m: float
    moved_rad: float


@dataclass(frozen=True, slots=True)
class LoopClosed:
    """A stop was found on stops of long ago, and that is believed."""

    time_ns: int
    map_id: str
    stop: int
    old_stop: int
    moved_m: float
    moved_rad: float


@dataclass(frozen=True, slots=True)
class Reconciled:
    """All stops were brought together and the map was made again; odometry is tied to it again in the same step."""

    time_ns: int
    map_id: str
    stops_moved: int
    largest_move_m: float
    edges_refused: int
    """Loops, or steps of odometry, that contradict all others and have no say."""


Event = (
    Odometry
    | PoseEstimate
    | Status
    | SweepBegun
    | SweepReadings
    | SweepProgress
    | SweepDone
    | RangeMeasured
    | RankMap
    | MissionProgress
    | MissionPlan
    | MapChanged
    | StopPlaced
    | LoopHeld
    | LoopClosed
    | Reconciled
    | StopChosen
    | ExploringEnded
)
