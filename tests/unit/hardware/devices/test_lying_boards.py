"""One of our boards that says what cannot be: counted, latched, stopped; the daemon goes on."""

import asyncio
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from firmware_proto.common import BoardStatus, Pong
from firmware_proto.drive_messages import DriveReport, OdometryReport
from firmware_proto.framing import RawFrame
from firmware_proto.pantilt_messages import AimReport, Limits
from firmware_proto.rangefinder_messages import Shot
from firmware_proto.schema import Message
from robotd.contract.device_status import LinkState
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import DeviceError
from robotd.core.reading import ReadingStatus
from robotd.hardware.devices.board_device import BoardDevice
from robotd.hardware.devices.credible import IMPLAUSIBLE
from tests.unit.hardware.devices.conftest import Rig, rig

Lie = Callable[[RawFrame], RawFrame]


def lying(message: type[Message], change: Callable[[Any], Any], times: int = 1) -> Lie:
    """Return what changes the next messages of a kind, checksums being right."""
    left = times

    def changed(frame: RawFrame) -> RawFrame:
        nonlocal left
        if frame.type != message.TYPE or not left:
            return frame
        left -= 1
        return RawFrame(frame.type, frame.seq, change(message.from_payload(frame.payload)).to_payload())

    return changed


def with_fields(message: type[Message], times: int = 1, **what: int) -> Lie:
    return lying(message, lambda honest: replace(honest, **what), times)


def tell(r: Rig, device: str, lie: Lie) -> None:
    r.lines[device].lie = lie


def implausible(device: BoardDevice) -> int:
    return dict(device.status.counters)["implausible"]


@pytest.mark.parametrize(
    ("message", "what"),
    [
        (OdometryReport, {"board_us": 2**64 - 1}),
        (OdometryReport, {"board_us": 2**63}),
        (OdometryReport, {"board_us": 0}),
        (OdometryReport, {"translate_counts": 2**31 - 1}),
        (OdometryReport, {"rotate_counts": -(2**31)}),
        (OdometryReport, {"speed_mmps": 32_767}),
        (OdometryReport, {"turn_mradps": -32_768}),
        (DriveReport, {"board_us": 2**64 - 1}),
    ],
)
async def test_one_report_that_cannot_be_is_a_fault_and_what_follows_is_true(
    message: type[Message], what: dict[str, int]
) -> None:
    async with rig() as r:
        await asyncio.sleep(0.5)
        before = r.drive.odometry.latest
        tell(r, "drive", with_fields(message, **what))
        await asyncio.sleep(0.5)
        assert (r.drive.status.faults, r.drive.status.armed) == ((IMPLAUSIBLE,), False)
        assert implausible(r.drive) == 1
        after = r.drive.odometry.latest
        assert before is not None
        assert after is not None
        assert after.in_odom.distance_m(before.in_odom) < 0.01
        assert now_ns() - after.time_ns < 0.1 * NS_PER_S
        with pytest.raises(DeviceError, match="clear first"):
            await r.drive.arm()
        await r.drive.clear_faults()
        assert r.drive.status.faults == ()
        await r.drive.arm()
        await asyncio.sleep(0.5)
        assert (r.drive.status.faults, r.drive.status.armed) == ((), True)


async def test_one_pong_that_lies_by_an_hour_freezes_nothing() -> None:
    async with rig() as r:
        for field in ("board_us", "host_us"):
            for lie_us in (3_600_000_000, -3_600_000_000):
                await asyncio.sleep(3.0)
                tell(r, "drive", shifted(field, lie_us))
                await asyncio.sleep(1.5)
                with r.drive.odometry.subscribe() as stream:
                    for _ in range(10):
                        assert abs(now_ns() - (await stream.get()).time_ns) < 0.1 * NS_PER_S
        assert r.drive.status.faults == ()
        assert implausible(r.drive) == 2  # of those that lie about our own time the round trip is impossible


def shifted(field: str, lie_us: int) -> Lie:
    return lying(Pong, lambda pong: replace(pong, **{field: (getattr(pong, field) + lie_us) % 2**64}))


async def test_a_board_whose_clock_stands_is_found_out() -> None:
    async with rig() as r:
        await asyncio.sleep(1.0)
        stands_us = r.robot.clocks["drive"].board_us(now_ns() // 1000)
        tell(r, "drive", with_fields(OdometryReport, 1000, board_us=stands_us))
        await asyncio.sleep(2.5)
        assert r.drive.status.faults == (IMPLAUSIBLE,)
        assert "falls behind" in r.drive.status.detail


@pytest.mark.parametrize("board_us", [2**64 - 1, 2**50])
async def test_a_status_from_the_future_ends_the_session(board_us: int) -> None:
    async with rig() as r:
        tell(r, "pantilt", with_fields(BoardStatus, board_us=board_us))
        status = await r.wait(r.pantilt, LinkState.ABSENT)
        assert "clock jumped ahead" in status.detail
        await r.wait(r.pantilt, LinkState.READY)
        assert implausible(r.pantilt) == 1


@pytest.mark.parametrize("what", [{"tilt_tenth_mrad": 2**31 - 1}, {"pan_tenth_mrad": -20_000}, {"board_us": 2**63}])
async def test_a_head_that_says_it_rests_where_it_cannot_be_is_not_believed(what: dict[str, int]) -> None:
    async with rig() as r:
        tell(r, "pantilt", with_fields(AimReport, 1000, **what))
        with pytest.raises(DeviceError, match="implausible"):
            await r.pantilt.aim(0.5, 0.0, timeout_s=5.0)
        assert r.pantilt.status.faults == (IMPLAUSIBLE,)


async def test_limits_that_no_head_has_are_a_fault() -> None:
    async with rig() as r:
        tell(r, "pantilt", with_fields(Limits, tilt_min_tenth_mrad=2**31 - 1))
        with pytest.raises(DeviceError, match="implausible"):
            await r.pantilt.limits()
        assert r.pantilt.status.faults == (IMPLAUSIBLE,)


async def test_a_shot_whose_time_cannot_be_fails_and_latches() -> None:
    async with rig() as r:
        await r.rangefinder.switch_laser(on=True)
        tell(r, "rangefinder", with_fields(Shot, board_us=2**64 - 1))
        shot = await r.rangefinder.shoot(timeout_s=1.0)
        assert (shot.status, shot.range_m) == (ReadingStatus.DEVICE_ERROR, None)
        assert now_ns() - shot.time_ns < NS_PER_S
        assert r.rangefinder.status.faults == (IMPLAUSIBLE,)
