"""The supervisor allows motion to whom it should, as long as it should, and says how everything ended."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from dataclasses import replace
from typing import Any

import pytest

from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import Event, MissionPhase, MissionProgress
from robotd.contract.missions import DriveTo, Legs, Localize, MapStart
from robotd.contract.modes import Mode
from robotd.core.broadcast import Broadcast, Subscription
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import DeviceError, LinkTimeout, MissionError, RobotdError, TransportError
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry, Pose2, Twist2
from robotd.hardware.devices.calibration import HeadMount, RangefinderCalibration
from robotd.hardware.devices.drive import DriveReadout
from robotd.hardware.devices.pantilt import AimReadback, PanTiltLimits
from robotd.hardware.devices.rangefinder import Shot
from robotd.head.compute import ThreadCompute
from robotd.mission.missions.context import MissionContext
from robotd.mission.missions.settings import MissionSettings
from robotd.mission.news import News
from robotd.mission.safety.mode_table import Occasion
from robotd.mission.supervisor import Supervisor
from robotd.mission.three_devices import Robot
from robotd.mission.whereabouts.tie import Tie
from tests.support.places import head_on, place

TELEMETRY_S = 0.04
GONE = {"link": LinkState.ABSENT, "armed": False, "detail": "the line was cut"}


class Scripted:
    """A device that obeys at once, unless it is told to hesitate."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.status = DeviceStatus(name, LinkState.READY, armed=False)
        self.status_changes: Broadcast[DeviceStatus] = Broadcast()
        self.stops = 0
        self.before_arming: Callable[[], Awaitable[None]] | None = None
        self.faults_left: tuple[str, ...] = ()
        """What Clear does not clear."""

    async def run(self) -> None:
        await asyncio.Event().wait()

    async def arm(self) -> None:
        if self.before_arming is not None:
            await self.before_arming()
        if self.status.link is not LinkState.READY:
            raise TransportError(f"{self.name} is absent")
        self.change(armed=True)

    async def clear_faults(self) -> None:
        self.change(armed=False, faults=self.faults_left)

    def stop_past_loop(self, before: int = 0) -> None:
        """No thread is in these tests."""

    def stop_now(self) -> None:
        self.stops += 1
        self.change(armed=False)

    def change(self, **what: Any) -> None:
        before, self.status = self.status, replace(self.status, **what)
        if self.status != before:
            self.status_changes.publish(self.status)


class ScriptedDrive(Scripted):
    """A base that notes what it is told."""

    def __init__(self) -> None:
        super().__init__("drive")
        self.odometry: Broadcast[Odometry] = Broadcast()
        self.readouts: Broadcast[DriveReadout] = Broadcast()
        self.told: list[Twist2] = []

    @property
    def is_driven(self) -> bool:
        return False

    def set_velocity(self, twist: Twist2, ttl_s: float) -> None:
        if self.status.link is not LinkState.READY:
            raise TransportError("drive is absent")
        self.told.append(twist)

    async def talk(self) -> None:
        """Report standstill at the origin for ever."""
        while True:
            await asyncio.sleep(TELEMETRY_S)
            self.odometry.publish(Odometry(now_ns(), IDENTITY, STANDSTILL))


class ScriptedHead(Scripted):
    """A head that never gets there."""

    async def limits(self) -> PanTiltLimits:
        return PanTiltLimits(-3.0, 3.0, -1.0, 1.0)

    async def reset(self) -> None:
        """It cannot lose steps."""

    async def aim(self, pan_rad: float, tilt_rad: float, *, timeout_s: float) -> AimReadback:
        await asyncio.sleep(timeout_s)
        raise LinkTimeout("pantilt: still turning")


class ScriptedLaser(Scripted):
    """A rangefinder that is never asked."""

    async def switch_laser(self, *, on: bool) -> None:
        """Obey."""

    async def shoot(self, *, timeout_s: float) -> Shot:
        raise AssertionError("the head never got there")


class Rig:
    """A supervisor over scripted devices, and everything it says."""

    def __init__(
        self,
        events: Subscription[Event],
        supervisor: Supervisor,
        devices: tuple[Any, Any, Any],
        watching: asyncio.Task[None],
    ) -> None:
        self.supervisor = supervisor
        self.watching = watching
        self.drive: ScriptedDrive = devices[0]
        self.pantilt: Scripted = devices[1]
        self.rangefinder: Scripted = devices[2]
        self.devices: tuple[Scripted, ...] = devices
        self._events = events

    @property
    def mode(self) -> Mode:
        return self.supervisor.mode

    @property
    def reason(self) -> str:
        return self.supervisor.status.reason

    async def end_of_mission(self) -> MissionProgress:
        async with asyncio.timeout(20.0):
            async for event in self._events:
                if isinstance(event, MissionProgress) and event.is_last:
                    return event
        raise AssertionError("a subscription never ends")

    def use_map(self) -> None:
        self.supervisor.use(place(), Tie(IDENTITY))


