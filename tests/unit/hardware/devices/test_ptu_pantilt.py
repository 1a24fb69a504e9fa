"""The adapter of the pan/tilt unit against the emulated one, in memory and virtual time."""

import asyncio
import contextlib
import math
import random
from collections.abc import AsyncIterator
from dataclasses import dataclass

import pytest

from robotd.contract.device_status import LinkState
from robotd.core.errors import DeviceError, LinkTimeout, TransportError
from robotd.hardware.devices.pantilt import LOST_STEPS
from robotd.hardware.devices.ptu_pantilt import PtuPanTilt
from robotd.hardware.devices.settings import PanTiltSettings
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.transport.transport import Transport
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.emulators.emulated_ptu import PtuEmulator
from robotd.sim.emulators.paced import Paced
from robotd.sim.physics.noise import NOISELESS
from robotd.sim.robot import SimSettings, SimulatedRobot
from robotd.sim.runtime import connectors
from tests.support.taps import NoTap

STEP_RAD = math.radians(185.142857 / 3600)


@dataclass
class Unit:
    device: PtuPanTilt
    emulator: PtuEmulator
    lines: list[Transport]


@contextlib.asynccontextmanager
async def unit(*, armed: bool = True, settings: PanTiltSettings | None = None) -> AsyncIterator[Unit]:
    sim = SimSettings(noise=NOISELESS)
    robot = SimulatedRobot(load_world("laboratory"), 1, sim, dialects=Dialects(pantilt="ptu"))
    paced = robot.boards["pantilt"]
    assert isinstance(paced, Paced)
    emulator = paced.device
    assert isinstance(emulator, PtuEmulator)
    lines: list[Transport] = []
    async with connectors(robot) as connects:

        async def connect() -> Transport:
            lines.append(await connects["pantilt"]())
            return lines[-1]

        device = PtuPanTilt(settings or PanTiltSettings(), Wiring(connect, NoTap(), random.Random(0)))
        running = asyncio.create_task(device.run())
        await until(device, LinkState.READY)
        if armed:
            await device.arm()
        yield Unit(device, emulator, lines)
        running.cancel()
        await asyncio.wait({running})


async def until(device: PtuPanTilt, link: LinkState) -> None:
    with device.status_changes.subscribe() as changes:
        while device.status.link is not link:
            await changes.get()


async def test_it_turns_to_whole_steps_and_says_where_it_came_to_rest() -> None:
    async with unit(settings=PanTiltSettings(pan_zero_rad=0.1)) as u:
        aim = await u.device.aim(0.5, -0.2, timeout_s=5.0)
        assert aim.pan_rad == pytest.approx(0.5, abs=STEP_RAD / 2)
        assert aim.tilt_rad == pytest.approx(-0.2, abs=STEP_RAD / 2)
        assert u.emulator._at("P") == round(0.4 / STEP_RAD)


async def test_its_limits_are_those_of_the_unit_in_the_robot_frame() -> None:
    async with unit(settings=PanTiltSettings(pan_zero_rad=0.1)) as u:
        limits = await u.device.limits()
        assert limits.pan_min_rad == pytest.approx(0.1 - math.radians(159), abs=STEP_RAD)
        assert limits.tilt_max_rad == pytest.approx(math.radians(31), abs=STEP_RAD)


async def test_nothing_turns_unarmed_or_beyond_the_limits() -> None:
    async with unit(armed=False) as u:
        with pytest.raises(DeviceError, match="arm first"):
            await u.device.aim(0.5, 0.0, timeout_s=5.0)
        await u.device.arm()
        with pytest.raises(DeviceError, match="Maximum allowable Pan position is"):
            await u.device.aim(3.1, 0.0, timeout_s=5.0)
        assert u.emulator._at("P") == 0


async def test_a_head_too_slow_is_halted_and_disarmed() -> None:
    async with unit() as u:
        with pytest.raises(LinkTimeout, match="still turning"):
            await u.device.aim(2.5, 0.0, timeout_s=0.1)
        await asyncio.sleep(1.0)
        assert 0 < u.emulator._at("P") < round(2.0 / STEP_RAD)
        assert not u.device.status.armed


