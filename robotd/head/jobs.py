"""What is asked, declared once; :mod:`robotd.head.job_table` says what carries it out.

Who asks knows maps and stops by number alone, and chooses the numbers. A map in a number is a row of *generations*: an
insertion makes the next of one and leaves that one as it is, so a mission that is stopped while a sweep is laid in goes
on with the map that it had.
"""

import msgspec

from robotd.contract.area import Area
from robotd.contract.estimate import PoseEstimate
from robotd.contract.events import LoopClosed, LoopHeld, Reconciled, StopPlaced
from robotd.contract.explored import CandidateStop, LeftOpen
from robotd.contract.ways import Point, Way
from robotd.core.grid_spec import GridSpec
from robotd.core.motion_error import Travel
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, Slant, Sweep, Tilt
from robotd.core.rectangle import Rectangle
from robotd.exploring.settings import Pace
from robotd.exploring.tried import Tried
from robotd.grid.settings import GridSettings
from robotd.head.job import Done, Job, Made
from robotd.maps.packed_content import PackedContent
from robotd.maps.version_files import STOPS
from robotd.recording.entries import ResultEntry
from robotd.sensing.rivals import Rival, SafeWay


class MapRef(msgspec.Struct, frozen=True):
    """A map as it was after that number of changes."""

    number: int
    generation: int = 0


class HeldMap(msgspec.Struct, frozen=True):
    """What is told of a map that came to be held."""

    spec: GridSpec
    digest: str
    packed: memoryview
    """Its cells, as :mod:`robotd.core.grid_bytes` packs them."""
    stops: int | None
    """How many stops it was made of; None if that is not known."""
    settings: GridSettings
    """How further readings change it."""
    tilts: tuple[Tilt, ...] = ()
    """Of its layers."""


class BeginMap(Job[HeldMap], frozen=True):
    """Begin a map on which nothing is known."""

    name, answer, is_noted = "begin map", HeldMap, True
    number: int
    spec: GridSpec
    settings: GridSettings

    @property
    def makes(self) -> Made:
        """A map, or a stop, of its number."""
        return Made(self.number, 0)


class TakeMap(Job[HeldMap], frozen=True):
    """Hold a map by its packed cells, as the journal notes them."""

    name, answer = "take map", HeldMap
    number: int
    spec: GridSpec
    packed: memoryview
    settings: GridSettings
    stops: bytes | None = None
    """``stops.bin``, packed, if there is one; it was checked before."""

    @property
    def makes(self) -> Made:
        """A map, or a stop, of its number."""
        return Made(self.number, 0)


class ReadMap(Job[HeldMap], frozen=True):
    """Hold a map from the store, everything checked; MapError if it contradicts itself."""

    name, answer = "read map", HeldMap
    number: int
    content: PackedContent
    """Of its exports nothing is read."""

    @property
    def makes(self) -> Made:
        """A map, or a stop, of its number."""
        return Made(self.number, 0)

    def again(self, answer: HeldMap) -> TakeMap:
        """Return the map as it is held: packed it is a tenth, and all is checked already."""
        return TakeMap(self.number, answer.spec, answer.packed, answer.settings, self.content.files.get(STOPS))


class ShowMap(Job[HeldMap], frozen=True):
    """Pack the cells of a map."""

    name, answer = "show map", HeldMap
    map: MapRef


class FilesMade(msgspec.Struct, frozen=True):
    """What the store writes of a map."""

    content: PackedContent
    remark: str | None
    """Why it goes without its stops, for the log; None if it does not."""


class MakeFiles(Job[FilesMade], frozen=True):
    """Make of a map what the store writes, and check that it can be read again."""

    name, answer = "make files", FilesMade
    map: MapRef


class Inserted(msgspec.Struct, frozen=True):
    """What an insertion changed."""

    cells: bytes
    """Flat indices ``row * cols + col`` of the cells that changed, ascending, eight bytes each, little-endian."""
    values: bytes
    """Their values, a byte each."""
    digest: str
    """Of the map now."""
    stops: int | None


