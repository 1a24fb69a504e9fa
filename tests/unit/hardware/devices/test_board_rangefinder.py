"""The rangefinder's adapter on an emulated board, in memory and virtual time."""

import asyncio

import pytest

from firmware_proto import rangefinder_messages as proto
from firmware_proto.common import BoardKind, Kill
from firmware_proto.rangefinder_messages import ShotStatus
from robotd.core.clock import now_ns
from robotd.core.errors import TransportError
from robotd.core.reading import ReadingStatus
from robotd.hardware.wire.board import BoardWire
from robotd.sim.faults.of_frames import frames_of
from robotd.sim.physics.laser import LaserSettings
from robotd.sim.physics.noise import NOISELESS
from robotd.sim.physics.plant import ShotAnswer
from robotd.sim.robot import SimSettings
from tests.support.true_range import true_range_m
from tests.unit.hardware.devices.conftest import rig

pytestmark = pytest.mark.usefixtures("either_firmware")

MS = 1_000_000


async def test_a_shot_has_its_range_with_bias_its_strength_and_its_time() -> None:
    async with rig() as r:
        await r.rangefinder.switch_laser(on=True)
        before_ns = now_ns()
        shot = await r.rangefinder.shoot(timeout_s=1.0)
        truth_m = true_range_m(r.robot)
        assert shot.status is ReadingStatus.OK
        assert shot.range_m == pytest.approx(truth_m + 0.01, abs=0.0006)
        assert abs(shot.time_ns - before_ns) < MS
        assert shot.strength


async def test_a_shot_in_the_dark_is_a_result() -> None:
    async with rig() as r:
        shot = await r.rangefinder.shoot(timeout_s=1.0)
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
        r.robot._laser.shoot = lambda at_us: ShotAnswer(code, 0.0, 0, 1000)  # type: ignore[arg-type,method-assign]  # 99 is none
        await r.rangefinder.switch_laser(on=True)
        assert (await r.rangefinder.shoot(timeout_s=1.0)).status is status


async def test_an_unanswered_shot_is_a_timeout_and_a_lost_line_is_an_error() -> None:
    async with rig(sim=SimSettings(noise=NOISELESS, laser=LaserSettings(takes_us=50_000))) as r:
        await r.rangefinder.switch_laser(on=True)
        board = r.board("rangefinder")
        said = board.take_output
        board.take_output = lambda: _without_shots(said())  # type: ignore[method-assign]  # answers all but that
        shot = await r.rangefinder.shoot(timeout_s=0.2)
        assert (shot.status, shot.range_m, shot.strength) == (ReadingStatus.TIMEOUT, None, None)
        shooting = asyncio.create_task(r.rangefinder.shoot(timeout_s=0.2))
        await asyncio.sleep(0.01)
        r.lines["rangefinder"].close()
        with pytest.raises(TransportError):
            await shooting


def _without_shots(said: bytes) -> bytes:
    wire = BoardWire(BoardKind.RANGEFINDER)
    return b"".join(
        frame
        for frame in frames_of(said)
        if not any(isinstance(one.message, proto.Shot) for one in wire.feed(b"\0" + frame))
    )


async def test_a_shot_on_a_line_that_says_nothing_is_the_lines_fault() -> None:
    async with rig() as r:
        await r.rangefinder.switch_laser(on=True)
        r.board("rangefinder").take_output = bytes  # type: ignore[method-assign]  # says nothing any more
        with pytest.raises(TransportError, match="silent for 1 s"):
            await r.rangefinder.shoot(timeout_s=0.2)


async def test_a_refused_shot_is_a_result() -> None:
    async with rig() as r:
        r.say("rangefinder", Kill())
        assert (await r.rangefinder.shoot(timeout_s=0.2)).status is ReadingStatus.DEVICE_ERROR
