"""A supervisor on three devices that do what a test says."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from dataclasses import replace
from typing import Any

from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.contract.events import Event, MissionProgress
from robotd.contract.modes import Mode
from robotd.core.broadcast import Broadcast, Subscription
from robotd.core.clock import now_ns
from robotd.core.errors import LinkTimeout, TransportError
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry, Twist2
from robotd.hardware.devices.calibration import HeadMount, RangefinderCalibration
from robotd.hardware.devices.drive import DriveReadout
from robotd.hardware.devices.pantilt import AimReadback, PanTiltLimits
from robotd.hardware.devices.rangefinder import Shot
from robotd.head.compute import ThreadCompute
from robotd.mission.missions.context import MissionContext
from robotd.mission.missions.settings import MissionSettings
from robotd.mission.news import News
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
