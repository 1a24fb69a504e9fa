"""The adapter of two Dynamixel servos against emulated ones: what they latch ends with a reboot, and nothing less."""

import asyncio
import contextlib
import random
from collections.abc import AsyncIterator
from dataclasses import dataclass

import pytest

from robotd.contract.device_status import LinkState
from robotd.core.errors import DeviceError
from robotd.hardware.devices.dialect_options import DynamixelSettings
from robotd.hardware.devices.dynamixel_pantilt import DynamixelPanTilt
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.transport.transport import Transport
from robotd.hardware.wire.dynamixel import Instruction
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.emulators.emulated_dynamixel import DynamixelEmulator
from robotd.sim.emulators.paced import Paced
from robotd.sim.physics.noise import NOISELESS
from robotd.sim.robot import SimSettings, SimulatedRobot
from robotd.sim.runtime import connectors
from tests.support.taps import NoTap

PAN, TILT = 1, 2
OVERLOADED, OVERHEATED = 0x20, 0x04


@dataclass
class Servos:
    device: DynamixelPanTilt
    emulator: DynamixelEmulator
    lines: list[Transport]


@contextlib.asynccontextmanager
async def servos(*, hardware_error: int = 0) -> AsyncIterator[Servos]:
    """Power them up, with one that shut down before if there is an error."""
    sim = SimSettings(noise=NOISELESS)
    robot = SimulatedRobot(load_world("laboratory"), 1, sim, dialects=Dialects(pantilt="dynamixel"))
    paced = robot.boards["pantilt"]
    assert isinstance(paced, Paced)
    emulator = paced.device
    assert isinstance(emulator, DynamixelEmulator)
    if hardware_error:
        emulator.shut_down(TILT, hardware_error)
    lines: list[Transport] = []
    async with connectors(robot) as connects:

        async def connect() -> Transport:
            lines.append(await connects["pantilt"]())
            return lines[-1]

        device = DynamixelPanTilt(DynamixelSettings(), Wiring(connect, NoTap(), random.Random(0)))
        running = asyncio.create_task(device.run())
        with device.status_changes.subscribe() as changes:
            while device.status.link is not LinkState.READY:
                await changes.get()
        yield Servos(device, emulator, lines)
        running.cancel()
        await asyncio.wait({running})


async def test_an_overloaded_servo_is_a_fault_that_clear_ends_by_a_reboot() -> None:
    async with servos() as s:
        await s.device.arm()
        s.emulator.shut_down(PAN, OVERLOADED)
        with pytest.raises(DeviceError):
            await s.device.aim(0.5, 0.0, timeout_s=5.0)
        assert (s.device.status.faults, s.device.status.armed) == (("hardware",), False)
        await s.device.clear_faults()
        assert s.device.status.faults == ()
        await s.device.arm()
        readback = await s.device.aim(0.5, 0.0, timeout_s=5.0)
        assert readback.pan_rad == pytest.approx(0.5, abs=0.02)
        assert dict(s.device.status.counters)["sessions"] == 1


async def test_servos_that_shut_down_before_they_were_found_are_found_and_named() -> None:
    async with servos(hardware_error=OVERLOADED | OVERHEATED) as s:
        assert s.device.status.faults == ("hardware",)
        assert "servo 2: overheated, overloaded" in s.device.status.detail
        with pytest.raises(DeviceError, match="clear first"):
            await s.device.arm()
        await s.device.clear_faults()
        await s.device.arm()


async def test_what_is_still_wrong_after_the_reboot_is_not_cleared(monkeypatch: pytest.MonkeyPatch) -> None:
    async with servos() as s:
        s.emulator.shut_down(TILT, OVERHEATED)
        await asyncio.sleep(1.0)
        assert s.device.status.faults == ("hardware",)
        obey = s.emulator._obey

        def obey_hot(order: Instruction) -> None:
            obey(order)
            s.emulator.shut_down(TILT, OVERHEATED)

        monkeypatch.setattr(s.emulator, "_obey", obey_hot)
        with pytest.raises(DeviceError, match="servo 2, rebooted: overheated"):
            await s.device.clear_faults()
        assert s.device.status.faults == ("hardware",)


async def test_without_a_shutdown_nothing_is_rebooted() -> None:
    async with servos() as s:
        await s.device.arm()
        s.device._latch("somebody")
        await s.device.clear_faults()
        assert s.emulator._boots_until_us == {PAN: 0, TILT: 0}


async def test_a_stop_that_is_lost_on_the_wire_is_said_again() -> None:
    async with servos() as s:
        await s.device.arm()
        with pytest.MonkeyPatch.context() as lost:
            lost.setattr(s.lines[-1], "write_urgent", lambda _: None)
            s.device.stop_now()
        assert s.emulator._torque == {PAN: 1, TILT: 1}
        await asyncio.sleep(0.7)
        assert s.emulator._torque == {PAN: 0, TILT: 0}
        assert not s.device.status.armed
        for _ in range(20):  # arming again is no such case, whenever the servos are looked at
            await s.device.arm()
            await asyncio.sleep(0.37)
            assert s.emulator._torque == {PAN: 1, TILT: 1}
            s.device.stop_now()
