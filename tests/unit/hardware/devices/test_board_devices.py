"""The three adapters on emulated boards, in memory and virtual time."""

import asyncio
import math
import random
from contextlib import suppress
from dataclasses import replace
from typing import TypeVar

import pytest

from firmware_proto.common import Arm, BoardState, Fault
from firmware_proto.pantilt_messages import Aim, AimReadback, AimReport, Motion, ReadAim
from firmware_proto.schema import REPLY
from robotd.contract.device_status import LinkState
from robotd.core.broadcast import Broadcast
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import DeviceError, LinkTimeout, TransportError
from robotd.core.pose import STANDSTILL, Odometry, Twist2
from robotd.hardware.devices.board_drive import BoardDrive
from robotd.hardware.devices.board_pantilt import BoardPanTilt
from robotd.hardware.devices.board_rangefinder import BoardRangefinder
from robotd.hardware.devices.dialect_options import BoardDriveSettings, BoardPanTiltSettings, BoardRangefinderSettings
from robotd.hardware.devices.drive import Drive
from robotd.hardware.devices.pantilt import PanTilt
from robotd.hardware.devices.rangefinder import Rangefinder
from robotd.hardware.devices.wiring import Wiring
from robotd.sim.physics.noise import NOISELESS
from robotd.sim.physics.steppers import StepperSettings
from robotd.sim.robot import SimSettings
from tests.support.taps import NoTap
from tests.unit.hardware.conftest import lose
from tests.unit.hardware.devices.conftest import nowhere, rig

pytestmark = pytest.mark.usefixtures("either_firmware")

T = TypeVar("T")
MS = 1_000_000


async def next_of(broadcast: Broadcast[T]) -> T:
    with broadcast.subscribe() as stream:
        return await stream.get()


async def drive_for(drive: BoardDrive, twist: Twist2, seconds: float) -> Odometry:
    """Keep a set-point alive by odometry, then stand."""
    with drive.odometry.subscribe() as stream:
        began = await stream.get()
        async for now in stream:
            if now.time_ns - began.time_ns > seconds * NS_PER_S:
                break
            drive.set_velocity(twist, 0.5)
        drive.set_velocity(STANDSTILL, 0.5)
        async for now in stream:
            if now.twist.is_zero:
                return now
    raise AssertionError


# Every device


def test_the_adapters_are_what_the_mission_expects() -> None:
    def accept(drive: Drive, pantilt: PanTilt, rangefinder: Rangefinder) -> None:
        """Only mypy calls this in earnest."""

    wiring = Wiring(nowhere, NoTap(), random.Random(0))
    accept(
        BoardDrive(BoardDriveSettings(), wiring),
        BoardPanTilt(BoardPanTiltSettings(), wiring),
        BoardRangefinder(BoardRangefinderSettings(), wiring),
    )


async def test_devices_come_up_ready_and_disarmed() -> None:
    async with rig(armed=False) as r:
        for device in r.devices:
            status = device.status
            assert (status.link, status.armed, status.faults, status.detail) == (LinkState.READY, False, (), "")
            assert dict(status.counters)["sessions"] == 1


async def test_arming_reaches_the_board_and_the_status() -> None:
    async with rig(armed=False) as r:
        await r.drive.arm()
        assert (r.drive.status.armed, r.board("drive").state.name) == (True, "ARMED")


async def test_stop_now_disarms_and_the_status_follows_the_board() -> None:
    async with rig() as r:
        with r.drive.status_changes.subscribe() as changes:
            r.drive.stop_now()
            assert not (await changes.get()).armed
        assert r.board("drive").state is BoardState.CONFIGURED


async def test_a_stop_that_gets_lost_is_said_again_until_the_board_has_heard_it() -> None:
    async with rig() as r:
        r.lines["drive"].garbled_stops = 3
        r.drive.stop_now()
        await asyncio.sleep(0.3)
        assert (r.drive.status.armed, r.board("drive").state.name) == (False, "CONFIGURED")
        await r.drive.arm()
        await asyncio.sleep(0.3)
        assert (r.drive.status.armed, r.board("drive").state.name) == (True, "ARMED")