@asynccontextmanager
async def rig(*, armed: bool = True, talking: bool = True, battery_min_v: float = 0.0) -> AsyncIterator[Rig]:
    drive, pantilt, rangefinder = ScriptedDrive(), ScriptedHead("pantilt"), ScriptedLaser("rangefinder")
    robot = Robot(drive, pantilt, rangefinder)
    compute = ThreadCompute()
    settings = MissionSettings(HeadMount(), RangefinderCalibration())
    news = News(lambda _: None)
    context = MissionContext(robot, settings, head_on(compute), news.publish)
    supervisor = Supervisor(context, news, battery_min_v=battery_min_v)
    with news.events.subscribe(10_000) as events:
        tasks = [asyncio.create_task(supervisor.run())]
        if talking:
            tasks.append(asyncio.create_task(drive.talk()))
        await turns()
        try:
            if armed:
                await supervisor.arming.arm()
            yield Rig(events, supervisor, (drive, pantilt, rangefinder), tasks[0])
        finally:
            await supervisor.stop("the test is over")
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            compute.close()


async def turns(count: int = 5) -> None:
    for _ in range(count):
        await asyncio.sleep(0)


# Arming


async def test_arming_arms_all() -> None:
    async with rig() as r:
        assert r.mode is Mode.IDLE
        assert all(device.status.armed for device in r.devices)


async def test_a_device_that_refuses_leaves_all_disarmed_and_is_named() -> None:
    async with rig(armed=False) as r:

        async def refuse() -> None:
            raise DeviceError("rangefinder", "wrong_state", "Arm")

        r.rangefinder.before_arming = refuse
        with pytest.raises(DeviceError, match="rangefinder"):
            await r.supervisor.arming.arm()
        assert r.mode is Mode.DISARMED
        assert r.reason == "arming failed: rangefinder: wrong_state: Arm"
        assert not any(device.status.armed for device in r.devices)


async def test_a_device_that_does_not_answer_ends_arming_in_time() -> None:
    async with rig(armed=False) as r:
        r.pantilt.before_arming = asyncio.Event().wait  # type: ignore[assignment]  # never returns
        began_ns = now_ns()
        with pytest.raises(LinkTimeout, match="longer than 5 s"):
            await r.supervisor.arming.arm()
        assert now_ns() - began_ns == pytest.approx(5 * NS_PER_S, rel=0.01)
        assert not r.drive.status.armed


@pytest.mark.parametrize(
    ("happens", "mode", "reason"),
    [
        (lambda r: r.supervisor.halt(Occasion.STOP, "enough"), Mode.DISARMED, "enough"),
        (lambda r: r.drive.change(armed=False, faults=("bumper",)), Mode.FAULT, "drive: bumper"),
        (lambda r: r.drive.change(**GONE), Mode.DISARMED, "a device was lost"),
        (lambda r: r.rangefinder.change(**GONE), Mode.DISARMED, "rangefinder is absent"),
    ],
)
async def test_what_happens_while_arming_wins(happens: Callable[[Rig], None], mode: Mode, reason: str) -> None:
    async with rig(armed=False) as r:

        async def hesitate() -> None:
            await asyncio.sleep(0.1)
            happens(r)
            await asyncio.sleep(0.1)

        r.pantilt.before_arming = hesitate
        with pytest.raises(RobotdError):
            await r.supervisor.arming.arm()
        await turns()
        assert r.mode is mode
        assert reason in r.reason
        assert not any(device.status.armed for device in r.devices)


async def test_an_arm_that_is_given_up_by_its_client_leaves_all_disarmed() -> None:
    async with rig(armed=False) as r:
        r.pantilt.before_arming = asyncio.Event().wait  # type: ignore[assignment]  # never returns
        arming = asyncio.create_task(r.supervisor.arming.arm())
        await turns()
        assert r.drive.status.armed
        arming.cancel()
        with pytest.raises(asyncio.CancelledError):
            await arming
        assert not any(device.status.armed for device in r.devices)
        assert r.reason == "arming failed: given up"


async def test_when_one_of_two_arms_fails_so_does_the_other() -> None:
    async with rig(armed=False) as r:
        turn = iter((0.1, 0.2))

        async def hesitate() -> None:
            await asyncio.sleep(next(turn))
            if now_ns() < 0.15 * NS_PER_S:
                raise DeviceError("pantilt", "wrong_state", "Arm")

        r.pantilt.before_arming = hesitate
        outcomes = await asyncio.gather(r.supervisor.arming.arm(), r.supervisor.arming.arm(), return_exceptions=True)
        assert all(isinstance(outcome, RobotdError) for outcome in outcomes)
        assert r.mode is Mode.DISARMED


# Faults and losses


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


# Missions


