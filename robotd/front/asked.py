"""What one front asks, carried out.

A front serves strangers, so nothing that it says is believed: it is read as what a client sends. Stops have a lane of
their own and wait for nothing. As one may so be taken before what was asked earlier, requests are numbered upwards over
both lanes, and what would lead to motion is refused if a later stop was obeyed before it.
"""

import asyncio
import logging
from typing import Any, NoReturn, Protocol, TypeVar

from robotd.children.channel import Channel
from robotd.contract.answers import Done, ErrorCode, Renewed
from robotd.contract.envelope import BadRequest, NumberedRequest, decode_request
from robotd.contract.events import Event
from robotd.contract.refusal import as_refusal
from robotd.contract.request import Request
from robotd.contract.requests import Arm, Disarm, Renew, Stop
from robotd.contract.stopping import STOPPING
from robotd.contract.topics import Topic
from robotd.core.broadcast import Broadcast
from robotd.core.errors import ChildError, RobotdError, ServerError
from robotd.core.together import together
from robotd.front.messages import FROM_FRONT, Parts, Watch, answer, refusal
from robotd.front.outcomes import Outcomes

R = TypeVar("R")

LONGEST_REQUEST = 2**25
"""Bytes; the front bounds what clients send sooner (``server.max_request_bytes``)."""
_MOST_UNDER_WAY = 1024
"""Requests; the front bounds them sooner, and for each client."""
_AT_A_TURN = 8
"""Requests of a lane, before others of the loop have their turn."""
_OVERTAKEN = ServerError(ErrorCode.REFUSED, "overtaken by a stop")
_BUSY = ServerError(ErrorCode.BUSY, f"{_MOST_UNDER_WAY} requests are under way")
_UNREADABLE = Stop("stopped by a front that failed, in a request that is not well made")

log = logging.getLogger(__name__)


class Heart(Protocol):
    """Who is asked, and who tells what happens: the mission.

    Its errors become replies, as :func:`robotd.contract.refusal.as_refusal` says; what is none of ours is ``internal``.
    """

    @property
    def events(self) -> Broadcast[Event]:
        """Everything that happens."""

    def halt(self, request: Stop | Disarm) -> None:
        """Stop everything and disarm; valid at any time. The stop is on its way when this returns."""

    async def stopped(self) -> None:
        """Wait until the mission that was stopped has ended."""

    def watch(self, topics: frozenset[Topic]) -> None:
        """Take note of what somebody reads: what is costly is made for these topics alone."""

    async def perform(self, request: Request[R], client: str = "") -> R:
        """Carry out what a client requests, all but ``hello``, and answer it; RobotdError says why it was not done."""


class Asked:
    """The requests of one front, from its first to its last."""

    def __init__(self, heart: Heart, outcomes: Outcomes, answers: Channel) -> None:
        self._heart = heart
        self._outcomes = outcomes
        self._answers = answers
        self._stopped_at = -1
        """Number of the latest stop."""
        self._under_way: dict[asyncio.Task[None], Request[Any]] = {}

    async def take(self, *lanes: Channel) -> NoReturn:
        """Carry out what comes over these lanes, until cancelled.

        What is under way then is given up; an ``arm`` that nobody will hear the end of is a stop.

        Raises:
            ChildError: the front is gone, or asked what no front asks.
        """
        try:
            await together(*(self._take_from(lane) for lane in lanes))
        finally:
            await self._give_up()
        raise AssertionError("nobody stops asking but by an error")

    async def _take_from(self, lane: Channel) -> NoReturn:
        latest, taken = -1, 0
        while True:
            numbered = decode_request(bytes(await lane.receive()), LONGEST_REQUEST, FROM_FRONT)
            if isinstance(numbered, BadRequest):
                if numbered.means_stop:
                    # In doubt it is a stop (decision 17), also from a front that has lost its mind.
                    self._obey(_UNREADABLE)
                raise ChildError(f"it asked what nobody understands: {numbered.error.message}")
            # Only upwards: by its number it is known what a stop overtook, so a number that comes twice would
            # be a way round that.
            if numbered.id <= latest:
                raise ChildError(f"it asked number {numbered.id} after number {latest}")
            latest = numbered.id
            self._begin(numbered)
            taken += 1
            if taken % _AT_A_TURN == 0:  # what waits must not keep the loop, nor a stop on its own lane
                await asyncio.sleep(0)

    def _begin(self, numbered: NumberedRequest) -> None:
        request = numbered.request
        if isinstance(request, Watch):
            self._heart.watch(frozenset(request.topics))
            return
        if isinstance(request, STOPPING):
            self._obey(request)
            # Both lanes carry stops; the later one counts, whichever was read first.
            self._stopped_at = max(self._stopped_at, numbered.id)
        # After stops: there is always room for one.
        elif len(self._under_way) >= _MOST_UNDER_WAY:
            self._answers.send(*refusal(numbered.id, _BUSY))
            return
        # What only reads may be overtaken; what could lead to motion was asked by who did not know of the stop.
        elif request.is_noted and numbered.id < self._stopped_at:
            self._answers.send(*refusal(numbered.id, _OVERTAKEN))
            return
        task = asyncio.create_task(self._answer(numbered), name=f"carry out {request.cmd}")
        self._under_way[task] = request
        task.add_done_callback(self._under_way.pop)

    def _obey(self, stop: Stop | Disarm) -> None:
        try:
            # Here, where it is taken, without a task in between: a task would have its turn after all that is
            # ready now. An arming under way ends of it by itself, and is not cancelled: a replay cancels nothing.
            self._heart.halt(stop)
        except Exception:  # what takes the next stop must live on
            log.exception("%s", stop.cmd)

    async def _answer(self, numbered: NumberedRequest) -> None:
        parts = await self._carried_out(numbered)
        # An answer waits for room; it may hold a map, and the front takes one at its own pace.
        while not self._answers.send(*parts):
            await self._answers.room()

    async def _carried_out(self, numbered: NumberedRequest) -> Parts:
        try:
            return answer(numbered.id, await self._perform(numbered))
        except RobotdError as error:
            return refusal(numbered.id, as_refusal(error))
        except Exception as error:
            log.exception("request %s", numbered.request.cmd)
            # The kind alone: the text of an unforeseen error may hold paths and values that are not the
            # client's.
            return refusal(numbered.id, ServerError(ErrorCode.INTERNAL, f"internal error: {type(error).__name__}"))

    async def _perform(self, numbered: NumberedRequest) -> object:
        request = numbered.request
        if isinstance(request, STOPPING):
            await self._heart.stopped()
            return Done()
        if isinstance(request, Renew):
            return await self._renewed(request)
        return await self._heart.perform(request, numbered.client)

    async def _renewed(self, request: Renew) -> Renewed:
        try:
            await asyncio.sleep(0)  # what was published before the request came has then been noted
            progress = self._outcomes.latest(request.mission_id)
            if progress is None or not progress.is_last:
                await self._heart.perform(request)
        except RobotdError:
            # When it is over there is no lease left to renew; to refuse would hide from the client how it ended.
            progress = await self._outcomes.end_of(request.mission_id)
            if progress is None:
                raise
        return Renewed(progress)

    async def _give_up(self) -> None:
        # Nobody reads any more: what is made for readers alone stops with them.
        self._heart.watch(frozenset())
        if any(isinstance(request, Arm) for request in self._under_way.values()):
            self._obey(Stop("stopped, as the front that asked to arm is gone"))
        tasks = list(self._under_way)
        for task in tasks:
            task.cancel()
        # Waited for: the next front must not be served beside what the last one left.
        await asyncio.gather(*tasks, return_exceptions=True)
