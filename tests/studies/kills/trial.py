"""A robot explores, and its daemon is killed at each write of its maps; then another one goes on with what is left.

Killed is who never gets to the next call: the disk is copied before each, and each copy is a daemon that died there.
What is written, is written while the robot goes on: the disk takes some seconds.
"""

import asyncio
import math
import random
import shutil
import tempfile
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray

from robotd.app.compose import Daemon
from robotd.config import Config
from robotd.contract.area import Bounds
from robotd.contract.events import MissionProgress, SweepDone
from robotd.contract.explored import ExploringEnded
from robotd.contract.missions import Explore, Localize, PriorHeading
from robotd.contract.requests import ListMaps, MapLoad
from robotd.core.clock import run_virtual
from robotd.core.map_stop import MapStop
from robotd.core.pose import Pose2
from robotd.grid.tables import NO_INFORMATION
from robotd.maps import atomic
from robotd.maps.archive import Archive
from robotd.maps.packed_content import PackedContent
from robotd.maps.store import MapStore
from robotd.mission.map_entries import errand_of
from robotd.sim.buildings.world import Start, World
from robotd.sim.robot import SimulatedRobot
from tests.studies.kills.watched_disk import WatchedOs
from tests.support.living import LEASE_S, Living, living

_WRITE_S = 2.0
"""How long the disk takes before a map is written: the robot drives meanwhile."""
_ROUND_M = 0.5
_SEEN_FREE = 3
"""A cell at most so was seen so more than once (``grid.lower_alpha``): a single wrong range does not count."""


@dataclass(frozen=True, slots=True)
class Ended:
    """A map when exploring it has ended."""

    ending: str
    """Why it ended, or what the mission failed of."""
    cells: NDArray[np.uint8] = field(compare=False)
    worst_m: float
    """By how much a stop that was made in this life is off on the map, at most."""


@dataclass(frozen=True, slots=True)
class Cut:
    """A daemon that was killed."""

    change: int
    """Before this change of the disk."""
    whole_stops: int
    """How many stops were on the map in memory by then."""
    stops: int
    """How many of them are on the disk."""
    is_prefix: bool
    """Whether these are the first ones as they were, bit for bit."""
    state: tuple[str, str] = ("", "")
    """What who comes next finds: the map, and how far exploring it had come."""


@dataclass(frozen=True, slots=True)
class Resumed:
    """What came of going on after a kill."""

    cut: Cut
    ended: Ended
    unseen_share: float
    """Share of the ground seen free without the kill that is not seen."""


@dataclass(slots=True)
class _Watch:
    """What is known of each moment at which the daemon may be killed."""

    robot: SimulatedRobot
    digests: list[str] = field(default_factory=list)
    """Of the map after each stop."""
    stops_at: list[int] = field(default_factory=list)
    """How many stops it had before each change of the disk."""
    poses: list[tuple[int, Pose2]] = field(default_factory=list)
    """Where the robot was, and how many changes there were by then, whenever something was told."""


class SlowDisk:
    """Computes where it is asked; but before a map is saved the robot goes on for a while."""

    async def run(self, name: str, function: object, *args: object) -> object:
        if name == "save map":
            await asyncio.sleep(_WRITE_S)
        assert callable(function)
        return function(*args)


@dataclass(frozen=True, slots=True)
class Killed:
    """A robot that explored, and all moments at which its daemon may have been killed."""

    world: World
    seed: int
    config: Config
    without: Ended
    """What becomes of it if it is not."""
    cuts: tuple[Cut, ...]
    copies: Path
    poses: tuple[tuple[int, Pose2], ...]

    def states(self) -> tuple[Cut, ...]:
        """Return one cut for each state that who comes next may find."""
        by_state = {cut.state: cut for cut in self.cuts if cut.stops}
        return tuple(by_state.values())

    def resumed(self, cut: Cut) -> Resumed:
        """Return what comes of going on after a kill, from somewhere where the robot was while that was on the disk."""
        last = len(self.cuts) - 1
        while_there = [pose for change, pose in self.poses if self.cuts[min(change, last)].state == cut.state]
        pose = random.Random(f"{self.seed}/{cut.change}").choice(while_there)
        with tempfile.TemporaryDirectory(prefix="robotd-kills-") as directory:
            shutil.copytree(self.copies / str(cut.change), Path(directory) / "maps")
            ended = run_virtual(_gone_on(self.world, pose, self.seed + 1000 + cut.change, Path(directory), self.config))
        was_free = self.without.cells <= _SEEN_FREE
        unseen = was_free & (ended.cells == NO_INFORMATION)
        return Resumed(cut, ended, float(unseen.sum() / was_free.sum()))


def killed(world: World, seed: int, directory: Path, config: Config) -> Killed:
    """Let a robot explore to its end, and return all moments at which its daemon may have been killed."""
    return run_virtual(_killed(world, seed, directory, config))


