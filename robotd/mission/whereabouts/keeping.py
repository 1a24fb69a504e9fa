"""Keeps the map in use from getting lost: what nobody saved goes to the store by itself, marked as unsaved.

While a mission maps, it does so after each stop: a sweep takes half a minute, and the largest map a second of the disk.
It writes beside the mission, and nothing that the robot does depends on it: a replay has none of this, and writes
nothing.
"""

import asyncio
import logging
from functools import partial
from typing import Any, Protocol

import msgspec

from robotd.contract.modes import Mode
from robotd.core.clock import now_ns, wall_offset_ns
from robotd.core.errors import MissionError, RobotdError
from robotd.head.compute import Compute
from robotd.head.head import Head
from robotd.head.jobs import MakeFiles
from robotd.head.wire import JobFailed
from robotd.maps.archive import Archive
from robotd.maps.entry import UNSAVED, MapEntry
from robotd.maps.packed_content import PackedContent
from robotd.mission.map_entries import BUMPS, ERRAND
from robotd.mission.news import News
from robotd.mission.whereabouts.map_in_use import MapInUse, MapState
from robotd.mission.whereabouts.whereabouts import Whereabouts

_LAST_S = 20.0
"""How long the end of the daemon waits for the disk; the service manager must wait longer (``TimeoutStopSec``)."""

log = logging.getLogger(__name__)


class KeepingHost(Protocol):
    """The supervisor, as far as the map in use concerns it."""

    whereabouts: Whereabouts
    news: News

    @property
    def mode(self) -> Mode:
        """What the robot is allowed to do now."""

    def publish_status(self) -> None:
        """Tell everybody how the whole robot is."""


class Keeping:
    """Watches the map in use and keeps it whenever something of it is in memory alone."""

    def __init__(self, host: KeepingHost, archive: Archive[PackedContent], head: Head, disk: Compute) -> None:
        self._host = host
        self._archive = archive
        self._head = head
        self._disk = disk
        self.turn = asyncio.Lock()
        """Held while a map goes to the store: what is kept and what is saved must know of each other."""
        self._tried: tuple[str, MapState] | None = None
        """What was tried last: a disk that refused it is not asked again with every event."""

    async def run(self) -> None:
        """Keep the map whenever it has changed, until cancelled."""
        with self._host.news.events.subscribe() as events:
            async for _ in events:  # whichever: those missed while the disk was busy are no loss
                place = self._host.whereabouts.map_in_use
                if place is not None and place.is_at_risk and self._tried != _state_of(place):
                    await self.keep()

    async def keep(self) -> str | None:
        """Bring what nobody saved of the map in use to the store; return why that cannot be done, None if it was."""
        async with self.turn:
            # Again if the map grew while the disk was busy, or another one is in use by now.
            while (place := self._host.whereabouts.map_in_use) is not None and place.is_at_risk:
                self._tried = _state_of(place)
                try:
                    entry = await self._kept(place)
                except (RobotdError, JobFailed) as error:
                    log.error("the unsaved map %s is in memory alone: %s", place.name, error)  # noqa: TRY400  # foreseen
                    return str(error)
                log.info("map %s is not saved, but kept as version %d: robotctl map save", entry.name, entry.version)
                self._host.publish_status()
            return None

    async def make_way(self) -> None:
        """Keep the map in use before another comes in its place.

        Raises:
            MissionError: it cannot be kept, and nobody gave it up; says what to do.
        """
        if self._host.mode is Mode.UNDER_WAY:
            return  # then no other comes in its place
        why = await self.keep()
        place = self._host.whereabouts.map_in_use
        if why is not None and place is not None:
            raise MissionError(
                f"the unsaved map {place.name} would be lost, for it cannot be kept: {why}; "
                "make room and try again, or give it up: robotctl map discard"
            )

    @property
    def is_needed(self) -> bool:
        """Whether anything of the map in use is in memory alone."""
        place = self._host.whereabouts.map_in_use
        return place is not None and place.is_at_risk

    async def keep_last(self) -> None:
        """Keep the map at the daemon's end, for which the disk has a while."""
        try:
            async with asyncio.timeout(_LAST_S):
                await self.keep()
        except TimeoutError:
            log.error("the disk took longer than %g s to keep the unsaved map", _LAST_S)  # noqa: TRY400  # that is all

    async def _kept(self, place: MapInUse) -> MapEntry:
        # As of now: it may change while the disk writes.
        state = place.state
        entry = await self.store(place, place.name, {UNSAVED: True})
        place.kept(state, entry.version)
        return entry

    async def store(self, place: MapInUse, name: str, metadata: dict[str, Any]) -> MapEntry:
        """Bring a map to the store as it is now: it may grow while the disk writes. To be called in one's turn.

        Raises:
            MapError: the disk refused, or the name is none.
            ChildError: there is no head to make files of it.
        """
        told = {"generation": place.generation, "map_id": place.map_id, **metadata}
        if place.bumps_m:
            told[BUMPS] = place.bumps_m
        if place.errand is not None:
            told[ERRAND] = msgspec.to_builtins(place.errand)
        created_ns = now_ns() + wall_offset_ns()
        made = await self._head.ask(MakeFiles(place.ref))
        if made.remark is not None:
            log.warning("map %s goes to the store without its stops: %s", name, made.remark)
        save = partial(self._archive.save, in_place_of=place.kept_beside)
        return await self._disk.run("save map", lambda: save(name, made.content, told, created_ns))


def _state_of(place: MapInUse) -> tuple[str, MapState]:
    return place.map_id, place.state
