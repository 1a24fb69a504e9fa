"""A name like those under /dev/serial/by-id: it goes with the plug, and comes back leading elsewhere."""

import asyncio
import random
from contextlib import suppress
from pathlib import Path

import pytest

from robotd.contract.device_status import LinkState
from robotd.hardware.devices.board_drive import BoardDrive
from robotd.hardware.devices.dialect_options import BoardDriveSettings
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.transport.connector import connector
from robotd.hardware.transport.line_format import LineFormat
from robotd.sim.buildings.world import load_world
from robotd.sim.faults.laid import cables_on_ptys
from robotd.sim.robot import SimulatedRobot
from tests.support.taps import NoTap


async def until(device: BoardDrive, link: LinkState, detail: str = "") -> None:
    async with asyncio.timeout(60.0):
        with device.status_changes.subscribe() as changes:
            while device.status.link is not link or detail not in device.status.detail:
                await changes.get()


@pytest.mark.real_clock
async def test_the_name_is_looked_up_anew_at_each_attempt_and_who_answers_is_asked(tmp_path: Path) -> None:
    async with cables_on_ptys(SimulatedRobot(load_world("office"), 1), tmp_path) as (laid, links):
        connect = connector(links["drive"], LineFormat(115_200))
        drive = BoardDrive(BoardDriveSettings(), Wiring(connect, NoTap(), random.Random(1)))
        running = asyncio.create_task(drive.run())
        await until(drive, LinkState.READY)
        laid["drive"].unplug()
        await until(drive, LinkState.ABSENT, "no such device")
        laid["drive"].exchange(stranger=True)
        await until(drive, LinkState.ABSENT, "the board is a pantilt, not a drive")
        laid["drive"].exchange(stranger=False)
        await until(drive, LinkState.READY)
        assert dict(drive.status.counters)["sessions"] == 2
        assert not drive.status.armed
        running.cancel()
        with suppress(asyncio.CancelledError):
            await running
