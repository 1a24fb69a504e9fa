"""A scanner as the rangefinder of a head without a motor: what one scan serves, and for how long."""

import asyncio
import contextlib
import math
import random
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass, field

import pytest

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.contract.device_status import LinkState
from robotd.core.errors import DeviceError, TransportError
from robotd.core.reading import ReadingStatus
from robotd.hardware.devices.dialect_options import FixedHeadSettings
from robotd.hardware.devices.fixed_pantilt import FixedPanTilt
from robotd.hardware.devices.gaze import Fan, Gaze
from robotd.hardware.devices.scip_rangefinder import ScipRangefinder
from robotd.hardware.devices.settings import RangefinderSettings
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.transport.memory import MemoryEnd, memory_pair
from robotd.hardware.transport.transport import Transport
from robotd.sim.emulators.emulated_scip import ScipEmulator
from robotd.sim.emulators.paced import Paced
from robotd.sim.hosting.board_clock import BoardClock
from robotd.sim.hosting.host import serve
from robotd.sim.physics.plant import ShotAnswer
from tests.support.taps import NoTap

STEP_RAD = math.tau / 1440


class Room:
    """A room whose walls are as far as the direction says."""

    def __init__(self) -> None:
        self.lit = False
        self.beams = 0
        self.range_m: Callable[[float], float] = lambda pan_rad: 2.0 + pan_rad / 10.0
        self.status = ShotStatus.OK

    def switch(self, *, on: bool) -> None:
        self.lit = on

    def shoot(self, at_us: int) -> ShotAnswer:
        raise AssertionError("nobody turns a head here")

    def measure(self, at_us: int, pan_rad: float) -> ShotAnswer:
        self.beams += 1
        return ShotAnswer(self.status, self.range_m(pan_rad), 100, 1)

    @property
    def scans(self) -> float:
        return self.beams / 1081


@dataclass
class Robot:
    head: FixedPanTilt
    scanner: ScipRangefinder
    room: Room = field(default_factory=Room)
    lines: list[MemoryEnd] = field(default_factory=list)

    def is_lit(self) -> bool:
        return self.room.lit

    async def until(self, link: LinkState) -> None:
        with self.scanner.status_changes.subscribe() as changes:
            while self.scanner.status.link is not link:
                await changes.get()


@contextlib.asynccontextmanager
async def robot(settings: FixedHeadSettings | None = None) -> AsyncIterator[Robot]:
    ends: asyncio.Queue[Transport] = asyncio.Queue()

    async def connect() -> Transport:
        near, far = memory_pair()
        it.lines.append(near)
        ends.put_nowait(far)
        return near

    wiring = Wiring(connect, NoTap(), random.Random(0), Gaze())
    it = Robot(
        FixedPanTilt(settings or FixedHeadSettings(), wiring),
        ScipRangefinder(RangefinderSettings(range_bias_m=0.01), wiring),
    )
    emulator = Paced(ScipEmulator(it.room), LineFormat(115_200))
    tasks = [
        asyncio.create_task(work) for work in (serve(emulator, BoardClock(), ends), it.scanner.run(), it.head.run())
    ]
    await it.until(LinkState.READY)
    await it.head.arm()
    yield it
    for task in tasks:
        task.cancel()
    await asyncio.wait(tasks)


async def test_a_reading_is_that_of_the_direction_aimed_at_which_is_the_nearest_measured() -> None:
    async with robot() as r:
        for pan_rad in (-2.0, 0.0, 1.2345):
            aim = await r.head.aim(pan_rad, 0.0, timeout_s=1.0)
            assert aim.pan_rad == pytest.approx(pan_rad, abs=STEP_RAD / 2)
            assert aim.pan_rad / STEP_RAD == pytest.approx(round(aim.pan_rad / STEP_RAD))
            shot = await r.scanner.shoot(timeout_s=1.0)
            assert shot.range_m == pytest.approx(2.01 + aim.pan_rad / 10.0, abs=0.001)


async def test_one_scan_serves_all_directions_until_the_light_is_switched() -> None:
    async with robot() as r:
        await r.scanner.switch_laser(on=True)
        for number in range(300):
            await r.head.aim(-2.3 + 4.6 * number / 300, 0.0, timeout_s=1.0)
            assert (await r.scanner.shoot(timeout_s=1.0)).status is ReadingStatus.OK
        assert r.room.scans == 1
        r.room.range_m = lambda _: 3.0  # the robot has moved
        await r.scanner.switch_laser(on=True)
        assert (await r.scanner.shoot(timeout_s=1.0)).range_m == pytest.approx(3.01)
        assert r.room.scans == 2


