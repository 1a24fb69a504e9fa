"""The requests about maps: save, load, give up, list and show them.

None but taking a map into use has an effect on the robot, and that is noted with the map itself: a replay has no store.
"""

import contextlib
import logging
from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import replace
from functools import partial
from typing import Any

import msgspec

from robotd.contract.answers import Done, ErrorCode, MapEntryInfo, MapList
from robotd.contract.events import MapChanged
from robotd.contract.map_import import MapImport, MapImported
from robotd.contract.request import Request
from robotd.contract.requests import ListMaps, MapDelete, MapDiscard, MapLoad, MapRename, MapSave, MapShow, PlanTo
from robotd.contract.ways import Hindrance, Way
from robotd.core.clock import now_ns, wall_offset_ns
from robotd.core.errors import MapError, MissionError, ServerError
from robotd.core.pose import Pose2
from robotd.core.text import printable
from robotd.head.compute import Compute
from robotd.head.head import Head
from robotd.head.jobs import HeldMap, PreviewWay, ReadMap, ShowMap, TakeMap
from robotd.head.parts_jobs import TakePart
from robotd.maps.archive import Archive
from robotd.maps.entry import MapEntry
from robotd.maps.packed_content import PackedContent
from robotd.maps.version_files import STOPS
from robotd.mission.map_entries import BUMPS, ERRAND, bumps_of, entry_info, errand_of
from robotd.mission.noted import NotedMap, noted_grid, packed_of, stops_of
from robotd.mission.supervisor import Supervisor
from robotd.mission.whereabouts.keeping import Keeping
from robotd.mission.whereabouts.map_in_use import MapInUse, whole
from robotd.mission.whereabouts.tie import Tie
from robotd.recording.encoding import encoded
from robotd.recording.entries import CommandEntry
from robotd.recording.preroll import PrerollJournal

log = logging.getLogger(__name__)


