"""The adapter of the rFLEX base against the emulated one, in memory and virtual time."""

import asyncio
import contextlib
import logging
import random
from collections.abc import AsyncIterator
from dataclasses import dataclass

import pytest

from robotd.core.errors import DeviceError
from robotd.core.pose import STANDSTILL, Twist2
from robotd.hardware.devices.device import LinkState
from robotd.hardware.devices.rflex_drive import NO_WATCHDOG, RflexDrive
from robotd.hardware.devices.settings import DriveSettings
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.tap import NoTap
from robotd.hardware.transport.transport import Transport
from robotd.hardware.wire.rflex import OtherFrame, RflexWire
from robotd.sim.emulators import rflex
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.emulators.paced import Paced
from robotd.sim.emulators.rflex import RflexEmulator
from robotd.sim.noise import NOISELESS
from robotd.sim.robot import SimSettings, SimulatedRobot
from robotd.sim.runtime import connectors
from robotd.sim.world import load_world

SETTINGS = DriveSettings(counts_per_m=rflex.COUNTS_PER_M, counts_per_rad=rflex.COUNTS_PER_RAD)
TTL_S = 0.4


@dataclass
class Base:
    device: RflexDrive
    robot: SimulatedRobot
    emulator: RflexEmulator
    lines: list[Transport]

    @property
    def velocity(self) -> tuple[float, float]:
        return self.emulator._plant.velocity

    async def drive(self, twist: Twist2, seconds: float) -> None:
        """Send set-points as odometry comes, as missions do."""
        with self.device.odometry.subscribe() as stream:
            began_ns = (await stream.get()).time_ns
            async for odometry in stream:
                if odometry.time_ns - began_ns > seconds * 1e9:
                    return
                self.device.set_velocity(twist, TTL_S)


@contextlib.asynccontextmanager
async def base() -> AsyncIterator[Base]:
    sim = SimSettings(noise=NOISELESS)
    robot = SimulatedRobot(load_world("laboratory"), 1, sim, dialects=Dialects(drive="rflex"))
    paced = robot.boards["drive"]
    assert isinstance(paced, Paced)
    emulator = paced.device
    assert isinstance(emulator, RflexEmulator)
    lines: list[Transport] = []
    async with connectors(robot) as connects:

        async def connect() -> Transport:
            lines.append(await connects["drive"]())
            return lines[-1]

        device = RflexDrive(SETTINGS, Wiring(connect, NoTap(), random.Random(0)))
        running = asyncio.create_task(device.run())
        with device.status_changes.subscribe() as changes:
            while device.status.link is not LinkState.READY:
                await changes.get()
        await device.arm()
        yield Base(device, robot, emulator, lines)
        running.cancel()
        await asyncio.wait({running})


async def test_it_drives_as_told_and_odometry_says_how_far() -> None:
    async with base() as b:
        await b.drive(Twist2(0.3, 0.0), 2.0)
        assert b.velocity[0] == pytest.approx(0.3, abs=0.003)
        await b.drive(STANDSTILL, 1.5)
        latest = b.device.odometry.latest
        assert latest is not None
        assert latest.twist.is_zero
        gone = b.robot.start.inverse() @ b.robot.truth
        assert latest.in_odom.x_m == pytest.approx(gone.x_m, abs=0.002)
        assert latest.in_odom.x_m > 0.4


async def test_a_stop_halts_both_axes_though_the_controller_drops_bursts() -> None:
    async with base() as b:
        await b.drive(Twist2(0.3, 0.5), 1.0)
        assert min(b.velocity) > 0.1
        b.device.stop_now()
        await asyncio.sleep(1.2)
        assert b.velocity == (0.0, 0.0)
        with pytest.raises(DeviceError, match="arm first"):
            b.device.set_velocity(Twist2(0.1, 0.0), TTL_S)


async def test_a_set_point_ends_in_its_time_by_our_own_timer_and_is_a_fault() -> None:
    async with base() as b:
        await b.drive(Twist2(0.3, 0.0), 1.0)
        await asyncio.sleep(1.5)
        assert b.velocity == (0.0, 0.0)
        assert b.device.status.faults == ("deadman",)


async def test_a_line_that_comes_back_begins_with_a_stop_and_stays_disarmed() -> None:
    async with base() as b:
        await b.drive(Twist2(0.3, 0.0), 1.0)
        b.lines[-1].close()
        await asyncio.sleep(0.1)
        assert b.velocity[0] > 0.1, "nobody can stop this base while its line is down"
        await asyncio.sleep(2.0)
        assert b.device.status.link is LinkState.READY
        assert b.velocity == (0.0, 0.0)
        assert not b.device.status.armed
        assert b.device.status.faults == ()


async def test_nothing_but_halts_follows_a_stop_that_comes_between_the_orders_of_the_two_axes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async with base() as b:
        await asyncio.sleep(0.1)
        written = bytearray()
        write = b.lines[-1].write

        def noted(data: bytes) -> None:
            written.extend(data)
            write(data)

        monkeypatch.setattr(b.lines[-1], "write", noted)
        b.device.set_velocity(Twist2(0.3, 0.5), 10.0)
        await asyncio.sleep(0.005)
        b.device.stop_now()
        written.clear()
        await asyncio.sleep(0.06)
        assert b.emulator._speeds == [0.0, 0.0]
        speeds = [frame.data[1:5] for frame in RflexWire().feed(bytes(written)) if isinstance(frame, OtherFrame)]
        assert speeds
        assert set(speeds) == {bytes(4)}


async def test_a_set_point_that_comes_while_another_is_being_sent_is_not_forgotten() -> None:
    async with base() as b:
        await asyncio.sleep(0.1)
        b.device.set_velocity(Twist2(0.3, 0.5), 10.0)
        await asyncio.sleep(0.005)
        b.device.set_velocity(STANDSTILL, 10.0)
        await asyncio.sleep(0.1)
        assert b.emulator._speeds == [0.0, 0.0]
        assert b.device.status.faults == ()


async def test_that_it_has_no_watchdog_is_said_at_every_connection(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING):
        async with base():
            assert NO_WATCHDOG in caplog.text
