"""The heart's end: carries out what the front hands on, and tells it what happens."""

import asyncio
import logging
from collections.abc import Sequence
from typing import NoReturn

from robotd.children.channel import Channel
from robotd.contract.events import Event
from robotd.contract.topics import LogEntry, Published
from robotd.core.broadcast import Subscription
from robotd.core.errors import ChildError
from robotd.core.log_limit import LogLimit
from robotd.core.together import together
from robotd.front.asked import Asked, Heart
from robotd.front.decimation import Decimator
from robotd.front.log_relay import relay_log
from robotd.front.messages import event, settings_message
from robotd.front.outcomes import Outcomes
from robotd.server.settings import ServerSettings

log = logging.getLogger(__name__)

LANES = 2
"""Stops, and everything else."""
DEPTH = 4096
"""How many events, or lines of the log, may wait for a front that does not take them."""


class HeartSide:
    """Serves one front after the other."""

    def __init__(self, heart: Heart, settings: ServerSettings) -> None:
        """Serve fronts that work by these settings."""
        self._heart = heart
        self._settings = settings
        self._outcomes = Outcomes()

    @property
    def runtime_dir(self) -> str:
        """Where a front has its sockets."""
        return self._settings.runtime_dir

    async def follow(self) -> None:
        """Note how missions end, whether there is a front or not, until cancelled."""
        await self._outcomes.follow(self._heart.events)

    async def serve(self, lanes: Sequence[Channel]) -> NoReturn:
        """Serve a front for as long as it lives.

        Raises:
            ChildError: it is gone, or sent what no front sends.
        """
        stops, requests = lanes
        # First: it reads no file of ours (decision 45), so all that it goes by comes over this lane.
        requests.send(settings_message(self._settings))
        asked = Asked(self._heart, self._outcomes, requests)
        lines: asyncio.Queue[LogEntry] = asyncio.Queue(DEPTH)
        # A full queue drops lines: what logs must not wait for those who read.
        relayed = relay_log(lambda line: None if lines.full() else lines.put_nowait(line))
        # Of a front that is slow the oldest events are lost, not the newest, and the heart waits for neither.
        with self._heart.events.subscribe(DEPTH) as events, relayed:
            await together(
                asked.take(stops, requests),
                _tell_events(events, Decimator(self._settings.routine_hz), requests),
                _tell_lines(lines, requests),
            )


async def _tell_events(events: Subscription[Event], decimator: Decimator, lane: Channel) -> NoReturn:
    complaints = LogLimit()
    while True:
        happened = await events.get()
        if not decimator.passes(happened):
            continue
        try:
            await _tell(happened, lane)
        # The lane is gone, which is no fault of this event.
        except ChildError:
            raise
        except Exception as error:  # one event that has no form must not end those that have one
            if line := complaints.line(f"{type(happened).__name__} was not published: {error!r}"):
                log.error("%s", line)  # noqa: TRY400  # it is the event that is odd, not the place


async def _tell_lines(lines: asyncio.Queue[LogEntry], lane: Channel) -> NoReturn:
    while True:
        await _tell(await lines.get(), lane)


async def _tell(happened: Published, lane: Channel) -> None:
    parts = event(happened)
    while not lane.send(*parts):
        await lane.room()
