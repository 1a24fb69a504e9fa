"""Commands in, replies out.

Requests are taken in the order they come and carried out side by side, a bounded number at a time, so that a slow one
(saving a map) never delays a lease. A stop waits for nothing: it is obeyed where it is taken, before anybody asks
whether it is well made or there is room for it; it is never answered from memory, and it cancels an ``arm`` that is
under way.
"""

import asyncio
import logging
from typing import Any

from robotd.contract.answers import Done, ErrorCode
from robotd.contract.envelope import (
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
from robotd.contract.requests import Arm, Disarm, Stop
from robotd.contract.stopping import STOPPING
from robotd.core.errors import RobotdError, ServerError
from robotd.server.handlers import Handlers
from robotd.server.replies import Asker, Replies
from robotd.server.request_log import RequestLog
from robotd.server.router import Letter, Router

_OVERTAKEN = ServerError(ErrorCode.REFUSED, "overtaken by a stop")
_UNREADABLE = Stop("stopped by a client, in a request that is not well made")

log = logging.getLogger(__name__)


class Commands:
    """Serves one ROUTER socket."""

    def __init__(
        self, router: Router, handlers: Handlers, *, max_bytes: int, max_pending: int, remembered: int
    ) -> None:
        self._router = router
        self._handlers = handlers
        self._max_bytes = max_bytes
        self._max_pending = max_pending
        self._replies = Replies(remembered)
        self._pending: dict[asyncio.Task[None], Request[Any]] = {}
        self._overtaken: set[asyncio.Task[Any]] = set()
        self._log = RequestLog()

    async def run(self) -> None:
        """Serve until cancelled; requests under way are cancelled with it."""
        async with asyncio.TaskGroup() as group:
            while True:
                await self._take(await self._router.receive(), group)
                await asyncio.sleep(0)  # a flood of requests must not keep the loop from everything else

    async def _take(self, letter: Letter, group: asyncio.TaskGroup) -> None:
        one_frame = len(letter.frames) == 1
        numbered = decode_request(letter.frames[0], self._max_bytes) if one_frame else refuse_frames(letter.frames)
        if isinstance(numbered, BadRequest):
            if numbered.means_stop:
                self._obey(_UNREADABLE, letter)
            await self._router.answer(letter.route, encode_error(numbered.id, numbered.error))
            return
        if is_stop := isinstance(numbered.request, STOPPING):
            self._obey(numbered.request, letter)
        reply = self._answer_at_once(numbered, letter, is_stop=is_stop)
        if reply is not None:
            await self._router.answer(letter.route, reply)
        # A repeat of what is under way is served by the one reply to come; a stop is obeyed and waited for each time.
        elif is_stop or not self._replies.is_under_way((letter.identity, numbered.id)):
            self._begin(numbered, letter, group)

    def _obey(self, stop: Stop | Disarm, letter: Letter) -> None:
        """Stop the robot, whatever is to be answered."""
        # An arm under way would go on to the next device after the stop.
        for task, other in self._pending.items():
            if isinstance(other, Arm):
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
        # Stops have room of their own: requests that take long must not keep one from its answer.
        if (
            given is not None
            or sum(isinstance(one, STOPPING) is is_stop for one in self._pending.values()) < self._max_pending
        ):
            return given
        if is_stop:
            return encode_result(numbered.id, Done())  # it was obeyed; only nobody waits for the mission's last word
        return encode_error(numbered.id, ServerError(ErrorCode.BUSY, f"{self._max_pending} requests are under way"))

    def _begin(self, numbered: NumberedRequest, letter: Letter, group: asyncio.TaskGroup) -> None:
        self._replies.begin((letter.identity, numbered.id))
        task = group.create_task(self._serve(numbered, letter), name=f"request {numbered.request.cmd}")
        self._pending[task] = numbered.request
        task.add_done_callback(self._forget)

    def _forget(self, task: asyncio.Task[None]) -> None:
        del self._pending[task]
        self._overtaken.discard(task)

    async def _serve(self, numbered: NumberedRequest, letter: Letter) -> None:
        asker: Asker = (letter.identity, numbered.id)
        reply = None
        try:
            reply = await self._carry_out(numbered, letter)
        finally:
            # What was seen then is not what is now, so a repeat looks again; and a stop is never answered from memory.
            is_worth_it = not (numbered.request.only_looks or isinstance(numbered.request, STOPPING))
            self._replies.end(asker, reply if is_worth_it else None)
        await self._router.answer(letter.route, reply)

    async def _carry_out(self, numbered: NumberedRequest, letter: Letter) -> bytes:
        try:
            result = await self._handlers.carry_out(numbered.request)
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
        return reply

    def _refuse(self, numbered: NumberedRequest, letter: Letter, error: ServerError) -> bytes:
        self._log.refused(letter.sender, numbered.request, error)
        return encode_error(numbered.id, error)
