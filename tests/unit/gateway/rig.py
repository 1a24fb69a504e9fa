"""A gateway on loopback, before the front of a daemon whose robot is a fake."""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import aiohttp
import pytest
from yarl import URL

from robotd.core.clock import now_ns
from robotd.core.pose import Odometry, Pose2, Twist2
from robotd.gateway.access.roles import Role
from robotd.gateway.access.tokens import TokenFile, Tokens, make_token
from robotd.gateway.composed import gateway
from robotd.gateway.house import House
from robotd.gateway.settings import AccessSettings, GatewaySettings, ListenSettings, RobotSettings, WatchingSettings
from tests.support.console_page import until
from tests.unit.server.conftest import FakeControl, Serving


@dataclass
class GatewayRig:
    """A gateway, its address, a secret of each role, and the robot behind it."""

    house: House
    address: URL
    secrets: dict[str, str]
    control: FakeControl

    @property
    def origin(self) -> dict[str, str]:
        return {"Origin": str(self.address.origin())}

    @contextlib.asynccontextmanager
    async def browser(
        self, role: str = "operator", *, address: URL | None = None
    ) -> AsyncIterator[aiohttp.ClientSession]:
        """A browser that signed in, at another address if something stands before the gateway."""
        at, jar = address or self.address, aiohttp.CookieJar(unsafe=True)
        headers = {"Origin": str(at.origin())}
        async with aiohttp.ClientSession(at, headers=headers, cookie_jar=jar) as session:
            async with session.post("api/session", json={"token": self.secrets[role]}) as answer:
                assert answer.status == 200
            yield session


@contextlib.asynccontextmanager
async def telling(control: FakeControl) -> AsyncIterator[None]:
    """Tell the status as a robot does: often, and whatever happens."""

    async def tell() -> None:
        while True:
            control.events.publish(control.status)
            await asyncio.sleep(0.2)

    task = asyncio.create_task(tell())
    try:
        yield
    finally:
        task.cancel()
        await asyncio.wait((task,))


async def tell_odometry(control: FakeControl) -> None:
    """Tell it as a base does, for an armed one that is silent lets nobody drive."""
    while True:
        control.events.publish(Odometry(now_ns(), Pose2(0.0, 0.0, 0.0), Twist2(0.0, 0.0)))
        await asyncio.sleep(0.2)


Opening = Callable[..., contextlib.AbstractAsyncContextManager[GatewayRig]]


@pytest.fixture
def opening(tmp_path: Path, serving: Serving) -> Opening:
    """``async with opening() as rig``: a robot, its front and a gateway."""

    @contextlib.asynccontextmanager
    async def open_(trusted_proxies: tuple[str, ...] = (), **driving: Any) -> AsyncIterator[GatewayRig]:
        state = tmp_path / "state"
        made = {role.value: make_token(f"some {role}", role, 0.0) for role in Role}
        TokenFile(state / "tokens.json").write(Tokens(tuple(token for _, token in made.values())))
        recordings = tmp_path / "recordings"
        recordings.mkdir()
        settings = GatewaySettings(
            ListenSettings(port=0, allowed_hosts=("robot.lab",), trusted_proxies=trusted_proxies),
            RobotSettings("dusty", str(tmp_path), str(recordings)),
            WatchingSettings(**driving),
            AccessSettings(state_dir=str(state)),
        )
        async with serving() as control, gateway(settings) as running, telling(control):
            house, address = running.house, running.address
            await until(lambda: house.services.fan.snapshot.status)
            yield GatewayRig(house, URL(address), {role: secret for role, (secret, _) in made.items()}, control)

    return open_
