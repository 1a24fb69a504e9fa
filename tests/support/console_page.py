"""What a page of the console does, without a browser: it answers questions, asks, and remembers what it was told."""

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator, Callable
from typing import Any

import aiohttp

PATIENCE_S = 60.0


async def until(is_so: Callable[[], object]) -> None:
    async with asyncio.timeout(PATIENCE_S):
        while not is_so():  # noqa: ASYNC110  # nobody tells: it is seen from outside
            await asyncio.sleep(0.01)


class Page:
    """What a page does: answers questions, asks, and remembers what it was told."""

    def __init__(self, socket: aiohttp.ClientWebSocketResponse) -> None:
        self.socket = socket
        self.is_hung = False
        self.texts: list[dict[str, Any]] = []
        self.frames: list[bytes] = []
        self.number = 0
        self.told = asyncio.Event()

    async def listen(self) -> None:
        async for message in self.socket:
            if message.type is aiohttp.WSMsgType.BINARY:
                self.frames.append(message.data)
            else:
                said = json.loads(message.data)
                self.texts.append(said)
                if said["type"] == "question" and not self.is_hung:
                    await self.socket.send_json({"type": "answer", "n": said["n"]})
            self.told.set()

    async def until(self, is_so: Callable[[], Any]) -> Any:
        async with asyncio.timeout(PATIENCE_S):
            while not (found := is_so()):
                self.told.clear()
                await self.told.wait()
        return found

    async def ask(self, kind: str, **fields: Any) -> dict[str, Any]:
        self.number += 1
        number = self.number
        await self.socket.send_json({"type": kind, "id": number, **fields})
        found = await self.until(lambda: [one for one in self.texts if one.get("id") == number])
        answer: dict[str, Any] = found[0]
        return answer

    def last(self, kind: str) -> dict[str, Any] | None:
        return next((one for one in reversed(self.texts) if one["type"] == kind), None)


@contextlib.asynccontextmanager
async def page_of(session: aiohttp.ClientSession) -> AsyncIterator[Page]:
    async with session.ws_connect("api/ws", protocols=("robotd.console.v1",)) as socket:
        page = Page(socket)
        listening = asyncio.create_task(page.listen())
        await page.until(lambda: page.last("hello"))
        yield page
        await socket.close()
        await listening
