"""Everything that can be asked of the robot, in one place; the server and a replay both ask here.

Each request that has an effect on the robot is noted in the journal before what it leads to (only a stop is on the
wires first), so a replay can ask the same again. What is refused at once has none and is not noted: a client that is
refused ten thousand times a minute must not fill the memory that recordings begin with. What fails halfway, as arming
may, is noted.
"""

import logging
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec

from robotd.contract.events import Event, MapChanged, Status
from robotd.contract.missions import MapMission, Mission
from robotd.core.broadcast import Broadcast
from robotd.core.clock import now_ns, wall_offset_ns
from robotd.core.errors import MapError, MissionError, RecordingError
from robotd.core.pose import Pose2
from robotd.grid.occupancy import OccupancyGrid
from robotd.maps.entry import MapEntry, StoredMap
from robotd.maps.store import MapStore
from robotd.mission.compute import Compute
from robotd.mission.keeping import Keeping
from robotd.mission.modes import Occasion
from robotd.mission.noted import (
    NotedMap,
    NotedRenewal,
    NotedStart,
    NotedStop,
    grid_of,
    mission_of,
    noted_as,
    noted_grid,
)
from robotd.mission.supervisor import Supervisor
from robotd.mission.whereabouts.map_in_use import MapInUse
from robotd.mission.whereabouts.tie import Tie
from robotd.recording.encoding import encoded
from robotd.recording.entries import CommandEntry
from robotd.recording.place import make_place
from robotd.recording.preroll import PrerollJournal

log = logging.getLogger(__name__)


