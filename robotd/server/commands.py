"""Commands in, replies out.

Requests are taken in turn and carried out side by side, a bounded number at a time and a second, so that neither a slow
one (saving a map) nor a flood delays a lease. A stop waits for nothing: it is obeyed where it is taken, before anybody
asks whether it is well made or there is room for it; it is never answered from memory, and it cancels an ``arm`` that
is under way.
"""

import asyncio
import logging
from typing import Any, Protocol

from robotd.contract.answers import Done, ErrorCode
from robotd.contract.envelope import (
    LONGEST_CLIENT,
    BadRequest,
    NumberedRequest,
    decode_request,
    encode_error,
    encode_result,
    refuse_frames,
)
from robotd.contract.events import MapChanged
from robotd.contract.refusal import as_refusal
from robotd.contract.request import Request
from robotd.contract.requests import Disarm, Renew, Stop
from robotd.contract.stopping import STOPPING
from robotd.core.counted import Counted
from robotd.core.errors import RobotdError, ServerError
from robotd.core.text import printable
from robotd.server.handlers import Handlers
from robotd.server.letters import Letter
from robotd.server.rates import ALTOGETHER_HZ, PER_CLIENT_HZ, Often, Rates
from robotd.server.replies import Asker, Replies
from robotd.server.request_log import RequestLog
from robotd.server.requests_under_way import UnderWay

_OVERTAKEN = ServerError(ErrorCode.REFUSED, "overtaken by a stop")
_TOO_OFTEN = f"a client may ask {PER_CLIENT_HZ:g} times a second, all of them together {ALTOGETHER_HZ:g} times"
_AT_A_TURN = 8
"""Requests that are only refused, before others of the loop have their turn."""
_UNREADABLE = Stop("stopped by a client, in a request that is not well made")

log = logging.getLogger(__name__)


class Asking(Protocol):
    """Where requests come from, and answers go to."""

    async def receive(self) -> Letter:
        """Wait for the next request."""

    def answer(self, route: tuple[bytes, ...], reply: bytes) -> None:
        """Answer; what cannot be sent is lost."""


