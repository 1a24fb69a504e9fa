"""A heart and its front in one process: the code of two, channels of memory, and sockets that clients can reach."""

import asyncio
import contextlib
from collections.abc import AsyncIterator

from robotd.children.in_process import InProcess
from robotd.children.pings import READY
from robotd.core.together import together
from robotd.front.asked import Heart
from robotd.front.heart_side import LANES, HeartSide
from robotd.front.program import serve_clients
from robotd.server.settings import ServerSettings


@contextlib.asynccontextmanager
async def served(heart: Heart, settings: ServerSettings) -> AsyncIterator[None]:
    """Serve clients for the length of the block; what goes wrong with it is raised there."""
    side = HeartSide(heart, settings)
    front = InProcess(serve_clients, LANES)
    serving = asyncio.create_task(together(side.follow(), side.serve(front.lanes)), name="heart side")
    ready = asyncio.create_task(front.life.receive())
    ended = asyncio.create_task(front.ended())
    try:
        await asyncio.wait((ready, ended), return_when=asyncio.FIRST_COMPLETED)
        assert not ended.done(), ended.result()
        assert bytes(ready.result()).startswith(READY)
        yield
    finally:
        front.kill()
        await ended
        for task in (ready, serving):
            task.cancel()
        await asyncio.gather(serving, ready, return_exceptions=True)
        front.close()
