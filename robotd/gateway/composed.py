"""Settings to objects to one group of tasks: everything that runs in a gateway has its owner here."""

import asyncio
import logging
import signal
import ssl
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

import zmq.asyncio
from aiohttp import web

from robotd.client import AsyncClient
from robotd.contract.requests import Disarm, MapShow
from robotd.contract.topics import Topic
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.endpoints import Endpoints
from robotd.core.errors import ConfigError, RobotdError, TransportError
from robotd.core.together import together
from robotd.gateway.browser.services import Services
from robotd.gateway.command.asker import Asker
from robotd.gateway.command.stop_line import StopLine
from robotd.gateway.feed.fan_out import FanOut
from robotd.gateway.feed.snapshot import Snapshot
from robotd.gateway.house import House
from robotd.gateway.http.routes import application
from robotd.gateway.metrics.exposition_http import ROUTE as METRICS
from robotd.gateway.settings import GatewaySettings

_IDLE_LOOK_S = 1.0
_BACKLOG = 64
_ON_DEMAND = (Topic.RANK,)
"""Topics that the daemon works for only while somebody listens."""

log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class RunningGateway:
    """A gateway at work."""

    house: House
    address: str
    """Where it serves."""
    duties: "asyncio.Task[NoReturn]"
    """What it does all the time; should it end, so must the gateway: nobody would watch over missions."""


@asynccontextmanager
async def gateway(settings: GatewaySettings) -> AsyncIterator[RunningGateway]:
    """Run a gateway for the length of the block, and yield it.

    Raises:
        TransportError: the address cannot be had.
        ConfigError: the certificate cannot be read.
    """
    endpoints = Endpoints(Path(settings.robot.runtime_dir))
    with zmq.asyncio.Context() as context:
        async with (
            AsyncClient(settings.robot.runtime_dir) as client,
            Asker(context, endpoints) as asker,
            # A socket that nothing else uses: no answer that is long in coming stands before a stop's.
            Asker(context, endpoints) as stopper,
        ):
            fan = FanOut(Snapshot(), lambda: asker.ask(MapShow()))
            services = Services(fan, asker, StopLine(stopper), settings.watching)
            house = House(settings, services)
            async with _served(house) as address:
                duties = together(
                    fan.follow(lambda: client.frames(*(topic for topic in Topic if topic not in _ON_DEMAND))),
                    fan.follow_rank(lambda: client.frames(*_ON_DEMAND)),
                    fan.keep_map(),
                    services.missions.watch(),
                    house.watch_access(),
                    _disarm_idle(services),
                )
                running = asyncio.create_task(duties, name="gateway")
                try:
                    yield RunningGateway(house, address, running)
                finally:
                    running.cancel()
                    await asyncio.gather(running, return_exceptions=True)
                    house.made.forget()
            # Pages that went with their server have ended their missions: that is said before the socket closes.
            await services.stop_line.end()


@asynccontextmanager
async def _served(house: House) -> AsyncIterator[str]:
    """Serve the addresses; hang up on every page in the end, which lets it look for another gateway at once."""
    listen = house.settings.listen
    app = application(house, (METRICS,))
    runner = web.AppRunner(app, access_log=None, shutdown_timeout=1.0, keepalive_timeout=30.0)
    await runner.setup()
    try:
        site = web.TCPSite(runner, listen.host, listen.port, ssl_context=_tls(house.settings), backlog=_BACKLOG)
        try:
            await site.start()
        except OSError as error:
            raise TransportError(f"{listen.host}:{listen.port} cannot be had: {error.strerror or error}") from error
        host, port = runner.addresses[0][:2]
        shown = f"[{host}]" if ":" in str(host) else host
        yield f"{'https' if listen.has_tls else 'http'}://{shown}:{port}/"
    finally:
        for connection in tuple(house.connections):
            connection.finish("the gateway ends")
        await runner.cleanup()


def _tls(settings: GatewaySettings) -> ssl.SSLContext | None:
    if not settings.listen.has_tls:
        return None
    context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
    try:
        context.load_cert_chain(settings.listen.tls_certificate, settings.listen.tls_key)
    except (OSError, ssl.SSLError) as error:
        raise ConfigError(
            f"cannot be used: {error}", file=settings.listen.tls_certificate, key="tls_certificate"
        ) from error
    return context


async def _disarm_idle(services: Services) -> None:
    """Disarm a robot that was armed in a browser and is left standing: a duty."""
    while True:
        await asyncio.sleep(_IDLE_LOOK_S)
        status = services.fan.snapshot.status
        if status is not None and services.idle.accept(status, now_ns() / NS_PER_S):
            log.info("the robot is disarmed: it was armed in the console and stood idle")
            try:
                await services.asker.ask(Disarm())
            except RobotdError as error:
                log.warning("the idle robot could not be disarmed: %s", error)


async def run(settings: GatewaySettings, ready: Callable[[str], None]) -> None:
    """Run a gateway until a signal ends it.

    Raises:
        TransportError, ConfigError: it cannot begin.
    """
    ended = asyncio.Event()
    for one in (signal.SIGTERM, signal.SIGINT):
        asyncio.get_running_loop().add_signal_handler(one, ended.set)
    async with gateway(settings) as running:
        ready(running.address)
        waiting = asyncio.create_task(ended.wait())
        await asyncio.wait((waiting, running.duties), return_when=asyncio.FIRST_COMPLETED)
        waiting.cancel()
        if running.duties.done():
            running.duties.result()
