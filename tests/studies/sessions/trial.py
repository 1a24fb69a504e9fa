"""A whole daemon in virtual time: a hundred stops, then furniture is moved, then fifty more on another day."""

import enum
import random
import tempfile
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import MissionPhase
from robotd.contract.missions import DriveTo, Localize, MapContinue, MapStart, PriorHeading
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm, Clear, MapLoad, MapSave
from robotd.core.clock import VirtualClockLoop
from robotd.core.rectangle import Rectangle
from robotd.maps.store import MapStore
from robotd.sim.buildings.world import Start, World
from robotd.sim.physics.walls import Point
from robotd.sim.robot import SimulatedRobot
from robotd.slam.changed_places import Change, ChangedPlace, changed_places
from tests.studies.sessions.moving import Moved, moved
from tests.support.living import Living, living

_RIGHT_M = 0.3
_MAPPED_EACH = 5
"""On the other day, one of this number of stops is laid into the map."""
_GAVE_UP = 6
"""A robot that does not know where it is at this number of last stops will not find out; as many as `resolve` tries."""
_NAME = "home"


class Found(enum.StrEnum):
    """What a stop came to."""

    RIGHT = "right"
    WRONG = "wrong and sure"
    UNSURE = "ambiguous"
    LOST = "lost"
    NOT_REACHED = "not reached"


@dataclass(frozen=True, slots=True)
class Trial:
    """One robot."""

    first: tuple[Found, ...]
    """What its stops came to before anything was moved."""
    later: tuple[Found, ...]
    """And afterwards."""
    moved: int
    listed: int
    """Of what was moved, how much is listed: gone where it stood, or come where it stands."""
    listed_elsewhere: int
    """Changes that are listed where nothing was moved."""

    @property
    def longest_unsure(self) -> int:
        """How many stops in a row it did not know where it is, at most."""
        longest = run = 0
        for found in (*self.first, *self.later):
            run = run + 1 if found in {Found.UNSURE, Found.LOST} else 0
            longest = max(longest, run)
        return longest

    @property
    def is_lost_for_good(self) -> bool:
        """Whether it did not know where it is in the end, as often as it looked."""
        last = self.later[-_GAVE_UP:]
        return len(last) == _GAVE_UP and all(found in {Found.UNSURE, Found.LOST} for found in last)

    @property
    def counts(self) -> Counter[Found]:
        """How often it came to what."""
        return Counter((*self.first, *self.later))


def tried(world: World, share: float, stops: tuple[int, int], seed: int) -> Trial:
    """Return what became of a robot that makes some stops, and some more once a share of the furniture was moved."""
    loop = VirtualClockLoop()
    try:
        with tempfile.TemporaryDirectory(prefix="robotd-sessions-") as directory:
            return loop.run_until_complete(_tried(Path(directory), world, share, stops, seed))
    finally:
        loop.close()


async def _tried(directory: Path, world: World, share: float, stops: tuple[int, int], seed: int) -> Trial:
    robot = SimulatedRobot(world, seed)
    draw = random.Random(f"{world.name}/{seed}/sessions")
    async with living(directory, robot) as it:
        await it.done(MapStart.of(_NAME, robot.stops_m, robot.start))
        first = [await _stopped(it, draw.choice(_places(world))) for _ in range(stops[0] - 1 - len(robot.stops_m))]
        await it.daemon.control.perform(MapSave())
    after, changes = moved(world, share, seed)
    stood = robot.truth
    again = SimulatedRobot(replace(after, start=Start(stood.x_m, stood.y_m, 0.0)), seed + 1)
    async with living(directory, again) as it:
        await it.daemon.control.perform(MapLoad.of(_NAME, None, None))
        later = [await _located(it, PriorHeading.UNKNOWN)]
        for number in range(1, stops[1]):
            later.append(await _stopped(it, draw.choice(_places(world))))
            if number % _MAPPED_EACH == 0 and later[-1] is Found.RIGHT:
                await it.do(MapContinue.of(_NAME))
        await it.daemon.control.perform(MapSave())
    listed = _listed(MapStore(directory / "maps"))
    return Trial(tuple(first), tuple(later), len(changes), *_held_against(listed, changes))


def _places(world: World) -> tuple[Point, ...]:
    return (*world.stops_m, *world.probes_m)


async def _stopped(it: Living, place_m: Point) -> Found:
    """Drive to a place, and ask where it is; one that does not know asks where it stands."""
    mode = it.daemon.control.status.mode
    if mode is Mode.FAULT:
        await it.daemon.control.perform(Clear())
    if it.daemon.control.status.mode is not Mode.IDLE:
        await it.daemon.control.perform(Arm())
    _, driven = await it.do(DriveTo(*place_m))
    found = await _located(it, PriorHeading.ODOMETRY if driven.phase is MissionPhase.DONE else PriorHeading.UNKNOWN)
    return Found.NOT_REACHED if found is Found.RIGHT and driven.phase is not MissionPhase.DONE else found


async def _located(it: Living, heading: PriorHeading) -> Found:
    if it.daemon.control.status.mode is Mode.FAULT:
        await it.daemon.control.perform(Clear())
    if it.daemon.control.status.mode is not Mode.IDLE:
        await it.daemon.control.perform(Arm())
    said, _ = await it.do(Localize(heading=heading))
    finals = [event for event in said if isinstance(event, PoseEstimate) and event.final and event.readings]
    if not finals:
        return Found.UNSURE
    if finals[-1].best is not None:
        return Found.RIGHT if finals[-1].best.distance_m(it.robot.truth) <= _RIGHT_M else Found.WRONG
    return Found.LOST if finals[-1].state is PoseState.LOST else Found.UNSURE


def _listed(store: MapStore) -> tuple[ChangedPlace, ...]:
    before, since = (store.load(_NAME, version).stops for version in (1, 2))
    assert before is not None
    assert since is not None
    spec = store.load(_NAME, 2).grid.spec
    return changed_places(since.stops[: len(before.stops)], since.stops[len(before.stops) :], spec)


def _held_against(listed: tuple[ChangedPlace, ...], changes: tuple[Moved, ...]) -> tuple[int, int]:
    """Return how many of the pieces that were moved are listed, and how many changes are of none of them."""
    of_pieces = [
        [
            place
            for place in listed
            if _touches(place.box, (piece.before if place.change is Change.GONE else piece.after).points_m)
        ]
        for piece in changes
    ]
    meant = {id(place) for places in of_pieces for place in places}
    return sum(map(bool, of_pieces)), sum(id(place) not in meant for place in listed)


def _touches(box: Rectangle, corners_m: tuple[Point, ...], near_m: float = 0.15) -> bool:
    xs_m, ys_m = [x_m for x_m, _ in corners_m], [y_m for _, y_m in corners_m]
    return (
        box.west_m <= max(xs_m) + near_m
        and box.east_m >= min(xs_m) - near_m
        and box.south_m <= max(ys_m) + near_m
        and box.north_m >= min(ys_m) - near_m
    )
