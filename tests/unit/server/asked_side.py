"""Commands on a socket that is a list."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from robotd.contract.envelope import Reply, decode_reply, encode_request
from robotd.contract.request import Request
from robotd.core.counted import Counted
from robotd.core.errors import ServerError
from robotd.server.commands import Commands
from robotd.server.handlers import Handlers
from robotd.server.letters import Letter, letter


class ListSocket:
    """Takes requests from a queue, keeps the replies."""

    def __init__(self) -> None:
        self.requests: asyncio.Queue[list[bytes]] = asyncio.Queue()
        self.sent: list[list[bytes]] = []

    async def receive(self) -> Letter:
        identity, *frames = await self.requests.get()
        return letter(identity, tuple(frames), "")

    def answer(self, route: tuple[bytes, ...], reply: bytes) -> None:
        self.sent.append([*route, reply])

    def ask(self, number: int, command: Request[Any], client: bytes = b"A") -> None:
        self.requests.put_nowait([client, encode_request(number, command)])

    @property
    def replies(self) -> list[Reply]:
        return [decode_reply(frames[-1]) for frames in self.sent]

    @property
    def outcome(self) -> dict[int | None, str]:
        """What became of each request: ``ok``, or the code of the error."""
        return {
            reply.id: reply.result.code if isinstance(reply.result, ServerError) else "ok" for reply in self.replies
        }


@asynccontextmanager
async def served(control: Any) -> AsyncIterator[ListSocket]:
    socket = ListSocket()
    commands = Commands(
        socket,
        Handlers(control, "session", 0.5, Counted()),
        Counted(),
        max_bytes=65536,
        max_pending=4,
        remembered=8,
    )
    task = asyncio.create_task(commands.run())
    try:
        yield socket
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        await control.close()
