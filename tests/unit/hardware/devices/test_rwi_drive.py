"""The adapter of the RWI base against the emulated one, in memory and virtual time."""

import asyncio
import contextlib
import random
from collections.abc import AsyncIterator
from dataclasses import dataclass

import pytest

from robotd.contract.device_status import LinkState
from robotd.core.errors import DeviceError
from robotd.core.pose import STANDSTILL, Twist2
from robotd.hardware.devices.rwi_drive import RwiDrive
from robotd.hardware.devices.settings import DriveSettings
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.tap import Direction
from robotd.hardware.transport.transport import Transport
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators import rwi
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.emulators.paced import Paced
from robotd.sim.emulators.rwi import RwiEmulator
from robotd.sim.physics.noise import NOISELESS
from robotd.sim.robot import SimSettings, SimulatedRobot
from robotd.sim.runtime import connectors

SETTINGS = DriveSettings(counts_per_m=rwi.COUNTS_PER_M, counts_per_rad=rwi.COUNTS_PER_RAD)
TTL_S = 0.4


class Tape:
    """What went to the base."""

    def __init__(self) -> None:
        self.sent = bytearray()

    def bytes_passed(self, device: str, direction: Direction, time_ns: int, data: bytes) -> None:
        if direction is Direction.TO_BOARD:
            self.sent += data

    def line_broke(self, device: str, time_ns: int, reason: str) -> None:
        pass

    def line_changed(self, device: str, time_ns: int, *, up: bool) -> None:
        """Of no interest here."""

    def since(self, mark: int) -> list[str]:
        return [one for one in bytes(self.sent[mark:]).decode().split("\r") if one not in {"", "TW", "RW", "BV"}]


@dataclass
class Base:
    device: RwiDrive
    robot: SimulatedRobot
    emulator: RwiEmulator
    tape: Tape

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
async def base(*, armed: bool = True) -> AsyncIterator[Base]:
    robot = SimulatedRobot(
        load_world("laboratory"), 1, SimSettings(noise=NOISELESS), dialects=Dialects(drive="rwi-ascii")
    )
    paced, tape = robot.boards["drive"], Tape()
    assert isinstance(paced, Paced)
    emulator = paced.device
    assert isinstance(emulator, RwiEmulator)
    async with connectors(robot) as connects:

        async def connect() -> Transport:
            return await connects["drive"]()

        device = RwiDrive(SETTINGS, Wiring(connect, tape, random.Random(0)))
        running = asyncio.create_task(device.run())
        with device.status_changes.subscribe() as changes:
            while device.status.link is not LinkState.READY:
                await changes.get()
        if armed:
            await device.arm()
        yield Base(device, robot, emulator, tape)
        running.cancel()
        await asyncio.wait({running})


async def test_it_drives_as_told_and_odometry_says_how_far() -> None:
    async with base() as b:
        await b.drive(Twist2(0.3, 0.0), 2.0)
        assert b.velocity[0] == pytest.approx(0.3, abs=0.001)
        await b.drive(STANDSTILL, 1.5)
        latest = b.device.odometry.latest
        assert latest is not None
        assert latest.twist.is_zero
        gone = b.robot.start.inverse() @ b.robot.truth
        assert latest.in_odom.x_m == pytest.approx(gone.x_m, abs=0.002)
        assert latest.in_odom.x_m > 0.4


async def test_it_turns_counter_clockwise_for_a_positive_rate() -> None:
    async with base() as b:
        await b.drive(Twist2(0.0, 0.5), 1.0)
        await b.drive(STANDSTILL, 1.0)
        latest = b.device.odometry.latest
        assert latest is not None
        assert latest.in_odom.heading_rad == pytest.approx(
            (b.robot.start.inverse() @ b.robot.truth).heading_rad, abs=0.01
        )
        assert latest.in_odom.heading_rad > 0.2


