"""The requests that start a mission, one for each kind of mission.

What a kind is called, it is called here and nowhere else: its request on the wire (``cmd``), its missions in
``mission_progress`` (``kind``), the robot's mode meanwhile (``doing``), its start in recordings (``noted``). The words
differ, and stay, because clients and recordings know them.
"""

import enum
import math
from typing import Annotated, Any, ClassVar, get_args

import msgspec
from msgspec import Meta

from robotd.contract.answers import MissionStarted
from robotd.contract.area import Area, Bounds
from robotd.contract.arguments import Coordinate, Heading, LeaseTime, MapName, PoseArgument, Stops, TiltArgument, Tilts
from robotd.contract.request import Request
from robotd.core.pose import IDENTITY, Pose2


class Legs(enum.StrEnum):
    """How to get from one stop to the next."""

    PLANNED = "planned"
    """Round the obstacles on the map so far."""
    STRAIGHT = "straight"
    """In a straight line, as somebody knows it to be free."""


class PriorHeading(enum.StrEnum):
    """What is known of the robot's heading before it looks round."""

    ODOMETRY = "odometry"
    """What odometry says, give or take the setting ``heading_error_rad``."""
    UNKNOWN = "unknown"
    """Nothing: all headings are tried."""


Distance = Annotated[float, Meta(ge=-10.0, le=10.0)]
"""How far one ``drive`` may go: nothing plans it, so it is no longer than somebody oversees."""
Turns = Annotated[float, Meta(ge=-20.0 * math.pi, le=20.0 * math.pi)]
"""How far one ``turn`` may go: ten times round, which is enough to calibrate a scale by."""


class MissionRequest(Request[MissionStarted], frozen=True):
    """A request that starts a mission; each has a ``lease_s``, and without one the daemon's."""

    result, is_noted = MissionStarted, True
    kind: ClassVar[str]
    doing: ClassVar[str]
    noted: ClassVar[str]


class MapStart(MissionRequest, frozen=True):
    """Make a new map, stop by stop."""

    cmd, kind, doing, noted = "map_start", "map", "mapping", "MapMission"
    deadline_s = 60.0  # the map in use may have to be kept first
    name: MapName
    stops_m: Stops = ()
    """Where to stop after the start, ``(x, y)`` in the map frame. The start is always the first stop."""
    start: PoseArgument = PoseArgument.of(IDENTITY)
    """Where the robot stands now: it defines the map frame."""
    legs: Legs = Legs.PLANNED
    lease_s: LeaseTime | None = None
    tilts: Tilts = ()
    """Further tilts to look at from each stop: what is seen at each is a layer of the map."""

    @classmethod
    def of(
        cls,
        name: str,
        stops_m: tuple[tuple[float, float], ...] = (),
        start: Pose2 = IDENTITY,
        legs: Legs = Legs.PLANNED,
        tilts: tuple[TiltArgument, ...] = (),
    ) -> "MapStart":
        """Return the request of a robot that stands at ``start``."""
        return cls(name, stops_m, PoseArgument.of(start), legs, tilts=tilts)


class MapContinue(MissionRequest, frozen=True):
    """Go on with the map in use: where the robot stands, then stop by stop. It is mapping, as what began it was."""

    cmd, kind, doing, noted = "map_continue", MapStart.kind, MapStart.doing, "MapContinue"
    name: MapName
    """Of the map in use: nobody goes on with another one by mistake."""
    stops_m: Stops = ()
    """Where to stop after the place where the robot stands, which is always the first stop."""
    start: PoseArgument | None = None
    """Where the robot stands now; without it, where it is localized, and without that the mission fails."""
    legs: Legs = Legs.PLANNED
    lease_s: LeaseTime | None = None

    @classmethod
    def of(
        cls,
        name: str,
        stops_m: tuple[tuple[float, float], ...] = (),
        start: Pose2 | None = None,
        legs: Legs = Legs.PLANNED,
    ) -> "MapContinue":
        """Return the request of a robot that stands at ``start``, or that is localized."""
        return cls(name, stops_m, None if start is None else PoseArgument.of(start), legs)


class Explore(MissionRequest, frozen=True):
    """Make a new map without being told where to stop, or go on with the one in use."""

    cmd, kind, doing, noted = "explore", "explore", "exploring", "ExploreMission"
    deadline_s = 60.0  # the map in use may have to be kept first
    name: MapName
    resume: bool = False
    """Whether to go on with the map in use, which must be of that name, and on which the robot must be localized; what
    it was asked for before counts."""
    start: PoseArgument = PoseArgument.of(IDENTITY)
    """Where the robot stands now: it defines the frame of a new map."""
    within: Bounds | None = None
    """What to explore; without bounds, as before, or all that the map has room for."""
    stops_m: Stops = ()
    """Where to stop first, before it chooses for itself."""
    stops_max: Annotated[int, Meta(ge=1, le=1000)] = 100
    way_max_m: Annotated[float, Meta(gt=0.0, le=100_000.0)] | None = None
    time_max_s: Annotated[float, Meta(gt=0.0, le=1_000_000.0)] | None = None
    """Once one of these is reached, no further stop is made."""
    returns: bool = False
    """Whether to drive back to where it began, in the end."""
    lease_s: LeaseTime | None = None
    tilts: Tilts = ()
    """Of a new map, as those of :class:`MapStart`; a map that is gone on with has its own."""

    @classmethod
    def of(cls, name: str, start: Pose2 = IDENTITY, **options: Any) -> "Explore":
        """Return the request of a robot that stands at ``start``; options are the other fields."""
        return cls(name, start=PoseArgument.of(start), **options)