async def test_the_light_burns_only_while_it_scans_and_a_stop_ends_the_scan() -> None:
    async with robot() as r:
        shooting = asyncio.create_task(r.scanner.shoot(timeout_s=1.0))
        await asyncio.sleep(0.01)
        assert r.is_lit()
        r.scanner.stop_now()
        assert (await shooting).status is ReadingStatus.DEVICE_ERROR
        await asyncio.sleep(0.01)
        assert not r.is_lit()
        assert (await r.scanner.shoot(timeout_s=1.0)).status is ReadingStatus.OK
        assert not r.is_lit()


@pytest.mark.parametrize(
    ("status", "reading"),
    [
        (ShotStatus.OVER_RANGE, ReadingStatus.MISS),
        (ShotStatus.TOO_NEAR, ReadingStatus.TOO_NEAR),
        (ShotStatus.WEAK, ReadingStatus.WEAK),
    ],
)
async def test_a_direction_without_a_distance_says_why(status: ShotStatus, reading: ReadingStatus) -> None:
    async with robot() as r:
        r.room.status = status
        assert (await r.scanner.shoot(timeout_s=1.0)).status is reading


async def test_a_scan_that_does_not_come_is_a_reading_that_timed_out() -> None:
    async with robot() as r:
        assert (await r.scanner.shoot(timeout_s=0.1)).status is ReadingStatus.TIMEOUT
        assert (await r.scanner.shoot(timeout_s=1.0)).status is ReadingStatus.OK


async def test_limits_are_what_the_scanner_sees_within_the_settings_as_it_is_mounted() -> None:
    async with robot(FixedHeadSettings(pan_zero_rad=0.5, pan_min_rad=-1.0, tilt_zero_rad=0.1)) as r:
        limits = await r.head.limits()
        assert limits.pan_min_rad == -1.0
        assert limits.pan_max_rad == pytest.approx(0.5 + 0.75 * math.pi)
        aim = await r.head.aim(1.0, 0.0, timeout_s=1.0)
        assert aim.tilt_rad == 0.1
        shot = await r.scanner.shoot(timeout_s=1.0)
        assert shot.range_m == pytest.approx(2.01 + (aim.pan_rad - 0.5) / 10.0, abs=0.001)
        with pytest.raises(DeviceError, match=r"nothing is measured at pan -1\.500"):
            await r.head.aim(-1.5, 0.0, timeout_s=1.0)
        with pytest.raises(DeviceError, match="out_of_range"):
            await r.head.aim(3.1, 0.0, timeout_s=1.0)


async def test_a_direction_beyond_a_half_turn_is_found_from_the_other_side() -> None:
    async with robot() as r:
        assert (await r.head.aim(1.0 + math.tau, 0.0, timeout_s=1.0)).pan_rad == pytest.approx(1.0, abs=STEP_RAD)


async def test_the_head_aims_only_when_armed_and_a_stop_disarms_it() -> None:
    async with robot() as r:
        r.head.stop_now()
        assert not r.head.status.armed
        with pytest.raises(DeviceError, match="not_armed"):
            await r.head.aim(0.0, 0.0, timeout_s=1.0)


async def test_a_head_whose_scanner_nobody_has_heard_of_cannot_say_its_limits() -> None:
    head = FixedPanTilt(FixedHeadSettings(), Wiring(memory_pair, NoTap(), random.Random(0)))  # type: ignore[arg-type]  # never called
    with pytest.raises(TransportError, match="absent"):
        await head.arm()
    with pytest.raises(TransportError, match="has not said yet"):
        await head.limits()


async def test_an_unplugged_scanner_comes_back_and_forgets_its_scan() -> None:
    async with robot() as r:
        assert (await r.scanner.shoot(timeout_s=1.0)).status is ReadingStatus.OK
        r.lines[-1].cut()
        await r.until(LinkState.ABSENT)
        with pytest.raises(TransportError, match="absent"):
            await r.scanner.shoot(timeout_s=1.0)
        await r.until(LinkState.READY)
        assert (await r.scanner.shoot(timeout_s=1.0)).status is ReadingStatus.OK
        assert r.room.scans == 2


def test_the_nearest_direction_of_a_fan() -> None:
    fan = Fan(-1.0, 0.1, 21)
    assert [fan.nearest(direction) for direction in (-1.0, -0.96, 0.049, 1.0)] == [0, 0, 10, 20]
    assert fan.nearest(1.06) is None
    assert fan.nearest(-1.06) is None
    assert fan.last_rad == pytest.approx(1.0)