@pytest.mark.parametrize("was_armed_before_it_was_lost", [False, True])
async def test_a_board_that_somebody_else_armed_is_stopped(was_armed_before_it_was_lost: bool) -> None:
    async with rig(armed=was_armed_before_it_was_lost) as r:
        if was_armed_before_it_was_lost:
            r.lines["drive"].close()
            await r.wait(r.drive, LinkState.ABSENT)
            await r.wait(r.drive, LinkState.READY)
        r.say("drive", Arm())
        await asyncio.sleep(0.1)
        assert r.board("drive").state is BoardState.CONFIGURED


async def test_an_absent_device_refuses_everything_but_stop() -> None:
    async with rig() as r:
        r.lines["drive"].close()
        status = await r.wait(r.drive, LinkState.ABSENT)
        assert not status.armed
        assert "closed" in status.detail
        r.drive.stop_now()
        with pytest.raises(TransportError, match="drive is absent: drive: closed"):
            await r.drive.arm()
        with pytest.raises(TransportError, match="drive is absent"):
            r.drive.set_velocity(STANDSTILL, 0.5)


async def test_a_device_that_comes_back_is_disarmed() -> None:
    async with rig() as r:
        r.lines["drive"].close()
        await r.wait(r.drive, LinkState.ABSENT)
        assert not (await r.wait(r.drive, LinkState.READY)).armed
        assert dict(r.drive.status.counters)["sessions"] == 2


async def test_a_latched_fault_shows_forbids_arming_and_can_be_cleared() -> None:
    async with rig() as r:
        r.drive.set_velocity(Twist2(0.3, 0.0), 0.2)
        with r.drive.status_changes.subscribe() as changes:
            while not (status := await changes.get()).faults:
                pass
        assert (status.faults, status.armed) == (("deadman",), False)
        with pytest.raises(DeviceError, match="deadman latched"):
            await r.drive.arm()
        await r.drive.clear_faults()
        assert r.drive.status.faults == ()
        await r.drive.arm()
        assert r.board("drive").faults is Fault.NONE


async def test_what_breaks_stops_the_device_and_stays_a_fault_until_it_is_mended() -> None:
    async with rig() as r:
        for device, plant, fault in (
            (r.drive, r.robot._body, Fault.BATTERY),
            (r.drive, r.robot._body, Fault.MOTOR),
            (r.pantilt, r.robot._head, Fault.MOTOR),
        ):
            plant.broken = fault
            await asyncio.sleep(0.1)
            assert (device.status.faults, device.status.armed) == ((str(fault.name).lower(),), False)
            await device.clear_faults()
            await asyncio.sleep(0.1)
            assert device.status.faults
            plant.broken = Fault.NONE
            await device.clear_faults()
            await asyncio.sleep(0.1)
            assert device.status.faults == ()
            await device.arm()


async def test_the_boards_clock_is_in_the_status() -> None:
    async with rig(sim=SimSettings(noise=replace(NOISELESS, clock_skew_ppm=50.0))) as r:
        await asyncio.sleep(20.0)
        counted = dict(r.drive.status.counters)
        assert abs(r.robot.clocks["drive"].skew_ppb) > 5000
        assert counted["clock_fast_ppb"] == pytest.approx(r.robot.clocks["drive"].skew_ppb, abs=2000)
        assert 0 <= counted["clock_round_trip_us"] < 1000


async def test_a_status_is_published_only_when_something_changed() -> None:
    async with rig() as r:
        with r.drive.status_changes.subscribe() as changes:
            await asyncio.sleep(2.0)
            r.drive.stop_now()
            assert not (await changes.get()).armed


async def test_an_arm_that_got_lost_leaves_no_trace_of_a_lie() -> None:
    async with rig(armed=False) as r:
        r.lines["drive"].from_board = lose(10**9, Arm.TYPE | REPLY)
        with pytest.raises(LinkTimeout):
            await r.drive.arm()
        assert r.drive.status.armed == (r.board("drive").state is BoardState.ARMED)


# The drive