class MapRequests:
    """Carries them out."""

    def __init__(
        self,
        supervisor: Supervisor,
        archive: Archive[PackedContent],
        journal: PrerollJournal,
        *,
        head: Head,
        disk: Compute,
        keeping: Keeping,
    ) -> None:
        self._supervisor = supervisor
        self._archive = archive
        self._journal = journal
        self._head = head
        self._disk = disk
        self._keeping = keeping
        self.rows: dict[type[Request[Any]], Callable[[Any], Awaitable[object]]] = {
            MapSave: self._save,
            MapLoad: self._load,
            MapDiscard: self._discard,
            ListMaps: self._list,
            MapShow: self._show,
            MapDelete: self._delete,
            MapRename: self._rename,
            MapImport: self._import,
            PlanTo: self._plan,
        }

    async def _show(self, request: MapShow) -> MapChanged:
        """Return every cell of the map in use, or of a stored one; MapError if it is missing or damaged."""
        if request.name is None:
            place = self._place()
            ref = place.ref
            return whole(now_ns(), place.map_id, ref.generation, await self._head.ask(ShowMap(ref)))
        # Held by the head for this answer alone: showing a stored map changes nothing about the one in use.
        async with self._read(request.name, request.version) as (entry, _, held):
            return whole(now_ns(), entry.digest, 0, held)

    async def _plan(self, request: PlanTo) -> Way:
        """Return the way from where the robot is to a place on the map in use; MapError if there is none."""
        place = self._place()
        here, tie = self._supervisor.robot.drive.odometry.latest, self._supervisor.whereabouts.believed
        # An answer and not an error: a client that asks where a click would lead wants to show why it leads
        # nowhere.
        if here is None or tie is None:
            return Way((), 0.0, Hindrance.NOT_LOCALIZED, "the robot is not localized on this map")
        return await self._head.ask(
            PreviewWay(place.ref, tie.in_map(here.in_odom), (request.x_m, request.y_m), place.bumps_m)
        )

    async def _list(self, _: ListMaps) -> MapList:
        entries = await self._disk.run("list maps", self._archive.list)
        return MapList(tuple(map(entry_info, entries)))

    async def _save(self, request: MapSave) -> MapEntryInfo:
        """Save the map in use as a new version, under its own or another name.

        Raises:
            MapError: there is none.
            MissionError: it cannot be written; what was there before is untouched.
        """
        self._place()  # refused at once, not after a wait for one's turn
        async with self._keeping.turn:
            place = self._place()
            # As of now: the map may grow while the disk writes, and what comes later is not saved by this.
            state = place.state
            try:
                entry = await self._keeping.store(place, request.name or place.name, {})
            except MapError as error:
                raise MissionError(str(error)) from error  # there is a map, but no room for it
            place.saved(state)
        log.info("map %s was saved as version %d of %s (%s)", place.name, entry.version, entry.name, entry.digest)
        self._supervisor.publish_status()
        return entry_info(entry)

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

    async def _delete(self, request: MapDelete) -> Done:
        """Remove a stored map; MapError if there is none, MissionError if it is the one in use."""
        async with self._stored(request.name, "deleted"):
            gone = await self._disk.run("delete map", self._archive.delete, request.name, request.version)
        log.info("map %s version %s was deleted", request.name, ", ".join(map(str, gone)))
        return Done()

    async def _rename(self, request: MapRename) -> Done:
        """Give a stored map another name; MapError if there is none, MissionError if it is the one in use."""
        async with self._stored(request.name, "renamed"):
            await self._disk.run("rename map", self._archive.rename, request.name, request.new_name)
        log.info("map %s is called %s now", request.name, request.new_name)
        return Done()

    async def _import(self, request: MapImport) -> MapImported:
        """Hand a part of a map on to the head, and store what that made of all of them.

        Raises:
            ServerError: this part does not go on where the last one ended, or they make no map together.
            MissionError: it cannot be written.
        """
        part = TakePart(request.spec, request.sha256, request.size_bytes, request.offset_bytes, request.part)
        try:
            taken = await self._head.ask(part)
        except MapError as error:
            raise ServerError(ErrorCode.BAD_ARGUMENT, f"map_import {request.name}: {error}") from error
        if taken.made is None:
            return MapImported(taken.received_bytes, None)
        metadata = {"imported_from": printable(request.imported_from)}
        save, made_ns = self._archive.save, now_ns() + wall_offset_ns()
        try:
            entry = await self._disk.run("save map", save, request.name, taken.made.content, metadata, made_ns)
        except MapError as error:
            raise MissionError(str(error)) from error  # it is a map, but there is no room for it
        log.info("map %s was imported as version %d (%s)", entry.name, entry.version, entry.digest)
        return MapImported(taken.received_bytes, entry_info(entry))

    @contextlib.asynccontextmanager
    async def _stored(self, name: str, done: str) -> AsyncIterator[None]:
        """Let nothing be kept meanwhile, and refuse it for the map in use, which would be told of as saved."""
        async with self._keeping.turn:
            in_use = self._supervisor.whereabouts.map_in_use
            if in_use is not None and in_use.name == name:
                raise MissionError(f"map {name} is in use and cannot be {done}: load another one first")
            yield

    async def _load(self, request: MapLoad) -> MapEntryInfo:
        """Make a stored map the one in use.

        Raises:
            MapError: it is missing or damaged; the map in use stays.
            MissionError: a mission is under way, or the map in use would be lost, see :meth:`Keeping.make_way`.
        """
        self._supervisor.require_replaceable_map()
        async with self._read(request.name, request.version) as (entry, job, held):
            # Refused before the disk was read; _use asks again, for a mission may have begun by now.
            pose = None if request.robot_in_map is None else msgspec.to_builtins(request.robot_in_map)
            remarks = {BUMPS: bumps_of(entry), ERRAND: msgspec.to_builtins(errand_of(entry))}
            arguments = {"map_id": entry.digest, "name": request.name, "robot_in_map": pose} | remarks
            command = await self._disk.run("pack map", use_map, arguments, held, job.content.files.get(STOPS))
            await self._keeping.make_way()  # last of all, so that nothing changes the map meanwhile
            self._use(command, _place_of(entry, job.number, held))
        return entry_info(entry)

    @contextlib.asynccontextmanager
    async def _read(self, name: str, version: int | None) -> AsyncIterator[tuple[MapEntry, ReadMap, HeldMap]]:
        """Hold a stored map, everything checked, under a number; let go of it afterwards, unless it is in use then.

        Raises:
            MapError: it is missing or damaged.
        """
        entry, content = await self._disk.run("read map", self._archive.load, name, version)
        # A number of its own, not that of the map in use: if reading fails, nothing has touched the one that
        # the robot drives on.
        number = self._head.number()
        job = ReadMap(number, content)
        try:
            yield entry, job, await self._held(entry, job)
        finally:
            # Only here is it known whether it was taken into use; the head keeps what nobody forgets, and maps
            # are its largest things.
            in_use = self._supervisor.whereabouts.map_in_use
            if in_use is None or in_use.number != number:
                self._head.forget(number)

    async def _held(self, entry: MapEntry, job: ReadMap) -> HeldMap:
        try:
            return await self._head.ask(job)
        except MapError as error:  # no checksum is wrong, and yet it contradicts itself
            why = partial(self._archive.damaged, entry.name, entry.version, error)
            raise await self._disk.run("look for others", why) from error

    async def use(self, noted: NotedMap, command: CommandEntry) -> None:
        """Take a map into use as ``command`` noted it."""
        number, grid = self._head.number(), noted.grid
        held = await self._head.ask(
            TakeMap(number, grid.spec, memoryview(packed_of(noted)), grid.settings, stops_of(noted))
        )
        place = MapInUse(*(noted.map_id, noted.name, number, held), bumps_m=noted.bumps_m, errand=noted.exploring)
        self._use(command, place)

    def _use(self, command: CommandEntry, place: MapInUse) -> None:
        arguments = command.arguments
        tie: Tie | None = None
        here = self._supervisor.robot.drive.odometry.latest
        if arguments["robot_in_map"] is not None:
            if here is None:
                raise MissionError("there is no odometry yet to tie to the map")
            tie = Tie.between(msgspec.convert(arguments["robot_in_map"], Pose2), here.in_odom)
        # Again, though callers asked before: there were waits for disk and head since, and a mission may have
        # begun in one.
        self._supervisor.require_replaceable_map()
        # It was encoded long before, on the worker; its time is when it takes effect.
        self._journal.asked(replace(command, time_ns=now_ns()))
        self._supervisor.use(place, tie)

    def _place(self) -> MapInUse:
        place = self._supervisor.whereabouts.map_in_use
        if place is None:
            raise MapError("no map is in use: make one, or load one")
        return place


def _place_of(entry: MapEntry, number: int, held: HeldMap) -> MapInUse:
    """Return a stored map as one to use; nothing ties odometry to it yet."""
    place = MapInUse(*(entry.digest, entry.name, number, held), bumps_m=bumps_of(entry), errand=errand_of(entry))
    if entry.is_unsaved:
        place.found_unsaved(entry.version)
    return place


def use_map(arguments: dict[str, Any], held: HeldMap, stops: bytes | None) -> CommandEntry:
    """Return the journal's entry of taking a map into use, encoded: for a large one that takes a while."""
    return encoded(CommandEntry(0, "use_map", arguments | {"grid": noted_grid(held, stops)}))
