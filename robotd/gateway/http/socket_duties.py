"""What every socket does: send what waits, hang up on who reads nothing, end as a whole."""

import asyncio
from collections.abc import Awaitable, Callable, Coroutine
from typing import Any, Protocol

from aiohttp import WSMsgType, web

from robotd.core.errors import ServerError
from robotd.core.together import ended
from robotd.gateway.house import Connected

_BLOCKED_S = 10.0
"""How long one message may take to be sent."""

Item = str | bytes | dict[str, int]


async def write(connection: Connected, send: Callable[[Item], Awaitable[None]]) -> None:
    """Send what waits, until the connection has to end."""
    while True:
        await connection.woken.wait()
        connection.woken.clear()
        if connection.ended is not None:
            return
        while (item := connection.outbox.take()) is not None and connection.ended is None:
            try:
                async with asyncio.timeout(_BLOCKED_S):
                    await send(item)
            except (TimeoutError, ConnectionError):
                connection.finish("it reads nothing")
                return


class Taking(Protocol):
    """Who is at the far end, as far as it says things."""

    def take(self, text: str) -> None:
        """Take what it says; ServerError ends it."""

    def finish(self, reason: str) -> None:
        """Let it end, and be told why."""


async def read(socket: web.WebSocketResponse, connection: Taking, only_text: str) -> None:
    """Take what the far end says, until it ends or says what may not be said; ``only_text`` tells who sends bytes."""
    async for message in socket:
        if message.type is not WSMsgType.TEXT:
            connection.finish(only_text)
            return
        try:
            connection.take(message.data)
        except ServerError as error:
            connection.finish(error.message)
            return


async def first_of(*duties: Coroutine[Any, Any, None]) -> None:
    """Do all until one ends; then end the others."""
    tasks = [asyncio.create_task(duty) for duty in duties]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for error in await ended(tasks):
            raise error
