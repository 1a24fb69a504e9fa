"""Who allows motion: holds the mode, watches the devices, and runs one mission at a time.

The rules are in :mod:`robotd.mission.modes`; this file carries them out. Whatever goes wrong, stop comes first: the
preformatted stop goes to every board before anything is cancelled, logged or published.
"""

import asyncio
import logging
from collections.abc import Callable
from dataclasses import replace

from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.contract.events import MissionPhase, MissionProgress, Status
from robotd.contract.missions import Mission
from robotd.contract.modes import Mode
from robotd.core.clock import now_ns
from robotd.core.errors import LinkTimeout, MissionError, RobotdError
from robotd.core.log_limit import LogLimit
from robotd.core.pose import Odometry
from robotd.core.silence import within
from robotd.core.text import printable
from robotd.hardware.devices.credible import IMPLAUSIBLE
from robotd.hardware.devices.device import Device
from robotd.mission.advice import with_advice
from robotd.mission.context import MissionContext, Reporter
from robotd.mission.missions import MISSION_ROWS, MissionRow
from robotd.mission.modes import Occasion, next_mode
from robotd.mission.news import News
from robotd.mission.results import map_result
from robotd.mission.safety.battery import low_battery
from robotd.mission.safety.holding import Holding
from robotd.mission.safety.lease import Lease
from robotd.mission.whereabouts.map_in_use import MapInUse, in_place_of
from robotd.mission.whereabouts.tie import Tie
from robotd.mission.whereabouts.whereabouts import unlocalized

_DEVICE_TIMEOUT_S = 5.0
_LONGEST_REASON = 500

log = logging.getLogger(__name__)


