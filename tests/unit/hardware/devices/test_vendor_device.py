"""What arming, clearing and stopping promise, whatever comes between: a device that answers when a test lets it."""

import asyncio
import contextlib
import random
from collections.abc import AsyncIterator
from typing import NoReturn

import pytest

from robotd.contract.device_status import LinkState
from robotd.core.errors import DeviceError, LinkTimeout, TransportError
from robotd.hardware.devices.vendor_device import VendorDevice
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.dialogue import Dialogue, Heard
from robotd.hardware.transport.memory import MemoryEnd, memory_pair
from robotd.hardware.transport.transport import Transport
from robotd.hardware.wire.lw20 import Lw20Answer, Lw20Wire
from tests.support.taps import NoTap


class Thing(VendorDevice[Lw20Answer]):
    """Is enabled by ``on``, and acknowledges by ``ack``."""

    NAME = "pantilt"
    STOP = b"stop\n"

    async def _greet(self, dialogue: Dialogue[Lw20Answer]) -> None:
        dialogue.post(self.STOP)

    async def _attend(self, dialogue: Dialogue[Lw20Answer]) -> NoReturn:
        await dialogue.until_lost()

    async def _enable(self, dialogue: Dialogue[Lw20Answer]) -> None:
        await dialogue.ask(b"on\n", lambda answer: answer.name == "on", timeout_s=1.0)

    async def _acknowledge(self, dialogue: Dialogue[Lw20Answer]) -> None:
        await dialogue.ask(b"ack\n", lambda answer: answer.name == "ack", timeout_s=1.0, despite_stops=True)

    def _report(self, heard: Heard[Lw20Answer]) -> None:
        if heard.message.name == "fault":
            self._latch(heard.message.text)


class Rig:
    def __init__(self) -> None:
        self.fars: list[MemoryEnd] = []
        self.device = Thing(Lw20Wire(), Wiring(self._connect, NoTap(), random.Random(0)))

    async def _connect(self) -> Transport:
        near, far = memory_pair()
        self.fars.append(far)
        return near

    async def until(self, link: LinkState) -> None:
        with self.device.status_changes.subscribe() as changes:
            while self.device.status.link is not link:
                await changes.get()

    async def heard(self) -> bytes:
        """Return what came since last asked, once things have settled."""
        await asyncio.sleep(0.1)
        return await self.fars[-1].read()

    def say(self, text: str) -> None:
        self.fars[-1].write(text.encode() + b"\n")


@contextlib.asynccontextmanager
async def rig() -> AsyncIterator[Rig]:
    it = Rig()
    running = asyncio.create_task(it.device.run())
    await it.until(LinkState.READY)
    assert await it.heard() == b"stop\n"
    yield it
    running.cancel()
    await asyncio.wait({running})


async def test_it_is_armed_once_it_said_so() -> None:
    async with rig() as r:
        arming = asyncio.create_task(r.device.arm())
        assert await r.heard() == b"on\n"
        assert not r.device.status.armed
        r.say("on:1")
        await arming
        assert r.device.status.armed


async def test_a_stop_while_arming_is_the_last_word() -> None:
    async with rig() as r:
        arming = asyncio.create_task(r.device.arm())
        assert await r.heard() == b"on\n"
        r.device.stop_now()
        r.say("on:1")
        with pytest.raises(DeviceError, match="stopped"):
            await arming
        assert (await r.heard()).endswith(b"stop\n")
        assert not r.device.status.armed


async def test_arming_that_is_not_answered_ends_with_a_stop() -> None:
    async with rig() as r:
        arming = asyncio.create_task(r.device.arm())
        assert await r.heard() == b"on\n"
        with pytest.raises(LinkTimeout):
            await arming
        assert await r.heard() == b"stop\n"


async def test_arming_that_is_cancelled_ends_with_a_stop() -> None:
    async with rig() as r:
        arming = asyncio.create_task(r.device.arm())
        assert await r.heard() == b"on\n"
        arming.cancel()
        await asyncio.wait({arming})
        assert await r.heard() == b"stop\n"
        assert not r.device.status.armed


async def test_a_line_lost_while_arming_leaves_it_disarmed_when_it_comes_back() -> None:
    async with rig() as r:
        arming = asyncio.create_task(r.device.arm())
        assert await r.heard() == b"on\n"
        r.fars[-1].cut()
        with pytest.raises(TransportError):
            await arming
        await r.until(LinkState.ABSENT)
        await r.until(LinkState.READY)
        assert not r.device.status.armed
        assert await r.heard() == b"stop\n"


async def test_a_fault_while_arming_is_latched_and_it_is_not_armed() -> None:
    async with rig() as r:
        arming = asyncio.create_task(r.device.arm())
        assert await r.heard() == b"on\n"
        r.say("fault:bumper\non:1")
        with pytest.raises(DeviceError):
            await arming
        assert r.device.status.faults == ("bumper",)
        assert not r.device.status.armed
        with pytest.raises(DeviceError, match="bumper latched: clear first"):
            await r.device.arm()


async def test_a_fault_that_comes_while_others_are_cleared_is_not_cleared_with_them() -> None:
    async with rig() as r:
        r.say("fault:bumper")
        assert await r.heard() == b"stop\n"
        clearing = asyncio.create_task(r.device.clear_faults())
        assert await r.heard() == b"stop\nack\n"
        r.say("fault:battery\nack:1")
        with pytest.raises(DeviceError, match="while clearing"):
            await clearing
        assert r.device.status.faults == ("bumper", "battery")
        clearing = asyncio.create_task(r.device.clear_faults())
        await r.heard()
        r.say("ack:1")
        await clearing
        assert not r.device.status.faults


async def test_a_lost_line_is_noticed_at_once_latches_nothing_and_forgets_no_fault() -> None:
    async with rig() as r:
        r.say("fault:bumper")
        assert await r.heard() == b"stop\n"
        r.fars[-1].cut()
        await r.until(LinkState.ABSENT)
        assert r.device.status.faults == ("bumper",)
        with pytest.raises(TransportError, match="absent"):
            await r.device.clear_faults()
        await r.until(LinkState.READY)
        assert r.device.status.faults == ("bumper",)