async def test_a_stop_halts_it_and_gives_the_aim_up() -> None:
    async with unit() as u:
        aiming = asyncio.create_task(u.device.aim(2.5, 0.0, timeout_s=5.0))
        await asyncio.sleep(0.1)
        u.device.stop_now()
        with pytest.raises(DeviceError, match=r"stopped|arm first"):
            await aiming
        await asyncio.sleep(1.0)
        assert u.emulator._at("P") < round(2.0 / STEP_RAD)
        with pytest.raises(DeviceError, match="arm first"):
            await u.device.aim(0.0, 0.0, timeout_s=5.0)
        await u.device.arm()
        assert (await u.device.aim(0.0, 0.0, timeout_s=5.0)).pan_rad == 0.0


async def test_a_stop_that_is_lost_on_the_wire_is_said_again() -> None:
    async with unit() as u:
        with pytest.MonkeyPatch.context() as lost:
            lost.setattr(u.lines[-1], "write_urgent", lambda _: None)
            aiming = asyncio.create_task(u.device.aim(2.5, 0.0, timeout_s=5.0))
            await asyncio.sleep(0.1)
            u.device.stop_now()
        with pytest.raises(DeviceError, match=r"stopped|arm first"):
            await aiming
        await asyncio.sleep(0.2)
        halted = u.emulator._at("P")
        assert 0 < halted < round(2.5 / STEP_RAD)
        await asyncio.sleep(3.0)
        assert u.emulator._at("P") == halted
        await u.device.arm()
        assert (await u.device.aim(0.0, 0.0, timeout_s=5.0)).pan_rad == 0.0


async def test_a_head_that_met_its_stop_refuses_to_aim_until_it_is_reset() -> None:
    async with unit() as u:
        u.emulator.hit_limit("P")
        u.emulator._end()
        await asyncio.sleep(1.5)  # it is heard with the next poll
        assert u.device.status.detail == "the pan axis met its stop: it must be reset"
        assert u.device.status.armed
        for _ in range(2):
            with pytest.raises(DeviceError, match="lost_steps: the pan axis met its stop"):
                await u.device.aim(0.3, 0.0, timeout_s=5.0)
        await u.device.reset()
        assert u.device.status.detail == ""
        assert (await u.device.aim(0.3, 0.0, timeout_s=5.0)).pan_rad == pytest.approx(0.3, abs=STEP_RAD)


async def test_a_head_that_meets_its_stop_on_its_way_is_halted_there() -> None:
    async with unit() as u:
        aiming = asyncio.create_task(u.device.aim(2.5, 0.0, timeout_s=5.0))
        await asyncio.sleep(0.1)
        u.emulator.hit_limit("T")
        with pytest.raises(DeviceError) as caught:
            await aiming
        assert caught.value.code == LOST_STEPS
        await asyncio.sleep(1.0)
        assert 0 < u.emulator._at("P") < round(2.0 / STEP_RAD)
        await u.device.reset()
        assert (await u.device.aim(0.3, 0.0, timeout_s=5.0)).pan_rad == pytest.approx(0.3, abs=STEP_RAD)


async def test_clearing_resets_it_too() -> None:
    async with unit() as u:
        u.emulator.hit_limit("P")
        await asyncio.sleep(1.5)
        await u.device.clear_faults()
        await u.device.arm()
        assert (await u.device.aim(0.3, 0.0, timeout_s=5.0)).pan_rad == pytest.approx(0.3, abs=STEP_RAD)


async def test_an_unplugged_unit_comes_back_disarmed() -> None:
    async with unit() as u:
        u.lines[-1].close()
        await until(u.device, LinkState.ABSENT)
        with pytest.raises(TransportError, match="absent"):
            await u.device.aim(0.0, 0.0, timeout_s=5.0)
        await until(u.device, LinkState.READY)
        assert not u.device.status.armed


async def test_a_unit_that_falls_silent_is_lost() -> None:
    async with unit() as u:
        u.emulator.take_output = bytes  # type: ignore[method-assign]  # says nothing any more
        await until(u.device, LinkState.ABSENT)
        assert "no answer" in u.device.status.detail


async def test_a_refused_reset_clears_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    async with unit() as u:
        u.emulator.hit_limit("P")
        await asyncio.sleep(1.5)
        monkeypatch.setattr(u.emulator, "_reset", lambda: u.emulator._refuse("R", "Illegal Command Entered"))
        with pytest.raises(DeviceError, match="refused: to reset"):
            await u.device.clear_faults()
        assert "must be reset" in u.device.status.detail
        await u.device.arm()
        with pytest.raises(DeviceError, match="lost_steps"):
            await u.device.aim(0.0, 0.0, timeout_s=5.0)
