"""Everything that happens, to all who listen; maps on a socket of their own, so that they never crowd out a pose."""

import asyncio
import logging
from typing import NoReturn

from robotd.contract.answers import ErrorCode
from robotd.contract.events import MapChanged, Status
from robotd.contract.refusal import as_refusal
from robotd.contract.requests import GetStatus, MapShow
from robotd.contract.topics import EVENTS, Published, Topic
from robotd.core.broadcast import Subscription
from robotd.core.clock import now_ns
from robotd.core.counted import Counted
from robotd.core.errors import RobotdError, ServerError
from robotd.core.log_limit import LogLimit
from robotd.server.map_queue import MapQueue
from robotd.server.mission_port import MissionPort
from robotd.server.outlet import Outlet

DEPTH = 4096
"""How many events may wait for their turn."""
COSTLY = frozenset({Topic.RANK})
"""What is made for readers alone."""

log = logging.getLogger(__name__)


class Publisher:
    """Publishes the events of the mission, and the lines of its log."""

    def __init__(self, control: MissionPort, events: Subscription[Published], session: str, counted: Counted) -> None:
        """Take the events of ``control`` by a subscription that is open already, so that the very first are there."""
        self.state = Outlet(session, counted)
        """Everything small."""
        self.maps = Outlet(session, counted, self._joined_maps)
        self._control = control
        self._events = events
        self._map_queue = MapQueue()
        self._complaints = LogLimit()

    async def run(self) -> None:
        """Publish until cancelled."""
        async with asyncio.TaskGroup() as group:
            group.create_task(self._follow_events())
            group.create_task(self._follow_maps())

    async def _follow_events(self) -> NoReturn:
        try:
            # From the first moment on there is a status for the greeting, which clients take as the sign to begin.
            status = await self._control.perform(GetStatus())
            self._publish(status)
        except ServerError as error:
            # What moves the robot is busy, or ends as this begins: no fault of ours, and the next comes soon.
            log.debug("the first status was refused: %s", error)
        except Exception as error:
            self._complain("the first status", error)
        while True:
            event = await self._events.get()
            # With the status, which comes each second by itself: no clock more, and a word that was lost is
            # said again.
            if isinstance(event, Status):
                self._watch()
            if EVENTS[type(event)][0] is Topic.MAP:
                self._map_queue.put(event)
            else:
                self._publish(event)

    def _watch(self) -> None:
        """Say which of the costly topics somebody reads: with every status, so that it need not arrive each time."""
        self._control.watch(frozenset(topic for topic in COSTLY if self.state.is_read(topic)))

    def _publish(self, event: Published) -> None:
        try:
            self.state.send(event)
        except Exception as error:  # one event that has no form on the wire must not end those that have one
            self._complain(type(event).__name__, error)

    def _complain(self, what: str, error: Exception) -> None:
        if line := self._complaints.line(f"{what} was not published: {error!r}"):
            log.error("%s", line)

    def _joined_maps(self, topic: Topic) -> None:
        if topic is Topic.MAP:
            self._map_queue.ask_for_whole()

    async def _follow_maps(self) -> NoReturn:
        while True:
            event = await self._map_queue.get()
            # Asked for when its turn comes: the map of then has in it all that waited.
            event = await self._whole() if event is None else event
            if event is not None:
                await self._publish_map(event)

    async def _publish_map(self, event: Published) -> None:
        try:
            await self.maps.send_large(event)
        except Exception as error:  # no memory, no thread: the next one may have them
            self._complain(type(event).__name__, error)

    async def _whole(self) -> MapChanged | None:
        try:
            return await self._control.perform(MapShow())
        except RobotdError as error:
            # Who has a map of the daemon before this one must not go on with it. Busy: the next who joins asks again.
            return MapChanged.none(now_ns()) if as_refusal(error).code == ErrorCode.NOT_FOUND else None
        except Exception as error:  # the next who joins asks again
            self._complain("the map in use", error)
            return None