class Control:
    """The robot as its clients see it."""

    def __init__(
        self,
        supervisor: Supervisor,
        *,
        store: MapStore,
        journal: PrerollJournal,
        compute: Compute,
        recordings_dir: Path,
        config_text: str,
    ) -> None:
        self._supervisor = supervisor
        self._store = store
        self._journal = journal
        self._compute = compute
        self._recordings_dir = recordings_dir
        self.config_text = config_text
        self.keeping = Keeping(supervisor, store, compute)

    @property
    def events(self) -> Broadcast[Event]:
        """Everything that happens."""
        return self._supervisor.news.events

    @property
    def status(self) -> Status:
        """The whole robot in one look."""
        return self._supervisor.status

    async def arm(self) -> None:
        """Allow motion; see :meth:`Supervisor.arm`."""
        self._supervisor.require_armable()
        self._journal.command(now_ns(), "arm", {})
        await self._supervisor.arm()

    def halt(self, reason: str) -> None:
        """Stop everything and disarm, at once; valid at any time."""
        self._supervisor.robot.stop_now()
        self._journal.command(now_ns(), "stop", {"reason": reason})
        self._supervisor.halt(Occasion.STOP, reason)

    async def stopped(self) -> None:
        """Wait until the mission that was stopped has ended."""
        await self._supervisor.stopped()

    async def stop(self, reason: str) -> None:
        """Stop everything and disarm, and wait until what was under way has ended."""
        self.halt(reason)
        await self.stopped()

    async def clear(self) -> None:
        """Acknowledge latched faults; see :meth:`Supervisor.clear`."""
        self._supervisor.require_clearable()
        self._journal.command(now_ns(), "clear", {})
        await self._supervisor.clear()

    async def begin(self, mission: Mission, lease_s: float) -> int:
        """Start a mission as :meth:`start` does; a new map waits until the one in use is kept.

        Raises:
            MissionError: as :meth:`start`; or it was stopped while it waited; or see :meth:`Keeping.make_way`.
        """
        if isinstance(mission, MapMission):
            halts = self._supervisor.halts
            await self.keeping.make_way()
            if self._supervisor.halts != halts:
                raise MissionError("stopped while the map in use was being kept")
        return self.start(mission, lease_s)

    def start(self, mission: Mission, lease_s: float) -> int:
        """Start a mission under a lease; see :meth:`Supervisor.start`."""
        begun_ns = now_ns()
        mission_id = self._supervisor.start(mission, lease_s)  # which takes its first step later: nothing is noted yet
        arguments = {"kind": type(mission).__name__, "mission": msgspec.to_builtins(mission), "lease_s": lease_s}
        self._journal.command(begun_ns, "start", arguments)
        return mission_id

    def renew(self, mission_id: int) -> None:
        """Keep a mission's lease alive; see :meth:`Supervisor.renew`."""
        renewed_ns = now_ns()
        self._supervisor.renew(mission_id)
        self._journal.command(renewed_ns, "renew", {"mission_id": mission_id})

    def whole_map(self) -> MapChanged:
        """Return every cell of the map in use.

        Raises:
            MapError: there is none.
        """
        return self._place().whole(now_ns())

    async def stored_map(self, name: str, version: int | None) -> MapChanged:
        """Return every cell of a stored map; MapError if it is missing or damaged."""
        stored = await self._compute.run("read map", self._store.load, name, version)
        return _place_of(stored).whole(now_ns())

    async def list_maps(self) -> tuple[MapEntry, ...]:
        """Return what is in the store."""
        return await self._compute.run("list maps", self._store.list)

    async def save_map(self, name: str | None) -> MapEntry:
        """Save the map in use as a new version, under its own or another name.

        Raises:
            MapError: there is none, or it cannot be written; what was there before is untouched.
        """
        place = self._place()
        metadata: dict[str, Any] = {"generation": place.generation, "map_id": place.map_id}
        created_ns = now_ns() + wall_offset_ns()
        wanted, save = name or place.name, self._store.save
        entry = await self._compute.run("save map", save, wanted, place.grid, metadata, created_ns, place.stops)
        place.saved(metadata["generation"])
        log.info("map %s was saved as version %d of %s (%s)", place.name, entry.version, entry.name, entry.digest)
        self._changed()
        return entry

    def discard_map(self) -> None:
        """Give up what nobody saved of the map in use, which stays in use.

        Raises:
            MapError: there is none.
            MissionError: a mission is under way.
        """
        place = self._place()
        self._supervisor.require_replaceable_map()
        log.info("what was not saved of map %s (%d changes) was given up", place.name, place.generation)
        place.given_up()
        self._changed()

    async def load_map(self, name: str, version: int | None, robot_in_map: Pose2 | None) -> MapEntry:
        """Make a stored map the one in use; ``robot_in_map`` says where the robot stands on it, if known.

        Raises:
            MapError: it is missing or damaged; the map in use stays.
            MissionError: a mission is under way, or the map in use would be lost, see :meth:`Keeping.make_way`.
        """
        self._supervisor.require_replaceable_map()
        stored = await self._compute.run("read map", self._store.load, name, version)
        entry, place = stored.entry, _place_of(stored)
        pose = None if robot_in_map is None else msgspec.to_builtins(robot_in_map)
        arguments = {"map_id": entry.digest, "name": name, "robot_in_map": pose}
        command = await self._compute.run("pack map", _use_map, arguments, stored.grid)
        await self.keeping.make_way()  # last of all, so that nothing changes the map meanwhile
        self._use(command, place)
        return entry

    def _use(self, command: CommandEntry, place: MapInUse) -> None:
        arguments = command.arguments
        tie: Tie | None = None
        here = self._supervisor.robot.drive.odometry.latest
        if arguments["robot_in_map"] is not None:
            if here is None:
                raise MissionError("there is no odometry yet to tie to the map")
            tie = Tie.between(msgspec.convert(arguments["robot_in_map"], Pose2), here.in_odom)
        self._supervisor.require_replaceable_map()
        self._journal.asked(replace(command, time_ns=now_ns()))
        self._supervisor.use(place, tie)

    async def start_recording(self, path: str | None) -> str:
        """Record from the daemon's start on, to a file below the directory of recordings; return it.

        Raises:
            RecordingError: the file is to lie elsewhere, or it cannot be done now.
        """
        name = f"{now_ns() + wall_offset_ns()}.mcap" if path is None else path
        file = await self._compute.run("make directory", make_place, self._recordings_dir, name, self._store.root)
        self._journal.start(file)
        log.info("recording to %s", file)
        self._changed()
        return str(file)

    async def stop_recording(self) -> str | None:
        """End the recording and return its file, None if there is none; RecordingError if it is incomplete."""
        path = self._journal.path
        if path is None:
            return None
        finish = self._journal.stop()
        self._changed()
        await self._compute.run("end recording", finish)
        log.info("the recording %s is complete", path)
        return str(path)

    async def repeat(self, name: str, arguments: dict[str, Any]) -> None:
        """Carry out a request as the journal noted it.

        Raises:
            RecordingError: it is none, or its arguments do not fit; others as the request itself.
        """
        match name:
            case "arm":
                await self.arm()
            case "clear":
                await self.clear()
            case "stop":
                await self.stop(noted_as(NotedStop, name, arguments).reason)
            case "renew":
                self.renew(noted_as(NotedRenewal, name, arguments).mission_id)
            case "start":
                start = noted_as(NotedStart, name, arguments)
                self.start(mission_of(start), start.lease_s)
            case "use_map":
                noted = noted_as(NotedMap, name, arguments)
                place = MapInUse(noted.map_id, noted.name, grid_of(noted))
                self._use(CommandEntry(now_ns(), name, arguments), place)
            case _:
                raise RecordingError(f"unknown request {name!r}")

    def _place(self) -> MapInUse:
        place = self._supervisor.whereabouts.map_in_use
        if place is None:
            raise MapError("no map is in use: make one, or load one")
        return place

    def _changed(self) -> None:
        self._supervisor.publish_status()


def _place_of(stored: StoredMap) -> MapInUse:
    """Return a stored map as one to use, made of what it was made of; nothing ties odometry to it yet."""
    entry = stored.entry
    place = MapInUse(entry.digest, entry.name, stored.grid, entry.digest, stored.stops)
    if entry.is_unsaved:
        place.found_unsaved(entry.version)
    return place


def _use_map(arguments: dict[str, Any], grid: OccupancyGrid) -> CommandEntry:
    """Return the journal's entry of taking a map into use, encoded: for a large one that takes a second."""
    return encoded(CommandEntry(0, "use_map", arguments | {"grid": noted_grid(grid)}))