async def test_a_mission_stopped_before_its_first_step_says_so_and_gives_its_lease_back() -> None:
    async with rig() as r:
        mission_id = r.supervisor.mission.start(MapStart("new", ()), 0.5)
        await r.supervisor.stop("changed my mind")
        end = await r.end_of_mission()
        assert (end.mission_id, end.phase, end.message) == (mission_id, MissionPhase.STOPPED, "changed my mind")
        await asyncio.sleep(1.0)
        assert r.reason == "changed my mind"


async def test_a_lost_drive_is_why_a_drive_ended() -> None:
    async with rig() as r:
        r.use_map()
        r.supervisor.mission.start(DriveTo(1.0, 0.0, Legs.STRAIGHT), 100.0)
        await asyncio.sleep(1.0)
        assert r.drive.told
        r.drive.change(**GONE)
        end = await r.end_of_mission()
        assert (end.phase, end.message) == (MissionPhase.STOPPED, "drive is gone: the line was cut")
        assert r.reason == "drive is gone: the line was cut"


async def test_a_base_that_does_not_move_is_stopped() -> None:
    async with rig() as r:
        r.use_map()
        r.supervisor.mission.start(DriveTo(1.0, 0.0, Legs.STRAIGHT), 100.0)
        end = await r.end_of_mission()
        assert end.phase is MissionPhase.FAILED
        assert "stalled: drive is no nearer" in end.message
        assert r.mode is Mode.DISARMED


async def test_without_odometry_nothing_begins() -> None:
    async with rig(talking=False) as r:
        r.supervisor.mission.start(MapStart("new", ((1.0, 0.0),)), 100.0)
        began_ns = now_ns()
        end = await r.end_of_mission()
        assert (end.phase, end.message) == (MissionPhase.FAILED, "drive: no odometry for 0.5 s")
        assert now_ns() - began_ns < NS_PER_S
        assert r.mode is Mode.DISARMED
        assert r.supervisor.whereabouts.map_in_use is None
        assert r.drive.told == []


async def test_a_head_that_is_stuck_stops_the_robot() -> None:
    async with rig() as r:
        r.supervisor.mission.start(MapStart("new", ()), 100.0)
        end = await r.end_of_mission()
        assert (end.phase, end.message) == (MissionPhase.FAILED, "pantilt: still turning")
        assert r.mode is Mode.DISARMED


async def test_a_mission_that_cannot_be_done_leaves_the_robot_armed_and_idle() -> None:
    async with rig() as r:
        r.supervisor.mission.start(Localize(), 100.0)
        end = await r.end_of_mission()
        assert end.phase is MissionPhase.FAILED
        assert "no map is in use" in end.message
        assert r.mode is Mode.IDLE
        assert r.supervisor.status.mission_id is None


async def test_an_error_of_ours_in_a_mission_stops_the_robot(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise ValueError("a mistake of ours")

    async with rig() as r:
        r.use_map()
        monkeypatch.setattr("robotd.mission.missions.rows.run_driving", fail)
        r.supervisor.mission.start(DriveTo(1.0, 0.0), 100.0)
        end = await r.end_of_mission()
        assert end.phase is MissionPhase.FAILED
        assert "a mistake of ours" in end.message
        assert r.mode is Mode.DISARMED


async def test_one_mission_at_a_time_under_a_lease_that_only_it_renews() -> None:
    async with rig(armed=False) as r:
        with pytest.raises(MissionError, match="arm it first"):
            r.supervisor.mission.start(MapStart("new", ()), 0.5)
        await r.supervisor.arming.arm()
        mission_id = r.supervisor.mission.start(MapStart("new", ()), 0.5)
        with pytest.raises(MissionError, match="while mapping"):
            r.supervisor.mission.start(Localize(), 0.5)
        with pytest.raises(MissionError, match="while mapping"):
            await r.supervisor.arming.arm()
        with pytest.raises(MissionError, match="while a mission is under way"):
            r.use_map()
        with pytest.raises(MissionError, match="not under way"):
            r.supervisor.mission.renew(mission_id + 1)
        await asyncio.sleep(0.4)
        r.supervisor.mission.renew(mission_id)
        assert r.supervisor.status.mission_id == mission_id
        await asyncio.sleep(0.4)
        assert r.supervisor.status.mode == "mapping"
        await asyncio.sleep(0.2)
        assert r.mode.value == "disarmed"
        with pytest.raises(MissionError, match=rf"not under way any more: the lease of mission {mission_id} expired"):
            r.supervisor.mission.renew(mission_id)


async def test_a_pose_is_never_predicted_where_nothing_ties_odometry_to_the_map() -> None:
    async with rig(armed=False, talking=False) as r:
        with r.supervisor.news.events.subscribe() as events:
            r.supervisor.use(place())
            r.drive.odometry.publish(Odometry(now_ns(), Pose2(1.0, 2.0, 0.0), STANDSTILL))
            await turns()
            said = [await events.get() for _ in range(4)]
        assert [type(event).__name__ for event in said] == ["MapChanged", "PoseEstimate", "Status", "Odometry"]
        assert isinstance(said[1], PoseEstimate)
        assert said[1].state is PoseState.LOST
