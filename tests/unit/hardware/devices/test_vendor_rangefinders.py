"""The adapters of vendor rangefinders against emulated devices."""

import asyncio

import pytest

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.contract.device_status import LinkState
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import TransportError
from robotd.core.reading import ReadingStatus
from robotd.sim.emulators import emulated_lw20, emulated_lwnx
from robotd.sim.emulators.catalogue import RANGEFINDERS
from robotd.sim.emulators.emulated_tfmini import TfminiEmulator
from robotd.sim.emulators.paced import Paced
from robotd.sim.physics.plant import ShotAnswer
from tests.unit.hardware.devices.sensing import sensor

LIGHTWARE = ("lw20", "lwnx")
each_dialect = pytest.mark.parametrize("dialect", [*LIGHTWARE, "disto"])


@each_dialect
async def test_one_command_is_one_reading(dialect: str) -> None:
    async with sensor(dialect) as s:
        await s.device.switch_laser(on=True)
        shot = await s.device.shoot(timeout_s=1.0)
        assert shot.status is ReadingStatus.OK
        assert shot.range_m == pytest.approx(1.2445, abs=0.006)
        assert shot.strength == (91 if dialect == "lwnx" else None)


@each_dialect
async def test_the_light_is_off_once_greeted_goes_on_and_a_stop_puts_it_out(dialect: str) -> None:
    async with sensor(dialect) as s:
        assert not s.is_lit()
        await s.device.switch_laser(on=True)
        assert s.is_lit()
        s.device.stop_now()
        await asyncio.sleep(0.1)
        assert not s.is_lit()


@pytest.mark.parametrize("dialect", LIGHTWARE)
async def test_the_first_message_after_power_up_is_lost_and_it_is_found_all_the_same(dialect: str) -> None:
    began_ns = now_ns()
    async with sensor(dialect) as s:
        assert s.device.status.link is LinkState.READY
        assert now_ns() - began_ns < 0.5 * NS_PER_S


@pytest.mark.parametrize("dialect", LIGHTWARE)
async def test_a_lost_signal_says_nothing_of_the_room(dialect: str) -> None:
    async with sensor(dialect) as s:
        s.wall.answer = ShotAnswer(ShotStatus.OVER_RANGE, 0.0, 0, 4_000)
        shot = await s.device.shoot(timeout_s=1.0)
        assert (shot.status, shot.range_m) == (ReadingStatus.WEAK, None)


@pytest.mark.parametrize("dialect", LIGHTWARE)
@pytest.mark.parametrize("distance_m", [130.0, 160.0, 230.0, 250.0, 0.0])
async def test_flat_distances_beyond_its_reach_are_lost_signals(dialect: str, distance_m: float) -> None:
    async with sensor(dialect) as s:
        s.wall.answer = ShotAnswer(ShotStatus.OK, distance_m, 60_000, 4_000)
        shot = await s.device.shoot(timeout_s=1.0)
        assert (shot.status, shot.range_m) == (ReadingStatus.WEAK, None)


@pytest.mark.parametrize(
    ("dialect", "attribute"), [("lw20", (emulated_lw20, "_PRODUCT")), ("lwnx", (emulated_lwnx, "_NAME"))]
)
async def test_another_device_is_not_used(
    monkeypatch: pytest.MonkeyPatch, dialect: str, attribute: tuple[object, str]
) -> None:
    monkeypatch.setattr(*attribute, "p:SF45,1.0" if dialect == "lw20" else b"SF45".ljust(16, b"\0"))
    async with sensor(dialect, greeted=False) as s:
        await s.until(LinkState.CONNECTING)
        status = await s.until(LinkState.ABSENT)
        assert "expected one of LW20, SF20, got 'SF45" in status.detail
        with pytest.raises(TransportError, match="absent"):
            await s.device.shoot(timeout_s=1.0)


@pytest.mark.parametrize("dialect", [*LIGHTWARE, "disto", "dimetix", "tfmini-s"])
async def test_an_unplugged_device_is_absent_at_once_and_comes_back(dialect: str) -> None:
    async with sensor(dialect) as s:
        await asyncio.sleep(0.7)
        began_ns = now_ns()
        s.lines[-1].cut()
        await s.until(LinkState.ABSENT)
        assert now_ns() - began_ns < 0.01 * NS_PER_S
        await s.until(LinkState.READY)
        await s.device.switch_laser(on=True)
        assert (await s.device.shoot(timeout_s=1.0)).status is ReadingStatus.OK


@each_dialect
async def test_a_stop_while_a_reading_is_awaited_ends_it_as_a_failed_reading(dialect: str) -> None:
    async with sensor(dialect) as s:
        await s.device.switch_laser(on=True)
        shooting = asyncio.create_task(s.device.shoot(timeout_s=1.0))
        await asyncio.sleep(0)
        s.device.stop_now()
        assert (await shooting).status is ReadingStatus.DEVICE_ERROR
        await s.device.switch_laser(on=True)
        assert (await s.device.shoot(timeout_s=1.0)).status is ReadingStatus.OK


async def test_a_stream_that_begins_again_is_ended_again() -> None:
    async with sensor("tfmini-s") as s:
        assert isinstance(s.board, Paced)
        emulator = s.board.device
        assert isinstance(emulator, TfminiEmulator)
        await asyncio.sleep(0.1)
        assert not emulator._streams
        emulator._streams, emulator._next_us = True, None  # as after a moment without power
        await asyncio.sleep(3.0)
        assert not emulator._streams
        assert (await s.device.shoot(timeout_s=1.0)).status is ReadingStatus.OK


async def test_a_tfmini_of_the_first_generation_is_read_from_its_stream() -> None:
    async with sensor("tfmini") as s:
        s.wall.answer = ShotAnswer(ShotStatus.OK, 1.23, 900, 4_000)
        await s.device.switch_laser(on=True)
        shot = await s.device.shoot(timeout_s=1.0)
        assert (shot.status, shot.strength) == (ReadingStatus.OK, 900)
        assert shot.range_m == pytest.approx(1.24)
        began_ns = now_ns()
        s.wall.answer = ShotAnswer(ShotStatus.OK, 3.21, 900, 4_000)
        assert (await s.device.shoot(timeout_s=1.0)).range_m == pytest.approx(3.22)
        assert now_ns() - began_ns < 0.05 * NS_PER_S
        s.wall.answer = ShotAnswer(ShotStatus.OVER_RANGE, 0.0, 0, 4_000)
        assert (await s.device.shoot(timeout_s=1.0)).status is ReadingStatus.MISS
        await asyncio.sleep(5.0)
        assert dict(s.device.status.counters)["sessions"] == 1


async def test_a_first_tfmini_that_falls_silent_is_lost() -> None:
    async with sensor("tfmini") as s:
        assert isinstance(s.board, Paced)
        emulator = s.board.device
        assert isinstance(emulator, TfminiEmulator)
        emulator._speaks = False
        assert (await s.device.shoot(timeout_s=1.0)).status is ReadingStatus.TIMEOUT
        assert "silent for 1 s" in (await s.until(LinkState.ABSENT)).detail


async def test_a_first_tfmini_in_place_of_another_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(RANGEFINDERS, "tfmini-plus", RANGEFINDERS["tfmini"])
    async with sensor("tfmini-plus", greeted=False) as s:
        await s.until(LinkState.CONNECTING)
        status = await s.until(LinkState.ABSENT)
        assert 'a TFmini of the first generation (dialect = "tfmini")' in status.detail