async def test_a_reversal_stops_first_and_goes_on_with_the_next_set_point() -> None:
    async with base() as b:
        await b.drive(Twist2(0.2, 0.0), 0.5)
        mark = len(b.tape.sent)
        b.device.set_velocity(Twist2(-0.2, 0.0), TTL_S)
        assert b.tape.since(mark) == ["WD 66", "TH"]
        mark = len(b.tape.sent)
        b.device.set_velocity(Twist2(-0.2, 0.0), TTL_S)
        assert b.tape.since(mark) == ["WD 66", "TV 1554", "T-"]


async def test_silence_of_the_host_stops_the_base_by_its_own_watchdog_and_is_a_fault() -> None:
    async with base() as b:
        await b.drive(Twist2(0.3, 0.0), 1.0)
        await asyncio.sleep(1.2)
        assert b.velocity == (0.0, 0.0)
        assert b.device.status.faults == ("deadman",)
        with pytest.raises(DeviceError, match="clear first"):
            await b.device.arm()
        await b.device.clear_faults()
        await b.device.arm()
        await b.drive(Twist2(0.1, 0.0), 0.5)
        assert b.velocity[0] > 0.0


async def test_nothing_moves_unarmed_or_after_a_stop() -> None:
    async with base(armed=False) as b:
        with pytest.raises(DeviceError, match="arm first"):
            b.device.set_velocity(Twist2(0.1, 0.0), TTL_S)
        await b.device.arm()
        await b.drive(Twist2(0.3, 0.0), 0.5)
        b.device.stop_now()
        assert b.device.status.link is LinkState.READY
        await asyncio.sleep(1.0)
        assert b.velocity == (0.0, 0.0)
        assert b.device.status.link is LinkState.READY
        with pytest.raises(DeviceError, match="arm first"):
            b.device.set_velocity(Twist2(0.1, 0.0), TTL_S)


async def test_a_base_that_moves_though_nobody_may_let_it_is_told_to_stop_again() -> None:
    async with base() as b:
        b.device.stop_now()
        await asyncio.sleep(0.2)
        b.emulator._obey("TV", 3000)
        b.emulator._obey("T+", None)
        await asyncio.sleep(1.0)
        assert b.velocity == (0.0, 0.0)


async def test_bump_switches_are_a_fault_and_say_where() -> None:
    async with base() as b:
        b.emulator._say("%BS FFFB")
        await asyncio.sleep(0.2)
        assert b.device.status.faults == ("bumper",)
        readout = b.device.readouts.latest
        assert readout is not None
        assert readout.bumpers_rad == pytest.approx((-1.178,), abs=0.001)


async def test_a_bump_before_the_first_voltage_tells_no_voltage() -> None:
    async with base() as b:
        await asyncio.sleep(0.5)
        b.device.readouts.forget()  # as at its beginning; it is asked for the voltage every half minute
        b.emulator._say("%BS FFFB")
        await asyncio.sleep(0.2)
        readout = b.device.readouts.latest
        assert readout is not None
        assert (readout.battery_v, len(readout.bumpers_rad)) == (None, 1)


@pytest.mark.parametrize(("event", "fault"), [("%BLO", "battery"), ("%TERR 1", "servo"), ("%RC 2", "current")])
async def test_what_the_base_complains_of_is_a_fault(event: str, fault: str) -> None:
    async with base() as b:
        b.emulator._say(event)
        await asyncio.sleep(0.2)
        assert b.device.status.faults == (fault,)


async def test_the_battery_is_read_in_volts() -> None:
    async with base() as b:
        await asyncio.sleep(0.5)
        readout = b.device.readouts.latest
        assert readout is not None
        assert readout.battery_v == pytest.approx(25.6, abs=0.1)


async def test_a_servo_error_is_acknowledged_by_clear_and_the_base_runs_again() -> None:
    async with base() as b:
        b.emulator.fail()
        await asyncio.sleep(0.2)
        assert b.device.status.faults == ("servo",)
        await b.device.clear_faults()
        await b.device.arm()
        await b.drive(Twist2(0.2, 0.0), 1.0)
        assert b.velocity[0] > 0.1
