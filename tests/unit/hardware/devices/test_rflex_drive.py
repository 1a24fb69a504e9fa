"""The adapter of the rFLEX base against the emulated one, in memory and virtual time."""

import asyncio
import contextlib
import logging
import random
from collections.abc import AsyncIterator
from dataclasses import dataclass

import pytest

from robotd.contract.device_status import LinkState
from robotd.core.clock import now_ns
from robotd.core.errors import DeviceError
from robotd.core.pose import STANDSTILL, Twist2
from robotd.hardware.devices.device import PAST_LOOP_S
from robotd.hardware.devices.dialect_options import RflexSettings
from robotd.hardware.devices.rflex_drive import NO_WATCHDOG, RflexDrive
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.transport.transport import Transport
from robotd.hardware.wire.rflex import OtherFrame, RflexWire
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators import emulated_rflex
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.emulators.emulated_rflex import RflexEmulator
from robotd.sim.emulators.paced import Paced
from robotd.sim.physics.noise import NOISELESS
from robotd.sim.robot import SimSettings, SimulatedRobot
from robotd.sim.runtime import connectors
from tests.support.taps import NoTap

SETTINGS = RflexSettings(counts_per_m=emulated_rflex.COUNTS_PER_M, counts_per_rad=emulated_rflex.COUNTS_PER_RAD)
TTL_S = 0.4


@dataclass
class Base:
    device: RflexDrive
    robot: SimulatedRobot
    emulator: RflexEmulator
    lines: list[Transport]
    running: "asyncio.Task[None]"

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
        yield Base(device, robot, emulator, lines, running)
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


PHASES_S = [0.0, 0.003, 0.007, 0.011, 0.017, 0.023, 0.029, 0.037]
"""Of the end, between one set-point and the next: some fall less than 10 ms after an order."""


@pytest.mark.parametrize("twist", [Twist2(0.3, 0.0), Twist2(0.0, 0.5), Twist2(0.3, 0.5)], ids=str)
@pytest.mark.parametrize("phase_s", PHASES_S)
async def test_whatever_ends_it_in_motion_it_was_halted_before_the_line_is_given_up(
    twist: Twist2, phase_s: float
) -> None:
    async with base() as b:
        await b.drive(twist, 1.0)
        await asyncio.sleep(phase_s)
        b.running.cancel()
        await asyncio.wait({b.running})
        assert b.emulator._speeds == [0.0, 0.0]
        await asyncio.sleep(1.0)
        assert b.velocity == (0.0, 0.0)


async def test_the_end_of_a_base_at_rest_is_not_waited_for_longer_than_it_takes_to_see_it() -> None:
    async with base() as b:
        began_ns = now_ns()
        b.running.cancel()
        await asyncio.wait({b.running})
        assert now_ns() - began_ns < 0.11e9


async def test_who_hastens_the_end_has_its_way() -> None:
    async with base() as b:
        await b.drive(Twist2(0.3, 0.5), 1.0)
        began_ns = now_ns()
        b.running.cancel()
        await asyncio.sleep(0.001)
        b.running.cancel()
        await asyncio.wait({b.running})
        assert now_ns() - began_ns < 0.002e9


@pytest.mark.parametrize("phase_s", PHASES_S)
async def test_a_stop_right_after_a_set_point_is_heard_though_it_is_part_of_a_burst(phase_s: float) -> None:
    async with base() as b:
        await b.drive(Twist2(0.3, 0.5), 1.0)
        b.device.set_velocity(Twist2(0.2, 0.3), TTL_S)
        await asyncio.sleep(phase_s)
        b.device.stop_now()
        await asyncio.sleep(0.08)
        assert b.emulator._speeds == [0.0, 0.0]


@pytest.mark.parametrize("phase_s", PHASES_S)
async def test_what_a_thread_writes_while_the_loop_is_stuck_halts_both_axes(
    phase_s: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with base() as b:
        await b.drive(Twist2(0.3, 0.5), 1.0)
        await asyncio.sleep(phase_s)
        clock = b.robot.clocks["drive"]
        now_us = clock.board_us(now_ns() // 1000) + 200_000  # from here on the loop stands still
        monkeypatch.setattr(b.lines[-1], "write_past_loop", lambda data: b.emulator.receive(data, now_us))
        for before in range(4):
            b.device.stop_past_loop(before)
            now_us += round(PAST_LOOP_S * 1e6)
        assert b.emulator._speeds == [0.0, 0.0]


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
