"""The rangefinder's adapter on an emulated board, in memory and virtual time."""

import asyncio
import random
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress

import pytest

from firmware_proto.common import Fault
from firmware_proto.rangefinder import Shoot, Shot, ShotStatus
from robotd.core.clock import now_ns
from robotd.core.errors import TransportError
from robotd.core.reading import ReadingStatus
from robotd.hardware.devices.board_rangefinder import BoardRangefinder
from robotd.hardware.devices.settings import RangefinderSettings
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.tap import NoTap
from robotd.hardware.transport.transport import Transport
from robotd.sim.boards.board import Board
from robotd.sim.laser import LaserSettings
from robotd.sim.noise import NOISELESS
from robotd.sim.robot import SimSettings, SimulatedRobot
from robotd.sim.runtime import connectors
from robotd.sim.world import load_world

MS = 1_000_000


class Rig:
    def __init__(self, board: Board, device: BoardRangefinder, lines: list[Transport]) -> None:
        self.board = board
        self.device = device
        self.lines = lines


@asynccontextmanager
async def rig(*, takes_us: int = 4_000) -> AsyncIterator[Rig]:
    settings = SimSettings(noise=NOISELESS, laser=LaserSettings(takes_us=takes_us))
    robot = SimulatedRobot(load_world("laboratory"), seed=1, settings=settings)
    lines: list[Transport] = []
    async with connectors(robot) as connect:

        async def keep() -> Transport:
            lines.append(await connect["rangefinder"]())
            return lines[-1]

        device = BoardRangefinder(RangefinderSettings(range_bias_m=0.01), Wiring(keep, NoTap(), random.Random(0)))
        task = asyncio.create_task(device.run())
        with device.status_changes.subscribe() as changes:
            while (await changes.get()).link != "ready":
                pass
        await device.arm()
        yield Rig(robot.boards["rangefinder"], device, lines)
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task


async def test_a_shot_has_its_range_with_bias_its_strength_and_its_time() -> None:
    async with rig() as r:
        await r.device.switch_laser(on=True)
        before_ns = now_ns()
        shot = await r.device.shoot(timeout_s=1.0)
        truth_m = r.board._plant._plant.true_range_m()  # type: ignore[attr-defined]  # a Laser on a clock
        assert shot.status is ReadingStatus.OK
        assert shot.range_m == pytest.approx(truth_m + 0.01, abs=0.0006)
        assert abs(shot.time_ns - before_ns) < MS
        assert shot.strength


async def test_a_shot_in_the_dark_is_a_result() -> None:
    async with rig() as r:
        shot = await r.device.shoot(timeout_s=1.0)
        assert (shot.status, shot.range_m) == (ReadingStatus.DEVICE_ERROR, None)


@pytest.mark.parametrize(
    ("code", "status"),
    [
        (ShotStatus.OVER_RANGE, ReadingStatus.MISS),
        (ShotStatus.TOO_NEAR, ReadingStatus.TOO_NEAR),
        (ShotStatus.WEAK, ReadingStatus.WEAK),
        (ShotStatus.NOT_MEASURED, ReadingStatus.NOT_MEASURED),
        (99, ReadingStatus.DEVICE_ERROR),
    ],
)
async def test_each_status_of_the_instrument_has_its_meaning(code: int, status: ReadingStatus) -> None:
    async with rig() as r:
        board = r.board
        board._handlers[Shoot] = lambda request, seq: Shot(board._now_us, 0, 0, code)
        assert (await r.device.shoot(timeout_s=1.0)).status is status


async def test_an_unanswered_shot_is_a_timeout_and_a_lost_line_is_an_error() -> None:
    async with rig(takes_us=50_000) as r:
        await r.device.switch_laser(on=True)
        r.board.take_output = bytes  # type: ignore[method-assign]  # says nothing any more
        shot = await r.device.shoot(timeout_s=0.2)
        assert (shot.status, shot.range_m, shot.strength) == (ReadingStatus.TIMEOUT, None, None)
        shooting = asyncio.create_task(r.device.shoot(timeout_s=0.2))
        await asyncio.sleep(0.01)
        r.lines[-1].close()
        with pytest.raises(TransportError):
            await shooting


async def test_a_refused_shot_is_a_result() -> None:
    async with rig() as r:
        r.board._latch(Fault.KILLED)
        assert (await r.device.shoot(timeout_s=0.2)).status is ReadingStatus.DEVICE_ERROR
