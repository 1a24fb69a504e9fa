"""What every socket does: send what waits, hang up on who reads nothing, end as a whole."""

import asyncio
from collections.abc import Awaitable, Callable, Coroutine
from typing import Any

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


async def first_of(*duties: Coroutine[Any, Any, None]) -> None:
    """Do all until one ends; then end the others."""
    tasks = [asyncio.create_task(duty) for duty in duties]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for error in await ended(tasks):
            raise error
