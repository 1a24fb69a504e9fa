"""Commands in, replies out.

Requests are taken in the order they come and carried out side by side, a bounded number at a time, so that a slow one
(saving a map) never delays a lease. A stop waits for nothing: it is obeyed where it is taken, before anybody asks
whether it is well made or there is room for it; it is never answered from memory, and it cancels an ``arm`` that is
under way.
"""

import asyncio
import logging
from typing import Any

from robotd.contract.envelope import BadRequest, Request, decode_request, encode_error, encode_result, refuse_frames
from robotd.contract.map_wire import MapPayload
from robotd.contract.requests import Arm, Command, Done, ErrorCode, Stop
from robotd.contract.stopping import STOPPING
from robotd.core.errors import RobotdError, ServerError
from robotd.server.handlers import Handlers, as_refusal
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
        self._pending: dict[asyncio.Task[None], Command[Any]] = {}
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
        request = decode_request(letter.frames[0], self._max_bytes) if one_frame else refuse_frames(letter.frames)
        if isinstance(request, BadRequest):
            if request.means_stop:
                self._obey(_UNREADABLE, letter)
            await self._router.answer(letter.route, encode_error(request.id, request.error))
            return
        is_stop = isinstance(request.command, STOPPING)
        if is_stop:
            self._obey(request.command, letter)
        reply = self._answer_at_once(request, letter, is_stop=is_stop)
        if reply is not None:
            await self._router.answer(letter.route, reply)
        elif is_stop or not self._replies.is_under_way((letter.identity, request.id)):
            self._begin(request, letter, group)

    def _obey(self, command: Command[Any], letter: Letter) -> None:
        """Stop the robot, whatever is to be answered."""
        for task, other in self._pending.items():
            if isinstance(other, Arm):
                self._overtaken.add(task)
                task.cancel()
        try:
            self._handlers.halt(command)
        except Exception:  # what takes the next stop must live on
            log.exception("%s", command.cmd)
        self._log.obeyed(letter.sender, command)

    def _answer_at_once(self, request: Request, letter: Letter, *, is_stop: bool) -> bytes | None:
        """Return the reply to a request for which nothing more is to be done; None for all others."""
        asker = (letter.identity, request.id)
        if not is_stop and self._replies.is_under_way(asker):
            return None
        given = None if is_stop else self._replies.given(asker)
        if (
            given is not None
            or sum(isinstance(one, STOPPING) is is_stop for one in self._pending.values()) < self._max_pending
        ):
            return given
        if is_stop:
            return encode_result(request.id, Done())  # it was obeyed; only nobody waits for the mission's last word
        return encode_error(request.id, ServerError(ErrorCode.BUSY, f"{self._max_pending} requests are under way"))

    def _begin(self, request: Request, letter: Letter, group: asyncio.TaskGroup) -> None:
        self._replies.begin((letter.identity, request.id))
        task = group.create_task(self._serve(request, letter), name=f"command {request.command.cmd}")
        self._pending[task] = request.command
        task.add_done_callback(self._forget)

    def _forget(self, task: asyncio.Task[None]) -> None:
        del self._pending[task]
        self._overtaken.discard(task)

    async def _serve(self, request: Request, letter: Letter) -> None:
        asker: Asker = (letter.identity, request.id)
        reply = None
        try:
            reply = await self._carry_out(request, letter)
        finally:
            is_worth_it = not (request.command.only_looks or isinstance(request.command, STOPPING))
            self._replies.end(asker, reply if is_worth_it else None)
        await self._router.answer(letter.route, reply)

    async def _carry_out(self, request: Request, letter: Letter) -> bytes:
        try:
            result = await self._handlers.carry_out(request.command)
            if isinstance(result, MapPayload):
                reply = await asyncio.to_thread(encode_result, request.id, result)  # megabytes
            else:
                reply = encode_result(request.id, result)
        except asyncio.CancelledError:
            if asyncio.current_task() not in self._overtaken:
                raise
            return self._refuse(request, letter, _OVERTAKEN)
        except RobotdError as error:
            return self._refuse(request, letter, as_refusal(error))
        except Exception as error:
            log.exception("command %s", request.command.cmd)
            internal = ServerError(ErrorCode.INTERNAL, f"internal error: {type(error).__name__}")
            return self._refuse(request, letter, internal)
        self._log.done(letter.sender, request.command, result)
        return reply

    def _refuse(self, request: Request, letter: Letter, error: ServerError) -> bytes:
        self._log.refused(letter.sender, request.command, error)
        return encode_error(request.id, error)
