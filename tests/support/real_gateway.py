"""A real gateway in a process of its own, and pages of it that can be cut off."""

import asyncio
import contextlib
import socket
import time
from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path

import aiohttp
from yarl import URL

from robotd.gateway.access.roles import Role
from robotd.gateway.access.tokens import TokenFile, Tokens, make_token
from tests.support.console_page import Page, page_of
from tests.support.real_rig import program_of

GATEWAY = ("-m", "robotd.gateway.program", "--log-level", "error", "--config")
_PATIENCE_S = 120.0


@dataclass(frozen=True, slots=True)
class RealGateway:
    """A process, where it serves, and a secret of an operator."""

    process: asyncio.subprocess.Process
    address: URL
    secret: str

    @contextlib.asynccontextmanager
    async def browser(self, address: URL | None = None) -> AsyncIterator[aiohttp.ClientSession]:
        """A browser that signed in, through another address if there is a relay before the gateway."""
        at = address or self.address
        jar = aiohttp.CookieJar(unsafe=True)
        async with aiohttp.ClientSession(at, headers={"Origin": str(at.origin())}, cookie_jar=jar) as session:
            async with session.post("api/session", json={"token": self.secret}) as answer:
                assert answer.status == 200, await answer.text()
            yield session

    @contextlib.asynccontextmanager
    async def page(self) -> AsyncIterator[Page]:
        """A page of a browser that signed in."""
        async with self.browser() as session, page_of(session) as page:
            yield page


@contextlib.asynccontextmanager
async def real_gateway(directory: Path, runtime_dir: Path) -> AsyncIterator[RealGateway]:
    """Start a gateway before a daemon, and wait until it hears that one; kill it in the end if it still lives."""
    secret, token = make_token("anna", Role.OPERATOR, time.time())
    state, port = directory / "gateway", free_port()
    TokenFile(state / "tokens.json").write(Tokens((token,)))
    file = directory / "robotd-gateway.toml"
    file.write_text(
        f'[listen]\nport = {port}\n[robot]\nname = "dusty"\nruntime_dir = "{runtime_dir}"\n'
        f'recordings = "{directory}"\n[access]\nstate_dir = "{state}"\n'
    )
    async with program_of(*GATEWAY, str(file)) as process:
        address = URL(f"http://127.0.0.1:{port}/")
        await _until_it_hears(address)
        yield RealGateway(process, address, secret)


def free_port() -> int:
    """Return a port that nobody has now."""
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        port: int = one.getsockname()[1]
        return port


async def _until_it_hears(address: URL) -> None:
    async with asyncio.timeout(_PATIENCE_S), aiohttp.ClientSession(address) as session:
        while True:
            with contextlib.suppress(aiohttp.ClientError):
                async with session.get("readyz") as answer:
                    if answer.status == 200:
                        return
            await asyncio.sleep(0.05)


class Relay:
    """What stands between a browser and a gateway: once cut, it carries nothing, and says so to neither."""

    def __init__(self, port: int) -> None:
        self._port = port
        self._is_cut = False
        self._tasks: set[asyncio.Task[None]] = set()

    @contextlib.asynccontextmanager
    async def serving(self) -> AsyncIterator[URL]:
        """Relay for the length of the block, and yield the address."""
        server = await asyncio.start_server(self._accept, "127.0.0.1", 0)
        try:
            yield URL(f"http://127.0.0.1:{server.sockets[0].getsockname()[1]}/")
        finally:
            server.close()
            self.hang_up()
            await asyncio.gather(*self._tasks, return_exceptions=True)

    def cut(self) -> None:
        """Carry nothing from now on."""
        self._is_cut = True

    def hang_up(self) -> None:
        """Hang up on both ends of all that is connected."""
        for task in self._tasks:
            task.cancel()

    async def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        there_reader, there_writer = await asyncio.open_connection("127.0.0.1", self._port)
        for one, other in ((reader, there_writer), (there_reader, writer)):
            task = asyncio.create_task(self._carry(one, other))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)

    async def _carry(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            while data := await reader.read(1 << 16):
                if self._is_cut:
                    await asyncio.Event().wait()
                writer.write(data)
                await writer.drain()
        except ConnectionError:
            pass  # the other end has gone, which is what cables are like
        finally:
            writer.close()
