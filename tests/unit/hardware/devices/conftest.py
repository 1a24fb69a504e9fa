"""A simulated robot in memory, and the three devices that talk to it over lines that can fail."""

import asyncio
import random
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from importlib.util import find_spec

import pytest

from firmware_proto.framing import RawFrame, encode_frame
from firmware_proto.schema import Message
from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.core.errors import TransportError
from robotd.hardware.devices.board_device import BoardDevice
from robotd.hardware.devices.board_drive import BoardDrive
from robotd.hardware.devices.board_pantilt import BoardPanTilt
from robotd.hardware.devices.board_rangefinder import BoardRangefinder
from robotd.hardware.devices.device import Device
from robotd.hardware.devices.dialect_options import BoardDriveSettings, BoardPanTiltSettings, BoardRangefinderSettings
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.transport.transport import Connect, Transport
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators.catalogue import Dialects, Firmware
from robotd.sim.hosting.host import OwnBoard
from robotd.sim.physics.noise import NOISELESS
from robotd.sim.robot import SimSettings, SimulatedRobot
from robotd.sim.runtime import connectors
from tests.support.own_boards import board_of
from tests.support.taps import NoTap
from tests.unit.hardware.conftest import FaultyLine

BOARDS = Firmware.PYTHON
"""What the firmware of the next rig's boards is written in."""


@pytest.fixture(params=Firmware)
def either_firmware(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a test run on boards whose firmware is Python, and on boards whose firmware is C."""
    if request.param is Firmware.C and find_spec("robotd.sim.firmware._native") is None:
        pytest.skip("there was no C compiler for the firmware")
    monkeypatch.setattr(f"{__name__}.BOARDS", request.param)


class Rig:
    """A simulated robot and the three devices that talk to it."""

    def __init__(self, robot: SimulatedRobot, connect: dict[str, Connect], pantilt: BoardPanTiltSettings) -> None:
        self.robot = robot
        self.lines: dict[str, FaultyLine] = {}
        self._connect = connect
        self.drive = BoardDrive(BoardDriveSettings(), self._wiring("drive"))
        self.pantilt = BoardPanTilt(pantilt, self._wiring("pantilt"))
        self.rangefinder = BoardRangefinder(BoardRangefinderSettings(range_bias_m=0.01), self._wiring("rangefinder"))
        self.devices: tuple[BoardDevice, ...] = (self.drive, self.pantilt, self.rangefinder)

    def _wiring(self, device: str) -> Wiring:
        async def connect() -> Transport:
            self.lines[device] = FaultyLine(await self._connect[device]())
            return self.lines[device]

        return Wiring(connect, NoTap(), random.Random(device))

    def board(self, device: str) -> OwnBoard:
        return board_of(self.robot, device)

    def say(self, device: str, message: Message) -> None:
        """Put a request on the wire that is not the daemon's."""
        self.lines[device].write(encode_frame(RawFrame(message.TYPE, 0xABCD, message.to_payload())))

    async def wait(self, device: Device, link: LinkState) -> DeviceStatus:
        with device.status_changes.subscribe() as changes:
            while device.status.link is not link:
                await changes.get()
        return device.status


@asynccontextmanager
async def rig(
    *, armed: bool = True, sim: SimSettings | None = None, pantilt: BoardPanTiltSettings | None = None
) -> AsyncIterator[Rig]:
    settings = sim or SimSettings(noise=NOISELESS)
    robot = SimulatedRobot(load_world("laboratory"), seed=1, settings=settings, dialects=Dialects(boards=BOARDS))
    async with connectors(robot) as connect:
        rig = Rig(robot, connect, pantilt or BoardPanTiltSettings())
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