async def test_odometry_begins_at_the_origin_and_keeps_the_period_and_the_time() -> None:
    async with rig() as r:
        first, second = await next_of(r.drive.odometry), await next_of(r.drive.odometry)
        assert (first.in_odom.x_m, first.in_odom.y_m, first.in_odom.heading_rad) == (0.0, 0.0, 0.0)
        assert second.time_ns - first.time_ns == pytest.approx(40 * MS, abs=MS)
        assert abs(now_ns() - second.time_ns) < MS


async def test_the_drive_goes_where_it_is_told_and_says_so() -> None:
    async with rig() as r:
        turned = await drive_for(r.drive, Twist2(0.0, 0.5), 1.0)
        there = await drive_for(r.drive, Twist2(0.2, 0.0), 1.0)
        way_m = math.hypot(there.in_odom.x_m, there.in_odom.y_m)
        assert turned.in_odom.heading_rad > 0.3
        assert way_m > 0.1
        assert math.atan2(there.in_odom.y_m, there.in_odom.x_m) == pytest.approx(turned.in_odom.heading_rad, abs=0.01)
        truth = r.robot.start.inverse() @ r.robot.truth
        assert (truth.x_m, truth.y_m) == pytest.approx((there.in_odom.x_m, there.in_odom.y_m), abs=0.002)


async def test_a_restart_of_the_drive_board_makes_no_jump_in_odometry() -> None:
    async with rig() as r:
        there = await drive_for(r.drive, Twist2(0.2, 0.0), 1.0)
        r.board("drive").reboot(boot_id=77)
        await r.wait(r.drive, LinkState.ABSENT)
        await r.wait(r.drive, LinkState.READY)
        assert (await next_of(r.drive.odometry)).in_odom == there.in_odom


async def test_battery_and_bumpers_are_read_out() -> None:
    async with rig() as r:
        readout = await next_of(r.drive.readouts)
        assert readout.battery_v == pytest.approx(25.6, abs=0.1)
        assert readout.bumpers_rad == ()


async def test_a_bumper_gives_its_direction_and_latches() -> None:
    async with rig() as r:
        with suppress(TimeoutError):
            async with asyncio.timeout(60.0):
                await drive_for(r.drive, Twist2(0.3, 0.0), 60.0)
        assert "bumper" in r.drive.status.faults
        assert r.drive.readouts.latest is not None
        assert all(abs(bumper) <= math.pi / 2 for bumper in r.drive.readouts.latest.bumpers_rad)
        assert r.drive.readouts.latest.bumpers_rad


# The head


async def test_the_head_turns_and_says_where_it_rests() -> None:
    async with rig() as r:
        aim = await r.pantilt.aim(1.0, -0.2, timeout_s=5.0)
        assert (aim.pan_rad, aim.tilt_rad) == pytest.approx((1.0, -0.2), abs=0.001)
        assert abs(now_ns() - aim.time_ns) < 2 * MS


async def test_the_zeros_of_the_mount_are_applied_both_ways() -> None:
    async with rig(pantilt=BoardPanTiltSettings(pan_zero_rad=0.3, tilt_zero_rad=-0.1)) as r:
        limits = await r.pantilt.limits()
        assert limits.pan_max_rad == pytest.approx(math.radians(159) + 0.3, abs=1e-3)
        assert limits.tilt_min_rad == pytest.approx(math.radians(-47) - 0.1, abs=1e-3)
        aim = await r.pantilt.aim(0.5, 0.0, timeout_s=5.0)
        assert (aim.pan_rad, aim.tilt_rad) == pytest.approx((0.5, 0.0), abs=0.001)
        assert r.robot._head.angles_rad == pytest.approx((0.2, 0.1), abs=0.001)


async def test_a_head_without_end_pans_all_round_whatever_its_zero() -> None:
    sim = SimSettings(noise=NOISELESS, head=StepperSettings(pan_limit_rad=math.pi))
    async with rig(sim=sim, pantilt=BoardPanTiltSettings(pan_zero_rad=1.0)) as r:
        limits = await r.pantilt.limits()
        assert (limits.pan_min_rad, limits.pan_max_rad) == (-math.pi, math.pi)
        for pan_rad in (-math.pi, -2.5, 0.0, 3.0, math.pi):
            aim = await r.pantilt.aim(pan_rad, 0.0, timeout_s=5.0)
            assert math.cos(aim.pan_rad - pan_rad) == pytest.approx(1.0, abs=1e-5)