class Localize(MissionRequest, frozen=True):
    """Sweep at the present stop and say where it is on the map in use."""

    cmd, kind, doing, noted = "localize", "localize", "localizing", "LocalizeMission"
    heading_rad: Heading | None = None
    """The robot's heading in the map frame, if the client knows better than odometry."""
    lease_s: LeaseTime | None = None
    tie: bool = True
    """Whether odometry is tied again to the map where the robot is found; otherwise it is only said."""
    heading: PriorHeading = PriorHeading.ODOMETRY
    within: Area | None = None
    """Where on the map it is, if the client knows; no other place is then an answer."""
    adaptive: bool = False
    """Whether to read to all sides until two answers in a row agree, instead of a whole sweep."""
    smallest_error: bool = False
    """Whether to tell, too, how far the readings must be trusted so that nearly all agree."""
    layers: bool = False
    """Whether to look at the tilts of the map's layers, too: a place must then agree with each of them."""

    def __post_init__(self) -> None:
        """Refuse a heading that is known and unknown, and a look that is short and long."""
        if self.adaptive and self.layers:
            raise ValueError("layers take whole sweeps: they cannot be asked of an adaptive look")
        if self.heading is PriorHeading.UNKNOWN and self.heading_rad is not None:
            raise ValueError("heading_rad cannot be given where the heading is unknown")


class Resolve(MissionRequest, frozen=True):
    """Look round, and while several places are left, drive to where they differ and look again."""

    cmd, kind, doing, noted = "resolve", "resolve", "resolving", "Resolve"
    within: Area | None = None
    """Where on the map it is, if the client knows; no other place is then an answer."""
    lease_s: LeaseTime | None = None


class DriveTo(MissionRequest, frozen=True):
    """Drive to a place on the map in use."""

    cmd, kind, doing, noted = "drive_to", "drive", "driving", "DriveMission"
    x_m: Coordinate
    y_m: Coordinate
    legs: Legs = Legs.PLANNED
    lease_s: LeaseTime | None = None


class DriveStraight(MissionRequest, frozen=True):
    """Drive straight ahead, or back, as far as odometry says; no map is needed, and none is looked at."""

    cmd, kind, doing, noted = "drive", "move", "moving", "DriveStraight"
    distance_m: Distance
    """Negative goes back."""
    lease_s: LeaseTime | None = None


class Turn(MissionRequest, frozen=True):
    """Turn on the spot as far as odometry says, as often round as asked; no map is needed."""

    cmd, kind, doing, noted = "turn", "turn", "turning", "Turn"
    angle_rad: Turns
    """Counter-clockwise; negative goes clockwise."""
    lease_s: LeaseTime | None = None


class Look(MissionRequest, frozen=True):
    """Point the head; within its limits, which it knows itself."""

    cmd, kind, doing, noted = "look", "look", "looking", "Look"
    pan_rad: Heading
    """Counter-clockwise from the robot's heading."""
    tilt_rad: Heading
    """Up from level."""
    lease_s: LeaseTime | None = None


class Scan(MissionRequest, frozen=True):
    """Take one sweep where it stands; no map is needed, and none is changed."""

    cmd, kind, doing, noted = "scan", "scan", "scanning", "Scan"
    lease_s: LeaseTime | None = None
    base_turns: bool = True
    """Whether the base turns for the directions that the head does not reach; else they are left out."""


class Measure(MissionRequest, frozen=True):
    """Measure the range where the head points, once or some times; nothing moves."""

    cmd, kind, doing, noted = "measure", "measure", "measuring", "Measure"
    count: Annotated[int, Meta(ge=1, le=1000)] = 1
    lease_s: LeaseTime | None = None


Mission = MapStart | MapContinue | Explore | Localize | Resolve | DriveTo | DriveStraight | Turn | Look | Scan | Measure


def with_lease(mission: Mission, lease_s: float | None = None) -> Mission:
    """Return a mission that asks for this lease; as it is if None."""
    return mission if lease_s is None else msgspec.structs.replace(mission, lease_s=lease_s)


MISSIONS: tuple[type[Mission], ...] = get_args(Mission)
"""Every kind of mission there is."""
