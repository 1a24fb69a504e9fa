"""Commands in, replies out: the ROUTER socket.

Requests are taken in the order they come and carried out side by side, a bounded number at a time, so that a slow one
(saving a map) never delays a lease. A stop waits for nothing: it has places of its own, it is never answered from
memory, and it cancels an ``arm`` that is still under way.
"""

import asyncio
import logging
from typing import Any

import zmq
import zmq.asyncio

from robotd.core.errors import RobotdError, ServerError
from robotd.server.api import Arm, Command, ErrorCode, Stop
from robotd.server.envelope import BadRequest, Request, decode_request, encode_error, encode_result
from robotd.server.handlers import Handlers, as_refusal
from robotd.server.replies import Asker, Replies

_MOST_FRAMES = 3
"""Identity, the empty frame that a REQ socket puts before its message, and the message."""
_TOO_MANY_FRAMES = ServerError(ErrorCode.MALFORMED, "a request is one frame")
_OVERTAKEN = ServerError(ErrorCode.REFUSED, "overtaken by a stop")

log = logging.getLogger(__name__)


class Commands:
    """Serves one ROUTER socket."""

    def __init__(
        self, socket: zmq.asyncio.Socket, handlers: Handlers, *, max_bytes: int, max_pending: int, remembered: int
    ) -> None:
        self._socket = socket
        self._handlers = handlers
        self._max_bytes = max_bytes
        self._max_pending = max_pending
        self._replies = Replies(remembered)
        self._pending: dict[asyncio.Task[None], Command[Any]] = {}
        self._overtaken: set[asyncio.Task[Any]] = set()

    async def run(self) -> None:
        """Serve until cancelled; requests under way are cancelled with it."""
        async with asyncio.TaskGroup() as group:
            while True:
                frames = await self._socket.recv_multipart()
                await self._take(frames, group)
                await asyncio.sleep(0)  # a flood of requests must not keep the loop from everything else

    async def _take(self, frames: list[bytes], group: asyncio.TaskGroup) -> None:
        route, payload = frames[:-1], frames[-1]
        if len(frames) > _MOST_FRAMES:
            await self._answer(route[:1], encode_error(None, _TOO_MANY_FRAMES))
            return
        request = decode_request(payload, self._max_bytes)
        if isinstance(request, BadRequest):
            await self._answer(route, encode_error(request.id, request.error))
            return
        asker = (route[0], request.id)
        is_stop = isinstance(request.command, Stop)
        if self._replies.is_under_way(asker) and not is_stop:
            return
        reply = None if is_stop else self._replies.given(asker)
        if reply is None and not self._has_room(is_stop=is_stop):
            reply = encode_error(request.id, ServerError(ErrorCode.BUSY, f"{self._max_pending} requests are under way"))
        if reply is None:
            self._begin(request, route, group)
        else:
            await self._answer(route, reply)

    def _has_room(self, *, is_stop: bool) -> bool:
        return sum(isinstance(command, Stop) is is_stop for command in self._pending.values()) < self._max_pending

    def _begin(self, request: Request, route: list[bytes], group: asyncio.TaskGroup) -> None:
        if isinstance(request.command, Stop):
            self._cancel_arming()
        self._replies.begin((route[0], request.id))
        task = group.create_task(self._serve(request, route), name=f"command {request.command.cmd}")
        self._pending[task] = request.command
        task.add_done_callback(self._forget)

    def _forget(self, task: asyncio.Task[None]) -> None:
        del self._pending[task]
        self._overtaken.discard(task)

    def _cancel_arming(self) -> None:
        for task, command in self._pending.items():
            if isinstance(command, Arm):
                self._overtaken.add(task)
                task.cancel()

    async def _serve(self, request: Request, route: list[bytes]) -> None:
        asker: Asker = (route[0], request.id)
        reply = None
        try:
            reply = await self._carry_out(request)
        finally:
            is_worth_it = not (request.command.only_looks or isinstance(request.command, Stop))
            self._replies.end(asker, reply if is_worth_it else None)
        await self._answer(route, reply)

    async def _carry_out(self, request: Request) -> bytes:
        try:
            return encode_result(request.id, await self._handlers.carry_out(request.command))
        except asyncio.CancelledError:
            if asyncio.current_task() not in self._overtaken:
                raise
            return encode_error(request.id, _OVERTAKEN)
        except RobotdError as error:
            return encode_error(request.id, as_refusal(error))
        except Exception as error:
            log.exception("command %s", request.command.cmd)
            return encode_error(request.id, ServerError(ErrorCode.INTERNAL, f"internal error: {type(error).__name__}"))

    async def _answer(self, route: list[bytes], reply: bytes) -> None:
        await self._socket.send_multipart([*route, reply])
