"""The front's end: a mission to ask and to hear of, which lives at the other end of two channels."""

import asyncio
from typing import Any, NoReturn, TypeVar

from robotd.children.channel import Channel
from robotd.contract.answers import ErrorCode
from robotd.contract.envelope import Reply, encode_request
from robotd.contract.events import MapChanged
from robotd.contract.plain import from_plain
from robotd.contract.request import Request
from robotd.contract.requests import Disarm, Stop
from robotd.contract.topics import Published, Topic
from robotd.core.broadcast import Broadcast
from robotd.core.errors import ServerError
from robotd.front.messages import Watch, said

R = TypeVar("R")

_STUCK = ServerError(ErrorCode.BUSY, "what moves the robot takes no requests now")


class FrontSide:
    """The mission, as the server needs it (:class:`robotd.server.mission_port.MissionPort`)."""

    def __init__(self, stops: Channel, requests: Channel) -> None:
        self.events: Broadcast[Published] = Broadcast()
        """What the heart tells, its log included."""
        self._stops = stops
        self._requests = requests
        self._number = 0
        self._waiting: dict[int, asyncio.Future[Any]] = {}
        self._stopping: set[asyncio.Future[Any]] = set()

    def halt(self, request: Stop | Disarm) -> None:
        """Send a stop, past all that waits; a lane too full of stops for another has one at its end."""
        answered = self._ask(self._stops, request)
        self._stopping.add(answered)
        answered.add_done_callback(self._stopping.discard)
        # Else asyncio would complain of an error that nobody looked at.
        answered.add_done_callback(_heard)

    def watch(self, topics: frozenset[Topic]) -> None:
        """Send word of what somebody reads."""
        self._number += 1
        self._requests.send(encode_request(self._number, Watch(tuple(sorted(topics)))))

    async def stopped(self) -> None:
        """Wait until the stops so far were carried out."""
        if stopping := tuple(self._stopping):
            await asyncio.wait(stopping)

    async def perform(self, request: Request[R], client: str = "") -> R:
        """Have a request of a client carried out; ServerError if it was not."""
        answer: Any = await self._ask(self._requests, request, client)
        if isinstance(answer, dict):
            answer = from_plain(request.result, answer)
        return answer  # type: ignore[no-any-return]  # the heart answers a request by what it promises

    async def run(self) -> NoReturn:
        """Hear what the heart says, until cancelled; ChildError when it hung up."""
        while True:
            match said(await self._requests.receive()):
                case Reply(number, result):
                    self._answered(number, result)
                case (int(number), MapChanged() as change):
                    self._answered(number, change)
                case happened:
                    self.events.publish(happened)

    def _ask(self, lane: Channel, request: Request[Any], client: str = "") -> "asyncio.Future[Any]":
        self._number += 1
        number = self._number
        answered = asyncio.get_running_loop().create_future()
        # Refused, not queued: what waits here would be carried out after its client has given it up.
        if not lane.send(encode_request(number, request, client)):
            answered.set_exception(_STUCK)
            return answered
        self._waiting[number] = answered
        answered.add_done_callback(lambda _: self._waiting.pop(number, None))
        return answered

    def _answered(self, number: int | None, result: object) -> None:
        waiting = self._waiting.get(number) if number is not None else None
        if waiting is None or waiting.done():
            return  # who asked has gone since
        if isinstance(result, ServerError):
            waiting.set_exception(result)
        else:
            waiting.set_result(result)


def _heard(answered: "asyncio.Future[Any]") -> None:
    """Take note of how a stop was answered: it was obeyed, and nobody has to ask."""
    if not answered.cancelled():
        answered.exception()