class Supervisor:
    """The robot's conscience."""

    def __init__(
        self,
        context: MissionContext,
        news: News,
        recording: Callable[[], str | None] = lambda: None,
        *,
        battery_min_v: float = 0.0,
        note_cause: Callable[[str, dict[str, int]], None] = lambda _name, _arguments: None,
        make_lease: Callable[[float, Callable[[], None]], Lease] = Lease,
    ) -> None:
        """Prepare; nothing happens before :meth:`run`.

        Args:
            context: what missions work with, and what to watch over.
            news: where events are told.
            recording: says which file is being recorded to.
            battery_min_v: below it, stop and latch a fault.
            note_cause: told what stops the robot by a clock of the daemon, before it does.
            make_lease: makes what calls a function once so many seconds have passed.
        """
        self.robot = context.robot
        self.news = news
        self.whereabouts = context.whereabouts
        self._recording = recording
        self._battery_min_v = battery_min_v
        self._note_cause = note_cause
        self._make_lease = make_lease
        self._context = context
        self.holding = Holding(self, self._context.hold, lambda: self._armed, self._arm_devices)
        self._mode = Mode.DISARMED
        self._reason = "started"
        self._mission: asyncio.Task[None] | None = None
        self._mission_id = 0
        self._row: MissionRow | None = None
        """Of the mission that is under way, or was last."""
        self._lease: Lease | None = None
        self.halts = 0
        """How often the robot was stopped."""
        self._stopped_by = ""
        """Why the mission that is ending, or ended last, was stopped."""
        self._changes = LogLimit(burst=50)
        self._armed: tuple[Device, ...] = ()
        """What the last arming was for: everything, or everything but the base."""

    @property
    def mode(self) -> Mode:
        """What the robot is allowed to do now."""
        return self._mode

    @property
    def status(self) -> Status:
        """The whole robot in one look."""
        place = self.whereabouts.map_in_use
        readout = self.robot.drive.readouts.latest if self.robot.has_base else None  # what was is not what is
        return Status(
            time_ns=now_ns(),
            mode=self._mode_word,
            reason=self._reason,
            devices=tuple(device.status for device in self.robot.devices),
            battery_v=readout.battery_v if readout else None,
            bumpers_rad=readout.bumpers_rad if readout else (),
            mission_id=self._mission_id if self._mode is Mode.UNDER_WAY else None,
            map_id=place.map_id if place else None,
            map_name=place.name if place else None,
            recording=self._recording(),
            held=self.holding.hold.cause,
            map_unsaved=place is not None and place.is_unsaved,
            map_kept_version=place.kept_as if place else None,
        )

    @property
    def _faults(self) -> tuple[str, ...]:
        low = low_battery(self.robot.drive, self._battery_min_v)
        return self.robot.faults if low is None else (*self.robot.faults, low)

    @property
    def _busy(self) -> bool:
        return self._mission is not None and not self._mission.done()

    def publish_status(self) -> None:
        """Tell everybody how the whole robot is."""
        self.news.publish(self.status)

    async def run(self) -> None:
        """Watch the devices until cancelled; whatever ends it stops the robot."""
        try:
            self.news.publish(unlocalized(now_ns(), ""))
            async with asyncio.TaskGroup() as group:
                for device in self.robot.devices:
                    group.create_task(self._watch(device))
                group.create_task(self._watch_battery())
                group.create_task(self._follow_odometry())
                group.create_task(self._repeat_status())
        finally:
            self.halt(Occasion.STOP, "the daemon is ending")

    async def arm(self) -> None:
        """Allow motion, on every device or on none; without a base, on the others.

        Raises:
            MissionError: the head or the rangefinder is absent, a fault is latched, or a mission is under way.
            DeviceError, LinkTimeout, TransportError: a device will not; all are disarmed again.
        """
        devices = self.require_armable()
        try:
            async with within(_DEVICE_TIMEOUT_S, of="arming"):
                await self._arm_devices(devices)
        except TimeoutError:
            self.halt(Occasion.STOP, "arming took too long")
            raise LinkTimeout(f"arming took longer than {_DEVICE_TIMEOUT_S:g} s") from None
        except BaseException as error:
            self.halt(Occasion.STOP, f"arming failed: {str(error) or 'given up'}")
            raise
        self._armed = devices
        self._apply(Occasion.ARM, "armed" if self.robot.drive in devices else "armed without a base: it can only look")

    def require_armable(self) -> tuple[Device, ...]:
        """Return what to arm: all devices; without a base the others, so that the robot can look round where it stands.

        Raises:
            MissionError: it cannot be armed now; nothing was done yet.
        """
        self._require(Occasion.ARM)
        absent = self.robot.absent
        devices = self.robot.devices if self.robot.has_base else self.robot.devices[1:]
        if any(device.name in absent for device in devices):
            raise MissionError(f"cannot arm: {', '.join(absent)} absent")
        if self._faults:
            raise MissionError(f"cannot arm: {'; '.join(self._faults)}: clear first")
        return devices

    async def _arm_devices(self, devices: tuple[Device, ...]) -> None:
        halts = self.halts
        for device in devices:
            await device.arm()
            if self.halts != halts:
                raise MissionError(f"stopped while arming: {self._reason}")
        if not all(device.status.armed for device in devices):
            raise MissionError("a device was lost while the others were arming")

    async def stop(self, reason: str) -> None:
        """Stop everything and disarm; valid at any time."""
        self.halt(Occasion.STOP, reason)
        await self.stopped()

    async def stopped(self) -> None:
        """Wait until the mission that was stopped has ended."""
        if self._mission is not None:
            await asyncio.wait((self._mission,))

    async def clear(self) -> None:
        """Acknowledge latched faults; the robot stays disarmed.

        Raises:
            MissionError: the robot is armed.
            DeviceError, LinkTimeout, TransportError: a device will not.
        """
        self.require_clearable()
        for device in self.robot.devices:
            if device.status.link is LinkState.READY:
                await device.clear_faults()
        if self._faults:
            raise MissionError(f"faults remain: {'; '.join(self._faults)}")
        self._apply(Occasion.CLEAR, "faults cleared")

    def require_clearable(self) -> None:
        """Raise MissionError if faults cannot be acknowledged now; nothing was done yet."""
        self._require(Occasion.CLEAR)

    def start(self, mission: Mission, lease_s: float) -> int:
        """Start a mission under a lease and return its number.

        Raises:
            MissionError: not armed, or another mission is under way.
        """
        row = MISSION_ROWS[type(mission)]
        if self._mode is Mode.DISARMED:
            raise MissionError(f"cannot {mission.kind}: the robot is disarmed; arm it first")
        self._require(Occasion.START, f"start {mission.doing}")
        if row.needs_base and self.robot.drive not in self._armed:
            raise MissionError(f"cannot {mission.kind}: the drive is not armed; it can only localize where it stands")
        self._mission_id += 1
        mission_id = self._mission_id
        report = Reporter(mission_id, mission.kind, row.stops(mission), self.news.publish, self._advised)
        lease = self._lease = self._make_lease(lease_s, lambda: self.lease_expired(mission_id))
        self._row = row
        self._apply(Occasion.START, f"mission {mission_id}")
        self._mission = asyncio.create_task(self._run_mission(mission, report), name=f"mission {mission_id}")
        self._mission.add_done_callback(lambda task: self._mission_ended(task, lease, report))
        return mission_id

    def renew(self, mission_id: int) -> None:
        """Keep a mission's lease alive; MissionError if that mission is not under way."""
        if not self._busy or mission_id != self._mission_id or self._lease is None:
            why = f" any more: {self._reason}" if mission_id == self._mission_id else ""
            raise MissionError(f"mission {mission_id} is not under way{why}")
        self._lease.renew()

    def use(self, place: MapInUse, tie: Tie | None = None) -> None:
        """Make another map the one in use.

        Raises:
            MissionError: a mission is under way.
        """
        self.require_replaceable_map()
        self.adopt(place, tie)

    def require_replaceable_map(self) -> None:
        """Raise MissionError if the map in use cannot be changed now."""
        if self._busy:
            raise MissionError("the map cannot be changed while a mission is under way")

    def adopt(self, place: MapInUse, tie: Tie | None) -> None:
        """Take over a map, from a mission or from the store, and tell everybody."""
        log.info("map %s (%s) is in use%s", place.name, place.map_id, in_place_of(self.whereabouts.map_in_use))
        self.whereabouts.adopt(place, tie)
        whole = place.whole(now_ns())
        self.news.publish(whole, map_result(whole, place.digest))
        if tie is None:
            self.news.publish(unlocalized(now_ns(), place.map_id))
        self.publish_status()

    def halt(self, occasion: Occasion, reason: str) -> None:
        """Stop first, then everything else."""
        self.robot.stop_now()
        self.halts += 1
        self.holding.end()
        if self._mission is not None and self._mission is not asyncio.current_task():
            if not self._mission.done() and not self._mission.cancelling():
                self._stopped_by = reason  # what comes while it ends does not explain why it ends
            self._mission.cancel()
        self._apply(occasion, reason)

    @property
    def _mode_word(self) -> str:
        """The mode as a status says it: of a mission under way, what it does."""
        return self._row.request.doing if self._row is not None and self._mode is Mode.UNDER_WAY else self._mode

    def _require(self, occasion: Occasion, what: str = "") -> None:
        if next_mode(self._mode, occasion) is None:
            why = f": {self._reason}" if self._mode in {Mode.DISARMED, Mode.FAULT} else ""
            raise MissionError(f"cannot {what or occasion} while {self._mode_word}{why}")

    def _apply(self, occasion: Occasion, reason: str) -> None:
        mode = next_mode(self._mode, occasion)
        if mode is None:
            return
        reason = printable(reason, _LONGEST_REASON)
        if mode is self._mode is Mode.FAULT:
            reason = self._reason  # what comes after a fault does not explain it
        before, was = self._mode_word, (self._mode, self._reason)
        self._mode, self._reason = mode, reason
        if (mode, reason) != was and (line := self._changes.line(f"{before} -> {self._mode_word}: {reason}")):
            log.info("%s", line)
        self.publish_status()

    def _fail(self, reason: str, occasion: Occasion = Occasion.STOP) -> str:
        reason = self.holding.blamed(reason)
        self.halt(occasion, reason)
        return reason

    def lease_expired(self, mission_id: int) -> None:
        """Stop the mission whose client fell silent; nothing happens if it has ended."""
        if self._busy and mission_id == self._mission_id:
            self.robot.stop_now()
            self._note_cause("lease", {"mission_id": mission_id})
            self._fail(f"the lease of mission {mission_id} expired: its client fell silent")

    async def _run_mission(self, mission: Mission, report: Reporter) -> None:
        try:
            report.at(MissionPhase.STARTED)
            message = await MISSION_ROWS[type(mission)].carry_out(self, self._context, mission, report)
        except MissionError as error:
            self._apply(Occasion.FINISH, str(error))
            report.at(MissionPhase.FAILED, message=str(error))
        except RobotdError as error:
            report.at(MissionPhase.FAILED, message=self._fail(str(error)))
        except Exception as error:
            self.halt(Occasion.STOP, f"internal error: {error!r}")
            log.exception("mission %d", report.mission_id)
            report.at(MissionPhase.FAILED, message=self._reason)
        else:
            self._apply(Occasion.FINISH, message)
            report.at(MissionPhase.DONE, report.stops, message)

    def _advised(self, last: MissionProgress) -> MissionProgress:
        return with_advice(last, self.whereabouts.map_in_use)

    def _mission_ended(self, task: asyncio.Task[None], lease: Lease, report: Reporter) -> None:
        """Take the lease back; a mission may be cancelled before its first step, and that is an end too."""
        lease.end()
        if task.cancelled():
            report.at(MissionPhase.STOPPED, message=self._stopped_by)

    async def _watch(self, device: Device) -> None:
        with device.status_changes.subscribe() as changes:
            async for status in changes:
                # It may have been armed since, knowing of this change: that is then no news.
                self._device_changed(replace(status, armed=status.armed or device.status.armed))

    def _device_changed(self, status: DeviceStatus) -> None:
        if status.name == self.robot.drive.name and (status.link is LinkState.ABSENT or IMPLAUSIBLE in status.faults):
            self._doubt()
        if self.holding.explains(status) and not self._is_left_out(status):
            self.publish_status()
        elif status.faults and self._mode is not Mode.FAULT:
            why = f": {status.detail}" if IMPLAUSIBLE in status.faults else ""
            self._fail(f"{status.name}: {', '.join(status.faults)}{why}", Occasion.FAULT)
        elif self._mode in {Mode.DISARMED, Mode.FAULT}:
            self.publish_status()
        elif status.link is not LinkState.READY and not self._is_left_out(status):
            self._fail(f"{status.name} is gone: {status.detail}", Occasion.DEVICE_LOST)
        elif status.link is LinkState.READY and not status.armed:
            why = "there again: arm anew" if self._is_left_out(status) else "no longer armed"
            self.halt(Occasion.STOP, f"{status.name} is {why}")
        else:
            self.publish_status()

    async def _watch_battery(self) -> None:
        with self.robot.drive.readouts.subscribe() as readouts:
            async for _ in readouts:
                low = low_battery(self.robot.drive, self._battery_min_v)
                if low is not None and self._mode is not Mode.FAULT:
                    self.halt(Occasion.FAULT, low)

    def _is_left_out(self, status: DeviceStatus) -> bool:
        return status.name not in {device.name for device in self._armed}

    def _doubt(self) -> None:
        """Say at once that odometry is believed no longer; without a map there is nothing to be lost on."""
        place = self.whereabouts.map_in_use
        if self.whereabouts.doubt() and place is not None:
            self.news.publish(unlocalized(now_ns(), place.map_id))

    async def _follow_odometry(self) -> None:
        with self.robot.drive.odometry.subscribe() as stream:
            async for odometry in stream:
                self._moved(odometry)

    def _moved(self, odometry: Odometry) -> None:
        self.news.publish(odometry)
        if self._mode is Mode.UNDER_WAY and self._row is not None and self._row.pauses_prediction:
            return
        if (estimate := self.whereabouts.moved(odometry)) is not None:
            self.news.publish(estimate)

    async def _repeat_status(self) -> None:
        while True:
            await asyncio.sleep(1.0)
            self.publish_status()
