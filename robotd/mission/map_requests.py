"""The requests about maps: save, load, give up, list and show them.

None but taking a map into use has an effect on the robot, and that is noted with the map itself: a replay has no store.
"""

import logging
from collections.abc import Awaitable, Callable
from dataclasses import replace
from functools import partial
from typing import Any

import msgspec

from robotd.contract.answers import Done, MapEntryInfo, MapList
from robotd.contract.events import MapChanged
from robotd.contract.request import Request
from robotd.contract.requests import ListMaps, MapDiscard, MapLoad, MapSave, MapShow
from robotd.core.clock import now_ns, wall_offset_ns
from robotd.core.errors import MapError, MissionError
from robotd.core.pose import Pose2
from robotd.grid.occupancy import OccupancyGrid
from robotd.maps.entry import MapEntry, StoredMap
from robotd.maps.store import MapStore
from robotd.mission.compute import Compute
from robotd.mission.map_entries import entry_info
from robotd.mission.noted import NotedMap, grid_of, noted_grid
from robotd.mission.supervisor import Supervisor
from robotd.mission.whereabouts.keeping import Keeping
from robotd.mission.whereabouts.map_in_use import MapInUse
from robotd.mission.whereabouts.tie import Tie
from robotd.recording.encoding import encoded
from robotd.recording.entries import CommandEntry
from robotd.recording.preroll import PrerollJournal

log = logging.getLogger(__name__)


class MapRequests:
    """Carries them out."""

    def __init__(
        self, supervisor: Supervisor, store: MapStore, journal: PrerollJournal, compute: Compute, keeping: Keeping
    ) -> None:
        self._supervisor = supervisor
        self._store = store
        self._journal = journal
        self._compute = compute
        self._keeping = keeping
        self.rows: dict[type[Request[Any]], Callable[[Any], Awaitable[object]]] = {
            MapSave: self._save,
            MapLoad: self._load,
            MapDiscard: self._discard,
            ListMaps: self._list,
            MapShow: self._show,
        }

    async def _show(self, request: MapShow) -> MapChanged:
        """Return every cell of the map in use, or of a stored one; MapError if it is missing or damaged."""
        if request.name is None:
            return self._place().whole(now_ns())
        stored = await self._compute.run("read map", self._store.load, request.name, request.version)
        return _place_of(stored).whole(now_ns())

    async def _list(self, _: ListMaps) -> MapList:
        entries = await self._compute.run("list maps", self._store.list)
        return MapList(tuple(map(entry_info, entries)))

    async def _save(self, request: MapSave) -> MapEntryInfo:
        """Save the map in use as a new version, under its own or another name.

        Raises:
            MapError: there is none.
            MissionError: it cannot be written; what was there before is untouched.
        """
        place = self._place()
        try:
            async with self._keeping.turn:
                entry = await self._saved(place, request.name or place.name)
        except MapError as error:
            raise MissionError(str(error)) from error  # there is a map, but no room for it
        log.info("map %s was saved as version %d of %s (%s)", place.name, entry.version, entry.name, entry.digest)
        self._supervisor.publish_status()
        return entry_info(entry)

    async def _saved(self, place: MapInUse, name: str) -> MapEntry:
        # As of now: the map may grow while the disk writes, and what comes later is not saved by this.
        generation = place.generation
        metadata: dict[str, Any] = {"generation": generation, "map_id": place.map_id}
        created_ns = now_ns() + wall_offset_ns()
        save = partial(self._store.save, in_place_of=place.kept_beside)
        entry = await self._compute.run("save map", save, name, place.grid, metadata, created_ns, place.stops)
        place.saved(generation)
        return entry

    async def _discard(self, _: MapDiscard) -> Done:
        """Give up what nobody saved of the map in use, which stays in use.

        Raises:
            MapError: there is none.
            MissionError: a mission is under way.
        """
        place = self._place()
        self._supervisor.require_replaceable_map()
        log.info("what was not saved of map %s (%d changes) was given up", place.name, place.generation)
        place.given_up()
        self._supervisor.publish_status()
        return Done()

    async def _load(self, request: MapLoad) -> MapEntryInfo:
        """Make a stored map the one in use.

        Raises:
            MapError: it is missing or damaged; the map in use stays.
            MissionError: a mission is under way, or the map in use would be lost, see :meth:`Keeping.make_way`.
        """
        self._supervisor.require_replaceable_map()
        stored = await self._compute.run("read map", self._store.load, request.name, request.version)
        # Refused before the disk was read; _use asks again, for a mission may have begun by now.
        entry, place = stored.entry, _place_of(stored)
        pose = None if request.robot_in_map is None else msgspec.to_builtins(request.robot_in_map)
        arguments = {"map_id": entry.digest, "name": request.name, "robot_in_map": pose}
        command = await self._compute.run("pack map", use_map, arguments, stored.grid)
        await self._keeping.make_way()  # last of all, so that nothing changes the map meanwhile
        self._use(command, place)
        return entry_info(entry)

    def use(self, noted: NotedMap, command: CommandEntry) -> None:
        """Take a map into use as ``command`` noted it."""
        self._use(command, MapInUse(noted.map_id, noted.name, grid_of(noted)))

    def _use(self, command: CommandEntry, place: MapInUse) -> None:
        arguments = command.arguments
        tie: Tie | None = None
        here = self._supervisor.robot.drive.odometry.latest
        if arguments["robot_in_map"] is not None:
            if here is None:
                raise MissionError("there is no odometry yet to tie to the map")
            tie = Tie.between(msgspec.convert(arguments["robot_in_map"], Pose2), here.in_odom)
        self._supervisor.require_replaceable_map()
        # It was encoded long before, on the worker; its time is when it takes effect.
        self._journal.asked(replace(command, time_ns=now_ns()))
        self._supervisor.use(place, tie)

    def _place(self) -> MapInUse:
        place = self._supervisor.whereabouts.map_in_use
        if place is None:
            raise MapError("no map is in use: make one, or load one")
        return place


def _place_of(stored: StoredMap) -> MapInUse:
    """Return a stored map as one to use, made of what it was made of; nothing ties odometry to it yet."""
    entry = stored.entry
    place = MapInUse(entry.digest, entry.name, stored.grid, entry.digest, stored.stops)
    if entry.is_unsaved:
        place.found_unsaved(entry.version)
    return place


def use_map(arguments: dict[str, Any], grid: OccupancyGrid) -> CommandEntry:
    """Return the journal's entry of taking a map into use, encoded: for a large one that takes a second."""
    return encoded(CommandEntry(0, "use_map", arguments | {"grid": noted_grid(grid)}))
