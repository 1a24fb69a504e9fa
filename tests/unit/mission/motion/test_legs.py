"""Motion follows odometry, message by message, and never waits for ever."""

import asyncio
import math
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import cast

import pytest

from robotd.core.angles import wrap_rad
from robotd.core.broadcast import Broadcast
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import DeviceError, LinkTimeout
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry, Pose2, Twist2
from robotd.hardware.devices.drive import Drive
from robotd.mission.motion.legs import TurnedSoFar, drive_leg, next_odometry, rotate_to, settle, translate_to, turn_by
from robotd.mission.motion.steering import DrivingSettings

SETTINGS = DrivingSettings()
PERIOD_S = 0.04


class Base:
    """A base without inertia: it has its set-point's velocity until the next report."""

    name = "drive"

    def __init__(self) -> None:
        self.odometry: Broadcast[Odometry] = Broadcast()
        self.pose = IDENTITY
        self.twist = STANDSTILL
        self.told: list[Twist2] = []
        self.is_stuck = False
        self.jitters = False

    def set_velocity(self, twist: Twist2, ttl_s: float) -> None:
        self.told.append(twist)
        self.twist = twist

    async def run(self) -> None:
        while True:
            await asyncio.sleep(PERIOD_S)
            if not self.is_stuck:
                way = Pose2(self.twist.speed_mps * PERIOD_S, 0.0, self.twist.turn_radps * PERIOD_S)
                self.pose = self.pose @ way
            twist = Twist2(0.001, 0.0) if self.jitters else self.twist
            self.odometry.publish(Odometry(now_ns(), self.pose, twist))


@asynccontextmanager
async def base() -> AsyncIterator[tuple[Base, Drive, "asyncio.Task[None]"]]:
    one = Base()
    telling = asyncio.create_task(one.run())
    yield one, cast("Drive", one), telling
    telling.cancel()


@pytest.mark.parametrize("goal_m", [(1.0, 0.0), (-0.5, 0.8), (0.0, -2.0)])
async def test_a_leg_ends_at_its_end_and_at_rest(goal_m: tuple[float, float]) -> None:
    async with base() as (one, drive, _):
        arrived = await drive_leg(drive, *goal_m, SETTINGS)
        assert math.dist((arrived.in_odom.x_m, arrived.in_odom.y_m), goal_m) < 0.05
        assert one.told[-1] == STANDSTILL


async def test_a_leg_of_no_length_moves_nothing() -> None:
    async with base() as (one, drive, _):
        await drive_leg(drive, 0.01, 0.0, SETTINGS)
        assert one.told == []


async def test_it_turns_the_short_way() -> None:
    async with base() as (one, drive, _):
        one.pose = Pose2(0.0, 0.0, 3.0)
        await rotate_to(drive, -3.0, SETTINGS)
        assert all(twist.turn_radps >= 0.0 for twist in one.told)
        assert abs(one.pose.heading_rad + 3.0) < 0.02


@pytest.mark.parametrize("angle_rad", [0.005, 1.5, -1.5, math.pi, -7.0, 20.0])
async def test_it_turns_as_often_round_as_it_should(angle_rad: float) -> None:
    async with base() as (one, drive, _):
        turned = TurnedSoFar()
        end = await turn_by(drive, angle_rad, turned, SETTINGS)
        assert turned.rad == pytest.approx(angle_rad, abs=SETTINGS.heading_tolerance_rad)
        assert abs(wrap_rad(end.in_odom.heading_rad - angle_rad)) <= SETTINGS.heading_tolerance_rad
        assert all(twist.turn_radps * angle_rad >= 0.0 for twist in one.told)


async def test_a_turn_that_was_broken_off_goes_on_with_what_is_left() -> None:
    async with base() as (_, drive, _telling):
        turned = TurnedSoFar()
        turn = turn_by(drive, 9.0, turned, SETTINGS)
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(turn, 4.0)
        assert 3.0 < turned.rad < 5.0
        await turn_by(drive, 9.0, turned, SETTINGS)
        assert turned.rad == pytest.approx(9.0, abs=SETTINGS.heading_tolerance_rad)


async def test_backwards_it_goes_with_its_back_ahead_and_steers_to_the_end() -> None:
    async with base() as (one, drive, _):
        one.pose = Pose2(0.0, 0.0, 0.05)
        end = await translate_to(drive, -1.0, 0.0, SETTINGS, backwards=True)
        assert end.in_odom.distance_m(Pose2(-1.0, 0.0, 0.0)) <= SETTINGS.position_tolerance_m
        assert all(twist.speed_mps <= 0.0 for twist in one.told)
        assert min(twist.speed_mps for twist in one.told) == -SETTINGS.speed_mps


async def test_one_set_point_for_each_message_and_none_without() -> None:
    async with base() as (one, drive, telling):
        driving = asyncio.create_task(drive_leg(drive, 5.0, 0.0, SETTINGS))
        await asyncio.sleep(1.0)
        telling.cancel()
        before = len(one.told)
        with pytest.raises(LinkTimeout, match=r"no odometry for 0\.5 s"):
            await driving
        assert 20 <= before <= 25
        assert len(one.told) == before


async def test_a_base_that_is_stuck_is_noticed() -> None:
    async with base() as (one, drive, _):
        one.is_stuck = True
        began_ns = now_ns()
        with pytest.raises(DeviceError, match="stalled: turn is no nearer"):
            await rotate_to(drive, 1.0, SETTINGS)
        assert now_ns() - began_ns == pytest.approx(SETTINGS.stall_s * NS_PER_S, rel=0.05)


async def test_a_cancelled_motion_says_nothing_more() -> None:
    async with base() as (one, drive, _):
        driving = asyncio.create_task(drive_leg(drive, 5.0, 0.0, SETTINGS))
        await asyncio.sleep(1.0)
        before = len(one.told)
        driving.cancel()
        await asyncio.sleep(1.0)
        assert driving.cancelled()
        assert len(one.told) == before


async def test_settling_takes_as_long_as_it_should_from_when_it_stands() -> None:
    async with base() as (one, drive, _):
        one.jitters = True
        settling = asyncio.create_task(settle(drive, 0.2, SETTINGS))
        await asyncio.sleep(1.0)
        one.jitters = False
        stood = await settling
        assert 1.2 <= stood.time_ns / NS_PER_S <= 1.2 + 3 * PERIOD_S


async def test_standstill_counts_anew_after_each_move() -> None:
    async with base() as (one, drive, _):
        settling = asyncio.create_task(settle(drive, 0.5, SETTINGS))
        await asyncio.sleep(0.3)
        one.jitters = True
        await asyncio.sleep(0.1)
        one.jitters = False
        stood = await settling
        assert 0.9 <= stood.time_ns / NS_PER_S <= 0.9 + 3 * PERIOD_S


async def test_a_base_that_never_stands_is_noticed() -> None:
    async with base() as (one, drive, _):
        one.jitters = True
        with pytest.raises(DeviceError, match="restless: it does not stand still within 3 s"):
            await settle(drive, 0.2, SETTINGS)
        assert 3.0 <= now_ns() / NS_PER_S <= 3.2


async def test_silence_is_bounded() -> None:
    async with base() as (_, drive, telling):
        telling.cancel()
        with pytest.raises(LinkTimeout, match=r"no odometry for 0\.25 s"):
            await next_odometry(drive, 0.25)
