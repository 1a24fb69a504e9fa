"""The adapter of the distance sensor against the emulated one, in memory and virtual time."""

import asyncio
import contextlib
import random
from collections.abc import AsyncIterator
from dataclasses import dataclass

import pytest

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.contract.device_status import LinkState
from robotd.core.errors import TransportError
from robotd.core.reading import ReadingStatus
from robotd.hardware.devices.dialect_options import DimetixSettings
from robotd.hardware.devices.dimetix_rangefinder import DimetixRangefinder
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.transport.memory import MemoryEnd, memory_pair
from robotd.hardware.transport.transport import Transport
from robotd.sim.emulators.emulated_dimetix import DimetixEmulator
from robotd.sim.hosting.board_clock import BoardClock
from robotd.sim.hosting.host import serve
from robotd.sim.physics.plant import ShotAnswer
from tests.support.taps import NoTap


class Wall:
    """A wall somewhere."""

    def __init__(self) -> None:
        self.answer = ShotAnswer(ShotStatus.OK, 1.2345, 0, 80_000)
        self.lit = False

    def switch(self, *, on: bool) -> None:
        self.lit = on

    def shoot(self, at_us: int) -> ShotAnswer:
        return self.answer


@dataclass
class Sensor:
    device: DimetixRangefinder
    wall: Wall
    lines: list[MemoryEnd]

    def is_lit(self) -> bool:
        return self.wall.lit


@contextlib.asynccontextmanager
async def sensor(device_id: int = 0) -> AsyncIterator[Sensor]:
    wall, lines = Wall(), list[MemoryEnd]()
    ends: asyncio.Queue[Transport] = asyncio.Queue()

    async def connect() -> Transport:
        near, far = memory_pair()
        lines.append(near)
        ends.put_nowait(far)
        return near

    settings = DimetixSettings(device_id=device_id, range_bias_m=0.01)
    device = DimetixRangefinder(settings, Wiring(connect, NoTap(), random.Random(0)))
    tasks = [
        asyncio.create_task(serve(DimetixEmulator(wall, device_id), BoardClock(), ends)),
        asyncio.create_task(device.run()),
    ]
    await until(device, LinkState.READY)
    yield Sensor(device, wall, lines)
    for task in tasks:
        task.cancel()
    await asyncio.wait(tasks)


async def until(device: DimetixRangefinder, link: LinkState) -> None:
    with device.status_changes.subscribe() as changes:
        while device.status.link is not link:
            await changes.get()


@pytest.mark.parametrize("device_id", [0, 7])
async def test_one_command_is_one_reading_to_a_tenth_of_a_millimetre(device_id: int) -> None:
    async with sensor(device_id) as s:
        shot = await s.device.shoot(timeout_s=1.0)
        assert shot.status is ReadingStatus.OK
        assert shot.range_m == pytest.approx(1.2445)


@pytest.mark.parametrize(
    ("happens", "status"),
    [
        (ShotStatus.OVER_RANGE, ReadingStatus.WEAK),
        (ShotStatus.SATURATED, ReadingStatus.SATURATED),
        (ShotStatus.AMBIENT, ReadingStatus.AMBIENT),
        (ShotStatus.DEVICE_ERROR, ReadingStatus.DEVICE_ERROR),
    ],
)
async def test_a_reading_that_failed_is_a_result_with_its_status(happens: ShotStatus, status: ReadingStatus) -> None:
    async with sensor() as s:
        s.wall.answer = ShotAnswer(happens, 0.0, 0, 80_000)
        shot = await s.device.shoot(timeout_s=1.0)
        assert (shot.status, shot.range_m) == (status, None)


async def test_a_dark_target_times_out_and_is_never_taken_for_the_next_reading() -> None:
    async with sensor() as s:
        s.wall.answer = ShotAnswer(ShotStatus.OK, 9.0, 0, 2_000_000)
        assert (await s.device.shoot(timeout_s=0.5)).status is ReadingStatus.TIMEOUT
        s.wall.answer = ShotAnswer(ShotStatus.OK, 2.0, 0, 80_000)
        assert (await s.device.shoot(timeout_s=0.5)).range_m == pytest.approx(2.01)


async def test_the_light_goes_on_and_off_and_a_stop_puts_it_out() -> None:
    async with sensor() as s:
        await s.device.switch_laser(on=True)
        assert s.is_lit()
        await s.device.switch_laser(on=False)
        assert not s.is_lit()
        await s.device.switch_laser(on=True)
        s.device.stop_now()
        await asyncio.sleep(0.1)
        assert not s.is_lit()


async def test_an_unplugged_sensor_is_absent_and_comes_back() -> None:
    async with sensor() as s:
        s.lines[-1].close()
        await until(s.device, LinkState.ABSENT)
        with pytest.raises(TransportError, match="absent"):
            await s.device.shoot(timeout_s=1.0)
        await until(s.device, LinkState.READY)
        assert (await s.device.shoot(timeout_s=1.0)).status is ReadingStatus.OK
