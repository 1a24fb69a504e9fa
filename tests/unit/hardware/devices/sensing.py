"""A vendor rangefinder on a line in memory, with an emulated one at the other end, in virtual time."""

import asyncio
import contextlib
import random
from collections.abc import AsyncIterator
from dataclasses import dataclass, field

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.hardware.devices.catalogue import rangefinder
from robotd.hardware.devices.dialects import RANGEFINDERS as DIALECTS
from robotd.hardware.devices.rangefinder import Rangefinder
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.transport.memory import MemoryEnd, memory_pair
from robotd.hardware.transport.transport import Transport
from robotd.sim.emulators.catalogue import RANGEFINDERS
from robotd.sim.hosting.board_clock import BoardClock
from robotd.sim.hosting.host import HostedBoard, serve
from robotd.sim.physics.plant import ShotAnswer
from tests.support.taps import NoTap


class Wall:
    """A wall somewhere."""

    def __init__(self) -> None:
        self.answer = ShotAnswer(ShotStatus.OK, 1.2345, 60_000, 4_000)
        self.lit = False
        self.shots = 0

    def switch(self, *, on: bool) -> None:
        self.lit = on

    def shoot(self, at_us: int) -> ShotAnswer:
        self.shots += 1
        return self.answer

    def measure(self, at_us: int, pan_rad: float) -> ShotAnswer:
        return self.shoot(at_us)


@dataclass
class Sensor:
    device: Rangefinder
    wall: Wall
    board: HostedBoard
    lines: list[MemoryEnd] = field(default_factory=list)

    def is_lit(self) -> bool:
        return self.wall.lit

    async def until(self, link: LinkState) -> DeviceStatus:
        with self.device.status_changes.subscribe() as changes:
            while self.device.status.link is not link:
                await changes.get()
        return self.device.status


@contextlib.asynccontextmanager
async def sensor(dialect: str, *, greeted: bool = True) -> AsyncIterator[Sensor]:
    wall = Wall()
    ends: asyncio.Queue[Transport] = asyncio.Queue()

    async def connect() -> Transport:
        near, far = memory_pair()
        it.lines.append(near)
        ends.put_nowait(far)
        return near

    settings = DIALECTS[dialect].options(dialect=dialect, range_bias_m=0.01)
    board = RANGEFINDERS[dialect].power_up(wall, 0)
    it = Sensor(rangefinder(settings, Wiring(connect, NoTap(), random.Random(0))), wall, board)
    tasks = [
        asyncio.create_task(serve(board, BoardClock(), ends)),
        asyncio.create_task(it.device.run()),
    ]
    if greeted:
        await it.until(LinkState.READY)
    yield it
    for task in tasks:
        task.cancel()
    await asyncio.wait(tasks)