async def test_aiming_outside_the_limits_or_disarmed_is_refused() -> None:
    async with rig() as r:
        with pytest.raises(DeviceError, match="bad_value"):
            await r.pantilt.aim(3.0, 0.0, timeout_s=5.0)
        r.pantilt.stop_now()
        with pytest.raises(DeviceError, match="wrong_state"):
            await r.pantilt.aim(0.0, 0.0, timeout_s=5.0)


async def test_a_lost_motion_done_is_made_up_for_by_the_next_report() -> None:
    async with rig() as r:
        await r.pantilt.aim(0.0, 0.0, timeout_s=5.0)
        r.lines["pantilt"].from_board = lose(2, AimReport.TYPE)
        began_ns = now_ns()
        await r.pantilt.aim(0.01, 0.0, timeout_s=5.0)
        assert now_ns() - began_ns < 130 * MS


async def test_without_any_report_the_head_is_asked() -> None:
    async with rig() as r:
        r.lines["pantilt"].from_board = lose(10**9, AimReport.TYPE)
        aim = await r.pantilt.aim(0.5, 0.0, timeout_s=5.0)
        assert aim.pan_rad == pytest.approx(0.5, abs=0.001)


async def test_a_head_that_is_stopped_on_its_way_is_an_error_and_no_wait() -> None:
    async with rig() as r:
        aiming = asyncio.create_task(r.pantilt.aim(2.0, 0.0, timeout_s=60.0))
        await asyncio.sleep(0.1)
        r.pantilt.stop_now()
        began_ns = now_ns()
        with pytest.raises(DeviceError, match="halted"):
            await aiming
        assert now_ns() - began_ns < 130 * MS


async def test_an_old_halt_with_the_same_seq_is_not_taken_for_ours() -> None:
    async with rig() as r:
        stale = AimReport(10**12, 0, 0, 0, Motion.HALTED)
        aiming = asyncio.create_task(r.pantilt.aim(0.5, 0.0, timeout_s=5.0))
        await asyncio.sleep(0)
        r.pantilt.telemetry(stale)
        assert (await aiming).pan_rad == pytest.approx(0.5, abs=0.001)


async def test_a_head_that_is_too_slow_is_halted_without_a_fault() -> None:
    async with rig() as r:
        began_ns = now_ns()
        with pytest.raises(LinkTimeout, match=r"still turning after 0.1 s"):
            await r.pantilt.aim(2.0, 0.0, timeout_s=0.1)
        assert now_ns() - began_ns == pytest.approx(100 * MS, abs=MS)
        await asyncio.sleep(1.0)
        assert (r.board("pantilt").state, r.pantilt.status.faults) == (BoardState.CONFIGURED, ())


async def test_an_aim_ends_at_once_when_the_head_is_lost() -> None:
    async with rig() as r:
        aiming = asyncio.create_task(r.pantilt.aim(2.0, 0.0, timeout_s=60.0))
        await asyncio.sleep(0.1)
        r.lines["pantilt"].close()
        began_ns = now_ns()
        with pytest.raises(TransportError, match="pantilt was lost: pantilt: closed"):
            await aiming
        assert now_ns() - began_ns < MS


async def test_three_hundred_aims_cost_no_more_than_the_head_needs() -> None:
    async with rig() as r:
        await r.pantilt.aim(-2.0, 0.0, timeout_s=5.0)
        began_ns = now_ns()
        for index in range(1, 201):
            await r.pantilt.aim(-2.0 + 0.02 * index, 0.0, timeout_s=5.0)
        assert now_ns() - began_ns < 1.02 * (4.0 / 6.0) * NS_PER_S
        assert dict(r.pantilt.status.counters)["retries"] == 0


async def test_a_repeated_aim_turns_the_head_once() -> None:
    async with rig() as r:
        r.lines["pantilt"].from_board = lose(1, Aim.TYPE | REPLY)
        await r.pantilt.aim(0.5, 0.0, timeout_s=5.0)
        assert dict(r.pantilt.status.counters)["retries"] == 1
        assert (await r.pantilt._talk().ask(ReadAim(), AimReadback)).aim_seq == 0