class Commands:
    """Serves who asks."""

    def __init__(
        self,
        letters: Asking,
        handlers: Handlers,
        counted: Counted,
        *,
        max_bytes: int,
        max_pending: int,
        remembered: int,
    ) -> None:
        self._letters = letters
        self._counted = counted
        self._handlers = handlers
        self._max_bytes = max_bytes
        self._replies = Replies(remembered)
        self._under_way = UnderWay(max_pending)
        self._rates = Rates()
        self._overtaken: set[asyncio.Task[Any]] = set()
        self._log = RequestLog()

    async def run(self) -> None:
        """Serve until cancelled; requests under way are cancelled with it."""
        async with asyncio.TaskGroup() as group:
            while True:
                # Several at a turn as long as they are only refused: a flood is then over sooner than it came.
                for _ in range(_AT_A_TURN):
                    if self._take(await self._letters.receive(), group):
                        break
                await asyncio.sleep(0)  # a flood of requests must not keep the loop from everything else

    def _take(self, letter: Letter, group: asyncio.TaskGroup) -> bool:
        """Take a request, and return whether more is to be done than to answer it."""
        one_frame = len(letter.frames) == 1
        numbered = decode_request(letter.frames[0], self._max_bytes) if one_frame else refuse_frames(letter.frames)
        if isinstance(numbered, BadRequest):
            if numbered.means_stop:
                self._obey(_UNREADABLE, letter)
            self._letters.answer(letter.route, self._error(numbered.id, numbered.error))
            return False
        letter = letter.signed(numbered.client)
        if is_stop := isinstance(numbered.request, STOPPING):
            self._obey(numbered.request, letter)
        reply = self._answer_at_once(numbered, letter, is_stop=is_stop)
        if reply is not None:
            self._letters.answer(letter.route, reply)
            return False
        # A repeat of what is under way is served by the one reply to come; a stop is obeyed and waited for each time.
        if is_stop or not self._replies.is_under_way((letter.identity, numbered.id)):
            self._begin(numbered, letter, group)
        return True

    def _obey(self, stop: Stop | Disarm, letter: Letter) -> None:
        """Stop the robot, whatever is to be answered."""
        # An arm under way would go on to the next device after the stop.
        for task in self._under_way.arming():
            self._overtaken.add(task)
            task.cancel()
        try:
            self._handlers.halt(stop)
        except Exception:  # what takes the next stop must live on
            log.exception("%s", stop.cmd)
        self._log.obeyed(letter.sender, stop)

    def _answer_at_once(self, numbered: NumberedRequest, letter: Letter, *, is_stop: bool) -> bytes | None:
        """Return the reply to a request for which nothing more is to be done; None for all others."""
        asker = (letter.identity, numbered.id)
        if not is_stop and self._replies.is_under_way(asker):
            return None
        given = None if is_stop else self._replies.given(asker)
        if given is not None:
            return given
        # After the memory of answers: a repeat costs nothing, and is not counted as asking.
        no_room = self._no_room(letter.identity, numbered.request, is_stop=is_stop)
        if no_room is None:
            return None
        if is_stop:  # it was obeyed; only nobody waits for the mission's last word
            return self._counting("ok", encode_result(numbered.id, Done()))
        return self._error(numbered.id, ServerError(ErrorCode.BUSY, no_room))

    def _no_room(self, identity: bytes, request: Request[Any], *, is_stop: bool) -> str | None:
        if is_stop:
            return self._under_way.no_room(identity, request, seldom=False)
        often = self._rates.asked(identity, only_its_own=isinstance(request, Renew))
        if often is Often.TOO_OFTEN:
            return _TOO_OFTEN
        return self._under_way.no_room(identity, request, seldom=often is Often.SELDOM)

    def _begin(self, numbered: NumberedRequest, letter: Letter, group: asyncio.TaskGroup) -> None:
        self._replies.begin((letter.identity, numbered.id))
        task = group.create_task(self._serve(numbered, letter), name=f"request {numbered.request.cmd}")
        self._under_way.begin(task, letter.identity, numbered.request)
        task.add_done_callback(self._overtaken.discard)

    async def _serve(self, numbered: NumberedRequest, letter: Letter) -> None:
        asker: Asker = (letter.identity, numbered.id)
        reply = None
        try:
            reply = await self._carry_out(numbered, letter)
        finally:
            # What was seen then is not what is now, so a repeat looks again; and a stop is never answered from memory.
            is_worth_it = not (numbered.request.only_looks or isinstance(numbered.request, STOPPING))
            # In any case, a cancellation included: a request that stayed under way for ever would never be
            # answered again.
            self._replies.end(asker, reply if is_worth_it else None)
        self._letters.answer(letter.route, reply)

    async def _carry_out(self, numbered: NumberedRequest, letter: Letter) -> bytes:
        try:
            result = await self._handlers.carry_out(
                numbered.request, numbered.client or printable(letter.sender, LONGEST_CLIENT)
            )
            # Off the loop, for a stop waits behind what is encoded on it.
            if isinstance(result, MapChanged):
                reply = await asyncio.to_thread(encode_result, numbered.id, result)  # megabytes
            else:
                reply = encode_result(numbered.id, result)
        except asyncio.CancelledError:
            if asyncio.current_task() not in self._overtaken:
                raise
            return self._refuse(numbered, letter, _OVERTAKEN)
        except RobotdError as error:
            return self._refuse(numbered, letter, as_refusal(error))
        except Exception as error:
            log.exception("request %s", numbered.request.cmd)
            internal = ServerError(ErrorCode.INTERNAL, f"internal error: {type(error).__name__}")
            return self._refuse(numbered, letter, internal)
        self._log.done(letter.sender, numbered.request, result)
        return self._counting("ok", reply)

    def _refuse(self, numbered: NumberedRequest, letter: Letter, error: ServerError) -> bytes:
        self._log.refused(letter.sender, numbered.request, error)
        return self._error(numbered.id, error)

    def _error(self, number: int | None, error: ServerError) -> bytes:
        return self._counting(error.code, encode_error(number, error))

    def _counting(self, code: str, reply: bytes) -> bytes:
        self._counted.count("requests_total", code=code)
        return reply