class Insert(Job[Inserted], frozen=True):
    """Make the next generation of a map: a sweep laid in."""

    name, answer, is_noted = "insert", Inserted, True
    map: MapRef
    sweep: Sweep
    map_from_robot: Pose2
    """Where the sweep began."""

    @property
    def makes(self) -> Made:
        """The next generation, after the job that made the first and one insertion for each since."""
        return Made(self.map.number, 1 + self.map.generation)


class StopLaid(Inserted, frozen=True):
    """What came of placing a stop, and what that changed."""

    placed: StopPlaced
    held: tuple[LoopHeld, ...]
    closed: tuple[LoopClosed, ...]
    reconciled: Reconciled | None
    map_from_robot: Pose2
    """Where the stop is in the end."""

    @property
    def decided(self) -> tuple[StopPlaced | LoopHeld | LoopClosed | Reconciled, ...]:
        """What was decided, in order."""
        return (self.placed, *self.held, *self.closed, *(() if self.reconciled is None else (self.reconciled,)))


class PlaceStop(Job[StopLaid], frozen=True):
    """Make the next generation of a map: a sweep placed on what was mapped so far, and laid in where it was taken."""

    name, answer, is_noted = "place stop", StopLaid, True
    map: MapRef
    map_id: str
    """What events call the map."""
    sweep: Sweep
    travel: Travel
    """Since the stop before."""
    map_from_robot: Pose2
    """Where the stop is, if it is the first or ``found_again``; of no account to others."""
    time_ns: int
    """When, as events tell it."""
    found_again: bool = False
    """Whether the robot was found there by other means than its wheels, on a map that is gone on with."""

    @property
    def makes(self) -> Made:
        """The next generation, after the job that made the first and one insertion for each since."""
        return Made(self.map.number, 1 + self.map.generation)


class Glanced(msgspec.Struct, frozen=True):
    """Where a few readings were taken."""

    map_from_robot: Pose2
    is_found: bool
    """Whether the map had a word in it; else it is odometry's, less what it errs by every time."""


class Glance(Job[Glanced], frozen=True):
    """Say where a few readings were taken between two stops of a map in the making, which stays as it is."""

    name, answer, is_noted = "glance", Glanced, True
    map: MapRef
    readings: tuple[RangeReading, ...]
    """Measured ones."""
    since: Pose2
    """Where the robot was when that was known last."""
    travel: Travel
    """Since then."""


class Prepare(Job[Done], frozen=True):
    """Make a map ready, and begin a stop on it: a robot stands somewhere on it, and nothing was measured yet."""

    name, answer, is_noted = "prepare", Done, True
    number: int
    """Of the stop."""
    map: MapRef
    map_id: str
    """What estimates call the map."""
    headings_rad: tuple[float, ...]
    """To try, map frame, ascending."""
    within: Area | None
    """Where the robot is; None is anywhere."""
    contrast_min: float = 0.0
    """What the best place must have over any other, if that is more than the settings say."""
    tells_smallest_error: bool = False
    """Whether estimates of a whole sweep tell it."""
    layers: bool = False
    """Whether what will be seen at the tilts of its layers has a word in it, too."""

    @property
    def makes(self) -> Made:
        """A map, or a stop, of its number."""
        return Made(self.number, 0)


class TakeReadings(Job[Done], frozen=True):
    """Take readings of a stop, and say nothing of them."""

    name, answer = "take readings", Done
    stop: int
    readings: tuple[RangeReading, ...]
    """Measured ones."""
    slants: tuple[Slant, ...] = ()
    """What was seen at the tilts of the layers."""


class Narrowed(msgspec.Struct, frozen=True):
    """What the readings of a stop say so far, and its entry in the journal."""

    estimate: PoseEstimate
    digest: str | None
    encoded: bytes | None
    """Both None if it is no result."""

    @property
    def entry(self) -> ResultEntry | None:
        """Its entry, ready to be noted; what is in it was encoded where it was made, and is not decoded again."""
        if self.digest is None:
            return None
        return ResultEntry(self.estimate.time_ns, "estimate", {}, self.digest, self.encoded)


