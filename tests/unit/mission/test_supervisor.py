"""The supervisor allows motion to whom it should, as long as it should, and says how everything ended."""

import asyncio

import pytest

from robotd.contract.device_status import LinkState
from robotd.contract.events import MissionPhase
from robotd.contract.missions import DriveTo, Legs, Localize, MapStart
from robotd.contract.modes import Mode
from robotd.core.clock import now_ns
from robotd.core.errors import MissionError
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry
from robotd.hardware.devices.drive import DriveReadout
from tests.unit.mission.scripted_rig import GONE, rig, turns


async def test_a_fault_keeps_its_reason_until_it_is_cleared() -> None:
    async with rig() as r:
        r.drive.change(armed=False, faults=("bumper",))
        await turns()
        await r.supervisor.stop("somebody pressed stop")
        r.pantilt.change(**GONE)
        await turns()
        assert (r.mode.value, r.reason) == ("fault", "drive: bumper")
        with pytest.raises(MissionError, match="cannot arm while fault: drive: bumper"):
            await r.supervisor.arming.arm()
        await r.supervisor.arming.clear()
        assert (r.mode.value, r.reason) == ("disarmed", "faults cleared")


async def test_a_fault_that_stays_is_not_cleared() -> None:
    async with rig() as r:
        r.drive.faults_left = ("motor",)
        r.drive.change(armed=False, faults=("motor",))
        await turns()
        with pytest.raises(MissionError, match="faults remain: drive: motor"):
            await r.supervisor.arming.clear()
        assert r.mode is Mode.FAULT


async def test_what_is_armed_must_be_disarmed_before_it_is_cleared() -> None:
    async with rig() as r:
        with pytest.raises(MissionError, match="cannot clear while idle"):
            await r.supervisor.arming.clear()


@pytest.mark.parametrize("lost", [0, 1, 2])
async def test_a_lost_device_stops_the_others(lost: int) -> None:
    async with rig() as r:
        r.devices[lost].change(**GONE)
        await turns()
        assert r.mode is Mode.DISARMED
        assert r.reason == f"{r.devices[lost].name} is gone: the line was cut"
        assert all(device.stops for device in r.devices)
        if lost:
            with pytest.raises(MissionError, match=f"cannot arm: {r.devices[lost].name} absent"):
                await r.supervisor.arming.arm()


async def test_without_a_base_it_can_be_armed_to_look_but_not_to_move() -> None:
    async with rig() as r:
        r.use_map()
        r.drive.change(**GONE)
        await turns()
        await r.supervisor.arming.arm()
        assert (r.mode, r.reason) == (Mode.IDLE, "armed without a base: it can only look")
        assert [device.status.armed for device in r.devices] == [False, True, True]
        for mission in (DriveTo(0.1, 0.0), MapStart("m", ())):
            with pytest.raises(MissionError, match="the robot can only look where it stands"):
                r.supervisor.mission.start(mission, 10.0)
        r.drive.change(link=LinkState.CONNECTING, detail="line open")
        await turns()
        assert r.mode is Mode.IDLE
        r.supervisor.mission.start(Localize(heading_rad=0.0), 10.0)
        assert r.supervisor.status.mode == "localizing"


async def test_a_base_that_comes_back_stops_what_went_on_without_it() -> None:
    async with rig() as r:
        r.drive.change(**GONE)
        await turns()
        await r.supervisor.arming.arm()
        r.drive.change(link=LinkState.READY, armed=False, detail="")
        await turns()
        assert (r.mode, r.reason) == (Mode.DISARMED, "drive is there again: arm again")
        await r.supervisor.arming.arm()
        assert all(device.status.armed for device in r.devices)


async def test_a_low_battery_stops_the_robot_until_it_is_cleared_and_cannot_be_cleared_while_it_is_low() -> None:
    async with rig(battery_min_v=22.0) as r:
        r.drive.readouts.publish(DriveReadout(now_ns(), None, ()))  # a base that has not measured it yet
        r.drive.readouts.publish(DriveReadout(now_ns(), 22.0, ()))
        await turns()
        assert r.mode is Mode.IDLE
        r.drive.readouts.publish(DriveReadout(now_ns(), 21.94, ()))
        await turns()
        assert (r.mode, r.reason) == (Mode.FAULT, "drive: the battery is at 21.9 V, below 22 V")
        assert all(device.stops for device in r.devices)
        with pytest.raises(MissionError, match=r"faults remain: drive: the battery is at 21\.9 V"):
            await r.supervisor.arming.clear()
        r.drive.readouts.publish(DriveReadout(now_ns(), 25.0, ()))
        await turns()
        assert r.mode.value == "fault"
        await r.supervisor.arming.clear()
        await r.supervisor.arming.arm()


async def test_a_device_that_disarms_by_itself_stops_the_others() -> None:
    async with rig() as r:
        r.pantilt.change(armed=False)
        await turns()
        assert (r.mode, r.reason) == (Mode.DISARMED, "pantilt is no longer armed")
        assert not any(device.status.armed for device in r.devices)


async def test_what_a_lost_drive_said_last_is_not_shown_as_if_it_were_now() -> None:
    async with rig() as r:
        r.drive.readouts.publish(DriveReadout(now_ns(), 25.0, (0.0,)))
        assert (r.supervisor.status.battery_v or 0.0) > 0.0
        r.drive.change(**GONE)
        assert (r.supervisor.status.battery_v, r.supervisor.status.bumpers_rad) == (None, ())


async def test_a_stop_explains_the_end_even_if_a_time_for_an_answer_has_just_run_out() -> None:
    async with rig(talking=False) as r:
        r.use_map()
        number = r.supervisor.mission.start(DriveTo(1.0, 0.0, Legs.STRAIGHT), 100.0)
        await turns()
        (mission,) = [task for task in asyncio.all_tasks() if task.get_name() == f"mission {number}"]
        mission.cancel()  # as a timeout does, a turn before it raises TimeoutError
        await r.supervisor.stop("enough")
        assert (await r.end_of_mission()).message == "enough"


async def test_an_error_of_ours_stops_the_robot_before_it_ends_the_daemon(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig(talking=False) as r:
        r.use_map()
        r.supervisor.mission.start(DriveTo(1.0, 0.0, Legs.STRAIGHT), 100.0)
        await turns()

        def fail(*_: object) -> None:
            raise ValueError("a mistake of ours")

        monkeypatch.setattr(r.supervisor.whereabouts, "moved", fail)
        r.drive.odometry.publish(Odometry(now_ns(), IDENTITY, STANDSTILL))
        with pytest.raises(ExceptionGroup):
            await r.watching
        assert all(device.stops for device in r.devices)
        assert (await r.end_of_mission()).phase is MissionPhase.STOPPED
