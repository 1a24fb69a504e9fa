"""A simulated robot in memory, and the three devices that talk to it over lines that can fail."""

import asyncio
import random
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress

from robotd.core.errors import TransportError
from robotd.hardware.devices.board_device import BoardDevice
from robotd.hardware.devices.board_drive import BoardDrive
from robotd.hardware.devices.board_pantilt import BoardPanTilt
from robotd.hardware.devices.board_rangefinder import BoardRangefinder
from robotd.hardware.devices.device import Device, DeviceStatus, LinkState
from robotd.hardware.devices.settings import DriveSettings, PanTiltSettings, RangefinderSettings
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.tap import NoTap
from robotd.hardware.transport.transport import Connect, Transport
from robotd.sim.noise import NOISELESS
from robotd.sim.robot import SimSettings, SimulatedRobot
from robotd.sim.runtime import connectors
from robotd.sim.world import load_world
from tests.unit.hardware.conftest import FaultyLine


class Rig:
    """A simulated robot and the three devices that talk to it."""

    def __init__(self, robot: SimulatedRobot, connect: dict[str, Connect], pantilt: PanTiltSettings) -> None:
        self.robot = robot
        self.lines: dict[str, FaultyLine] = {}
        self._connect = connect
        self.drive = BoardDrive(DriveSettings(), self._wiring("drive"))
        self.pantilt = BoardPanTilt(pantilt, self._wiring("pantilt"))
        self.rangefinder = BoardRangefinder(RangefinderSettings(range_bias_m=0.01), self._wiring("rangefinder"))
        self.devices: tuple[BoardDevice, ...] = (self.drive, self.pantilt, self.rangefinder)

    def _wiring(self, device: str) -> Wiring:
        async def connect() -> Transport:
            self.lines[device] = FaultyLine(await self._connect[device]())
            return self.lines[device]

        return Wiring(connect, NoTap(), random.Random(device))

    async def wait(self, device: Device, link: LinkState) -> DeviceStatus:
        with device.status_changes.subscribe() as changes:
            while device.status.link is not link:
                await changes.get()
        return device.status


@asynccontextmanager
async def rig(
    *, armed: bool = True, sim: SimSettings | None = None, pantilt: PanTiltSettings | None = None
) -> AsyncIterator[Rig]:
    robot = SimulatedRobot(load_world("laboratory"), seed=1, settings=sim or SimSettings(noise=NOISELESS))
    async with connectors(robot) as connect:
        rig = Rig(robot, connect, pantilt or PanTiltSettings())
        tasks = [asyncio.create_task(device.run()) for device in rig.devices]
        for device in rig.devices:
            await rig.wait(device, LinkState.READY)
            if armed:
                await device.arm()
        yield rig
        for task in tasks:
            task.cancel()
            with suppress(asyncio.CancelledError):
                await task


async def nowhere() -> Transport:
    raise TransportError("nowhere")