class Narrow(Job[Narrowed], frozen=True):
    """Take more readings of a stop, and estimate."""

    name, answer, is_noted = "narrow", Narrowed, True
    stop: int
    readings: tuple[RangeReading, ...]
    """Measured ones."""
    time_ns: int
    """When the robot was there."""
    final: bool
    """Whether the sweep is whole."""
    slants: tuple[Slant, ...] = ()
    """What was seen at the tilts of the layers."""

    @property
    def makes(self) -> Made:
        """A stop of which more is known."""
        return Made(self.stop, None)

    def again(self, answer: Narrowed) -> TakeReadings:
        """Return the readings alone: what they say was told."""
        return TakeReadings(self.stop, self.readings, self.slants)


class Ranks(msgspec.Struct, frozen=True):
    """How many readings each place explains; see :class:`robotd.contract.events.RankMap`."""

    spec: GridSpec
    block: int
    readings: int
    headings: int
    levels_zlib: bytes


class RanksShown(msgspec.Struct, frozen=True):
    """A picture, if there is one."""

    ranks: Ranks | None
    """None if the stop is not held any more, or its estimator has none to show."""


class ShowRanks(Job[RanksShown], frozen=True):
    """Picture how many of the readings so far each place explains."""

    name, answer = "show ranks", RanksShown
    stop: int


class Plan(Job[Way], frozen=True):
    """Plan a way on a map, to be driven."""

    name, answer, is_noted = "plan", Way, True
    map: MapRef
    start: Pose2
    goal_m: Point
    met_m: tuple[Point, ...] = ()
    """Obstacles that the robot met, whatever the map says there."""


class PreviewWay(Job[Way], frozen=True):
    """Plan a way on a map, to be looked at."""

    name, answer = "preview way", Way
    map: MapRef
    start: Pose2
    goal_m: Point
    met_m: tuple[Point, ...] = ()


class Chosen(msgspec.Struct, frozen=True):
    """Where to stop next, or why there is nowhere."""

    goal_m: Point | None
    ending: str | None
    """Why there is nowhere; None unless ``goal_m`` is None."""
    candidates: tuple[CandidateStop, ...]
    tour_m: tuple[Point, ...]
    seen_m2: float
    left: tuple[LeftOpen, ...]


class Choose(Job[Chosen], frozen=True):
    """Choose where to stop next on a map that is explored."""

    name, answer, is_noted = "choose", Chosen, True
    map: MapRef
    start: Pose2
    """Where the robot stands."""
    tried: Tried
    within: Rectangle | None
    cut_off_m: float
    """Farther than this the rangefinder is not asked."""
    pace: Pace


class ChooseBearings(Job[tuple[int, ...]], frozen=True):
    """Choose the bearings that tell rivals apart, by their numbers, best first."""

    name, answer, is_noted = "choose bearings", tuple[int, ...], True
    map: MapRef
    rivals: tuple[tuple[Pose2, float], ...]
    """Where the robot may be, and how much each is believed."""
    bearings_rad: tuple[float, ...]
    """To choose from, robot frame."""
    taken_rad: tuple[float, ...]
    """Chosen so before: none is chosen near to them."""
    count: int
    cutoff_m: float


class SafeWayChosen(msgspec.Struct, frozen=True):
    """The way to drive, in the robot frame; None where none is free under each rival."""

    way: SafeWay | None
    """None if none is free wherever the robot may be."""


class ChooseSafeWay(Job[SafeWayChosen], frozen=True):
    """Choose the way at whose end rivals are told apart, and that is free under each of them."""

    name, answer, is_noted = "choose safe way", SafeWayChosen, True
    map: MapRef
    rivals: tuple[Rival, ...]
    cutoff_m: float
    speed_mps: float


class Forget(Job[Done], frozen=True):
    """Hold a map, or a stop, no longer."""

    name, answer = "forget", Done
    number: int
