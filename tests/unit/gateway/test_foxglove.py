"""What the robot tells reaches Foxglove's app live, by the rules of everybody else: a token, or an address for once."""

import asyncio
import contextlib
import json
import struct
from collections.abc import AsyncIterator
from typing import Any

import aiohttp
import pytest

from robotd.core.clock import now_ns
from robotd.core.errors import ServerError
from robotd.core.pose import Odometry, Pose2, Twist2
from robotd.gateway.access.tickets import VALID_S, Tickets
from robotd.gateway.browser.foxglove_protocol import MOST_SUBSCRIPTIONS, SUBPROTOCOLS, Subscriptions, message
from tests.unit.gateway.rig import GatewayRig, Opening
from tests.unit.server.conftest import stored_map

PATIENCE_S = 20.0


class App:
    """What Foxglove's app does, as far as it concerns us."""

    def __init__(self, socket: aiohttp.ClientWebSocketResponse) -> None:
        self.socket = socket
        self.channels: dict[str, dict[str, Any]] = {}

    async def next(self) -> dict[str, Any] | tuple[int, dict[str, Any]]:
        """Return the next text, or a message's subscription and content."""
        async with asyncio.timeout(PATIENCE_S):
            heard = await self.socket.receive()
        if heard.type is aiohttp.WSMsgType.BINARY:
            kind, subscription, _ = struct.unpack_from("<BIQ", heard.data)
            assert kind == 1
            return subscription, json.loads(heard.data[13:])
        said: dict[str, Any] = json.loads(heard.data)
        for channel in said.get("channels", ()):
            self.channels[channel["topic"]] = channel
        return said

    async def until_there_is(self, topic: str) -> None:
        while topic not in self.channels:
            await self.next()

    async def subscribe(self, topic: str, number: int) -> None:
        one = {"id": number, "channelId": self.channels[topic]["id"]}
        await self.socket.send_json({"op": "subscribe", "subscriptions": [one]})

    async def message(self) -> tuple[int, dict[str, Any]]:
        while isinstance(heard := await self.next(), dict):
            pass
        return heard


@contextlib.asynccontextmanager
async def app_of(rig: GatewayRig, path: str = "foxglove", **headers: str) -> AsyncIterator[App]:
    async with (
        aiohttp.ClientSession(rig.address, headers=headers) as session,
        session.ws_connect(path, protocols=SUBPROTOCOLS) as socket,
    ):
        yield App(socket)


def bearer(rig: GatewayRig, role: str = "viewer") -> str:
    return f"Bearer {rig.secrets[role]}"


def at(x_m: float) -> Odometry:
    return Odometry(now_ns(), Pose2(x_m, 0.0, 0.0), Twist2(0.0, 0.0))


@pytest.mark.real_clock
async def test_an_app_is_told_what_there_is_and_what_it_wants(opening: Opening) -> None:
    async with opening() as rig, app_of(rig, Authorization=bearer(rig)) as app:
        assert (await app.next())["op"] == "serverInfo"  # type: ignore[call-overload]  # a text comes first
        rig.control.events.publish(at(1.5))
        await app.until_there_is("/tf")
        channel = app.channels["/tf"]
        assert (channel["schemaName"], channel["encoding"]) == ("foxglove.FrameTransforms", "json")
        assert json.loads(channel["schema"])["title"] == "foxglove.FrameTransforms"
        await app.subscribe("/tf", 7)
        number, content = await app.message()
        assert (number, content["transforms"][1]["translation"]["x"]) == (7, 1.5)


@pytest.mark.real_clock
async def test_who_subscribes_late_has_the_map_at_once_and_whole_after_a_change(opening: Opening) -> None:
    whole = stored_map("office", 3)
    async with opening() as rig, app_of(rig, Authorization=bearer(rig)) as app:
        rig.control.events.publish(whole)
        await app.until_there_is("/map")
        await app.subscribe("/map", 1)
        _, content = await app.message()
        assert (content["column_count"], content["cell_size"]["x"]) == (whole.spec.cols, whole.spec.resolution_m)


@pytest.mark.real_clock
async def test_an_address_lets_in_once_whatever_page_it_is_pasted_into(opening: Opening) -> None:
    async with opening() as rig:
        async with rig.browser("viewer") as session, session.post("api/foxglove") as answer:
            path = (await answer.json())["path"]
        async with app_of(rig, path, Origin="https://app.foxglove.dev") as app:
            assert (await app.next())["op"] == "serverInfo"  # type: ignore[call-overload]  # a text comes first
            file = rig.house.token_file
            file.write(file.read().without("some viewer"))
            assert (await app.socket.receive()).type in {aiohttp.WSMsgType.CLOSE, aiohttp.WSMsgType.TEXT}
            async with asyncio.timeout(PATIENCE_S):
                while not app.socket.closed:
                    await app.socket.receive()
        for again in (path, "foxglove/nobody", "foxglove"):
            with pytest.raises(aiohttp.WSServerHandshakeError, match="401"):
                async with app_of(rig, again, Origin=str(rig.address.origin())):
                    pass
        with pytest.raises(aiohttp.WSServerHandshakeError, match="403"):
            async with app_of(rig, Origin="https://app.foxglove.dev"):
                pass


@pytest.mark.real_clock
async def test_an_app_that_wants_to_command_is_told_no_and_one_that_floods_is_hung_up_on(opening: Opening) -> None:
    async with opening() as rig, app_of(rig, Authorization=bearer(rig, "operator")) as app:
        await app.socket.send_json({"op": "advertise", "channels": []})
        while (said := await app.next()) and not (isinstance(said, dict) and said["op"] == "status"):
            pass
        with contextlib.suppress(ConnectionError):
            for _ in range(60):
                await app.socket.send_json({"op": "unsubscribe", "subscriptionIds": [1]})
        async with asyncio.timeout(PATIENCE_S):
            while not app.socket.closed:
                await app.socket.receive()
        assert rig.control.calls == []


def test_subscriptions_are_bounded_and_may_be_given_up() -> None:
    held = Subscriptions()
    many = [{"id": n, "channelId": 3} for n in range(MOST_SUBSCRIPTIONS)]
    assert held.take(json.dumps({"op": "subscribe", "subscriptions": many})) == [3] * MOST_SUBSCRIPTIONS
    with pytest.raises(ServerError, match="up to 256"):
        held.take('{"op": "subscribe", "subscriptions": [{"id": 999, "channelId": 3}]}')
    held.take('{"op": "unsubscribe", "subscriptionIds": [0]}')
    assert held.of(3) == list(range(1, MOST_SUBSCRIPTIONS))
    for bad in ("", "[]", '{"op": "subscribe"}', '{"op": "subscribe", "subscriptions": [{"id": -1, "channelId": 1}]}'):
        with pytest.raises(ServerError):
            held.take(bad)


def test_a_message_is_bytes_as_the_specification_has_them() -> None:
    assert message(5, 0x0102, b"{}") == bytes([1, 5, 0, 0, 0, 2, 1, 0, 0, 0, 0, 0, 0]) + b"{}"


def test_a_ticket_is_for_one_use_and_soon() -> None:
    tickets: Tickets[str] = Tickets()
    early, late = tickets.issue("anna", 0.0), tickets.issue("ben", 0.0)
    assert (tickets.use(early, 1.0), tickets.use(early, 1.0)) == ("anna", None)
    assert tickets.use(late, VALID_S) is None
    first = tickets.issue("first", 0.0)
    for _ in range(32):
        tickets.issue("more", 0.0)
    assert tickets.use(first, 0.0) is None
