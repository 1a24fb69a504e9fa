"""What becomes of a mission that somebody started in the console: each ending tried again and again.

A trial yields after how many seconds the stop had arrived on every wire of a real daemon, from the moment at which the
page or its gateway was harmed, or STOP was pressed.
"""

import asyncio
import contextlib
import os
import signal
from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import dataclass

from robotd.client import AsyncClient
from robotd.core.clock import NS_PER_S, now_ns
from tests.support.console_page import Page, page_of
from tests.support.real_gateway import RealGateway, Relay, real_gateway
from tests.support.real_rig import Rig, armed

_UNDER_WAY_S = 0.5
_STARVING_S = 1.0
"""How long a gateway has starved when somebody presses STOP."""


@dataclass(frozen=True, slots=True)
class Driving:
    """A page that drives, and what is behind it."""

    gateway: RealGateway
    page: Page
    relay: Relay


Harm = Callable[[Driving], Awaitable[None]]


async def _pressed(it: Driving) -> None:
    await it.page.socket.send_json({"type": "stop", "id": 0})


async def _hung(it: Driving) -> None:
    it.page.is_hung = True


async def _closed(it: Driving) -> None:
    await it.page.socket.close()


async def _offline(it: Driving) -> None:
    it.relay.cut()


async def _killed(it: Driving) -> None:
    it.gateway.process.kill()


async def _stopped(it: Driving) -> None:
    it.gateway.process.send_signal(signal.SIGSTOP)


@dataclass(frozen=True, slots=True)
class Ending:
    """One way for it to end."""

    name: str
    harm: Harm
    within_s: float
    """By when the stop must have arrived."""
    because: str
    spoils_gateway: bool = False
    """Whether the next trial needs another gateway."""


LOOK_S = 0.35
"""A question each 0.25 s, and a look at the answers each 0.05 s."""
ENDINGS = (
    Ending("STOP pressed", _pressed, 0.05, "a line of its own"),
    Ending("page closed", _closed, 0.1, "the socket says so"),
    Ending("page hung", _hung, 1.5 + LOOK_S, "watching.patience_s: no question is answered"),
    Ending("page offline", _offline, 1.5 + LOOK_S, "the same: nothing comes, and nobody hangs up"),
    Ending("gateway killed", _killed, 0.55, "the daemon's lease", spoils_gateway=True),
    Ending("gateway stopped", _stopped, 0.55, "the daemon's lease", spoils_gateway=True),
)
STARVED = "gateway starved"


async def ending(what: Ending, rig: Rig, trials: int) -> AsyncIterator[float]:
    """Yield how long after the harm the robot was told to stop [s], for each trial."""
    async with rig.daemon(), AsyncClient(rig.runtime_dir) as client:
        left = trials
        while left:
            async with real_gateway(rig.directory, rig.runtime_dir) as gateway:
                for _ in range(1 if what.spoils_gateway else left):
                    yield await _trial(rig, client, gateway, what.harm)
                    left -= 1


async def starved(rig: Rig, trials: int) -> AsyncIterator[float]:
    """The gateway gets what others leave of busy processors, and STOP is pressed; 0 if the lease was quicker.

    Who measures keeps the processors busy: an idle one starves nobody.
    """
    async with rig.daemon(), AsyncClient(rig.runtime_dir) as client:
        for _ in range(trials):
            async with real_gateway(rig.directory, rig.runtime_dir) as gateway:
                yield await _trial(rig, client, gateway, _starve_and_press, _STARVING_S)


async def _starve_and_press(it: Driving) -> None:
    os.sched_setscheduler(it.gateway.process.pid, os.SCHED_IDLE, os.sched_param(0))
    await asyncio.sleep(_STARVING_S)
    await _pressed(it)


async def _trial(rig: Rig, client: AsyncClient, gateway: RealGateway, harm: Harm, harm_takes_s: float = 0.0) -> float:
    await armed(client)
    async with _driving(gateway) as it:
        started = await it.page.ask("mission", cmd="scan", args={})
        assert started["type"] == "result", started
        await asyncio.sleep(_UNDER_WAY_S)
        rig.expect_stops()
        harmed_ns = now_ns() + round(harm_takes_s * NS_PER_S)
        await harm(it)
        return max(0.0, (await rig.stopped_ns() - harmed_ns) / NS_PER_S)


@contextlib.asynccontextmanager
async def _driving(gateway: RealGateway) -> AsyncIterator[Driving]:
    relay = Relay(int(gateway.address.port or 0))
    async with relay.serving() as address, gateway.browser(address) as session, page_of(session) as page:
        yield Driving(gateway, page, relay)
        relay.hang_up()  # who was harmed does not answer a farewell