async def _killed(world: World, seed: int, directory: Path, config: Config) -> Killed:
    robot = SimulatedRobot(world, seed)
    watch = _Watch(robot)
    disk = WatchedOs(directory / "maps", directory / "copies", lambda: watch.stops_at.append(len(watch.digests)))
    with patch.object(atomic, "os", disk):
        async with living(directory, robot, config) as it, _keeping(it.daemon):
            mission = Explore.of(world.name, robot.start, within=_bounds(world))
            ended = await _explored(it, mission, watch, disk)
            await asyncio.sleep(2 * _WRITE_S)
            watch.poses.append((disk.changes, robot.truth))
        disk.copy()
    cuts = tuple(_cut(disk, change, watch) for change in range(disk.changes))
    return Killed(world, seed, config, ended, cuts, directory / "copies", tuple(watch.poses))


def _cut(disk: WatchedOs, change: int, watch: _Watch) -> Cut:
    entries = Archive(disk.at(change), PackedContent.read).list()
    assert all(entry.damage is None for entry in entries), entries
    whole = watch.stops_at[change]
    if not entries:
        return Cut(change, whole, 0, is_prefix=True)
    newest = max(entries, key=lambda entry: entry.version)
    # Every byte is looked at: who is killed leaves no half of a version.
    Archive(disk.at(change), PackedContent.read).load(newest.name, newest.version)
    assert newest.stops is not None
    is_prefix = newest.digest == watch.digests[newest.stops - 1]
    return Cut(change, whole, newest.stops, is_prefix, (newest.digest, str(errand_of(newest))))


def _bounds(world: World) -> Bounds:
    """Return a rectangle round a world: who goes on with it is not told again."""
    ends_m = np.concatenate((world.walls.starts_m, world.walls.starts_m + world.walls.along_m))
    (west_m, south_m), (east_m, north_m) = (
        (ends_m.min(axis=0) - _ROUND_M).tolist(),
        (ends_m.max(axis=0) + _ROUND_M).tolist(),
    )
    return Bounds(west_m, south_m, east_m, north_m)


async def _gone_on(world: World, pose: Pose2, seed: int, directory: Path, config: Config) -> Ended:
    """Do what ``robotctl explore NAME --resume`` does after a restart."""
    start = Start(pose.x_m, pose.y_m, math.degrees(pose.heading_rad))
    robot = SimulatedRobot(replace(world, start=start), seed)
    async with living(directory, robot, config) as it, _keeping(it.daemon):
        kept = (await it.daemon.control.perform(ListMaps())).maps
        await it.daemon.control.perform(MapLoad(world.name, max(entry.version for entry in kept)))
        _, end = await it.do(Localize(heading=PriorHeading.UNKNOWN))
        if it.daemon.supervisor.whereabouts.believed is None:
            return Ended(end.message, _newest(it.daemon)[1], math.inf)
        return await _explored(it, Explore.of(world.name, resume=True))


async def _explored(it: Living, mission: Explore, watch: _Watch | None = None, disk: WatchedOs | None = None) -> Ended:
    place = it.daemon.supervisor.whereabouts.map_in_use
    stored = 0 if place is None else place.stops or 0
    mission_id = it.daemon.control.start(mission, LEASE_S)
    truths, ending = dict[int, Pose2](), ""
    async for event in it.events:
        if watch is not None and disk is not None:
            _note(it.daemon, watch, disk)
        match event:
            case SweepDone():
                truths[event.sweep.number] = it.robot.truth
            case ExploringEnded():
                ending = event.ending
            case MissionProgress() if event.mission_id == mission_id and event.is_last:
                ending = ending or event.message
                break
    await it.daemon.control.keeping.keep()
    stops, cells = _newest(it.daemon)
    worst_m = max((stop.map_from_robot.distance_m(truths[stop.number]) for stop in stops[stored:]), default=0.0)
    return Ended(ending, cells, worst_m)


def _newest(daemon: Daemon) -> tuple[tuple[MapStop, ...], NDArray[np.uint8]]:
    """Return stops and cells of the newest map on the disk."""
    store = MapStore(daemon.control.keeping._archive.root)
    newest = max(store.list(), key=lambda entry: entry.version)
    stored = store.load(newest.name, newest.version)
    assert stored.stops is not None
    return stored.stops.stops, stored.grid.cells


def _note(daemon: Daemon, watch: _Watch, disk: WatchedOs) -> None:
    place = daemon.supervisor.whereabouts.map_in_use
    if place is None or not place.stops:
        return
    if place.stops > len(watch.digests):
        watch.digests.append(place.digest)
    watch.poses.append((disk.changes, watch.robot.truth))


@asynccontextmanager
async def _keeping(daemon: Daemon) -> AsyncIterator[None]:
    """Let the daemon keep maps by itself, as the program does, on a slow disk."""
    with patch.object(daemon.control.keeping, "_disk", SlowDisk()):
        task = asyncio.create_task(daemon.control.keeping.run())
        try:
            yield
        finally:
            task.cancel()
            await asyncio.wait((task,))
