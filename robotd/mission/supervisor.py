"""Who allows motion: the mode and its mission, what watches over them, and the stop that comes before everything.

The rules are in :mod:`robotd.mission.safety.mode_table`; the parts made here carry them out, each with one job: arming,
holding, watching the devices, the mission under way, telling where the robot is. What goes wrong anywhere ends in
:meth:`Supervisor.halt`, and there the preformatted stop goes to every board before anything is cancelled, logged or
published.
"""

import asyncio
import logging
from collections.abc import Callable

from robotd.contract.events import Status
from robotd.contract.modes import Mode
from robotd.core.clock import now_ns
from robotd.core.counted import Counted
from robotd.core.errors import MissionError
from robotd.mission.missions.context import MissionContext
from robotd.mission.missions.under_way import MakeLease, MissionUnderWay, NoteCause
from robotd.mission.news import News
from robotd.mission.safety.arming import Arming
from robotd.mission.safety.battery import faults_of
from robotd.mission.safety.current_mode import CurrentMode
from robotd.mission.safety.device_watch import DeviceWatch
from robotd.mission.safety.holding import Holding
from robotd.mission.safety.lease import Lease
from robotd.mission.safety.mode_table import Occasion
from robotd.mission.whereabouts.map_in_use import MapInUse
from robotd.mission.whereabouts.telling import WhereaboutsTold
from robotd.mission.whereabouts.tie import Tie

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
        note_cause: NoteCause = lambda _name, _arguments: None,
        make_lease: MakeLease = Lease,
        counted: Counted | None = None,
    ) -> None:
        """Prepare; nothing happens before :meth:`run`.

        Args:
            context: what missions work with, and what to watch over.
            news: where events are told.
            recording: says which file is being recorded to.
            battery_min_v: below it, stop and latch a fault.
            note_cause: told what stops the robot by a clock of the daemon, before it does.
            make_lease: makes what calls a function once this many seconds have passed.
            counted: where stops are counted.
        """
        self.robot = context.robot
        self.news = news
        self.whereabouts = context.whereabouts
        self._planning = context.settings.planning
        self.ranks = context.ranks
        self._recording = recording
        self._is_untold = False
        """Whether the last status could not be told: the log has it once, not each second."""
        self._started_ns = now_ns()
        self.counted = counted or Counted()
        self.halts = 0
        """How often the robot was stopped: who waited for something compares, and sees whether a stop came between."""
        self._current = CurrentMode(self.publish_status)
        self._told = WhereaboutsTold(
            context.whereabouts,
            news.publish,
            self.publish_status,
            context.head.forget,
            context.settings.advice_on,
        )
        self.arming = Arming(self, self._current, lambda: faults_of(self.robot, battery_min_v))
        self.holding = Holding(self, context.hold, self.arming)
        self._watch = DeviceWatch(self, self.holding, self.arming, self._told.doubt, battery_min_v)
        self.mission = MissionUnderWay(
            self,
            context,
            self._told,
            self._current,
            arming=self.arming,
            holding=self.holding,
            make_lease=make_lease,
            note_cause=note_cause,
        )

    @property
    def mode(self) -> Mode:
        """What the robot is allowed to do now."""
        return self._current.mode

    @property
    def reason(self) -> str:
        """Why it is in this mode."""
        return self._current.reason

    @property
    def status(self) -> Status:
        """The whole robot in one look."""
        place = self.whereabouts.map_in_use
        readout = self.robot.drive.readouts.latest if self.robot.has_base else None  # what was is not what is
        return Status(
            time_ns=now_ns(),
            mode=self._current.word,
            reason=self._current.reason,
            devices=tuple(device.status for device in self.robot.devices),
            battery_v=readout.battery_v if readout else None,
            bumpers_rad=readout.bumpers_rad if readout else (),
            mission_id=self.mission.mission_id,
            map_id=place.map_id if place else None,
            map_name=place.name if place else None,
            recording=self._recording(),
            held=self.holding.cause,
            map_unsaved=place is not None and place.is_unsaved,
            map_kept_version=place.kept_as if place else None,
            since_ns=self._current.since_ns,
            started_ns=self._started_ns,
            commander=self.mission.commander,
        )

    def publish_status(self) -> None:
        """Tell everybody how the whole robot is; where that fails nothing ends, and the next comes in a second."""
        try:
            self.news.publish(self.status)
        except Exception:  # stopping, arming and watching go on, whatever keeps a status from being made
            if not self._is_untold:
                log.exception("the status could not be told")
            # Told of once, for a status that cannot be made is tried again each second.
            self._is_untold = True
        else:
            self._is_untold = False

    async def run(self) -> None:
        """Watch the devices until cancelled; whatever ends it stops the robot."""
        try:
            # Who subscribes later hears it too: the last message of each event is kept for those who join.
            self._told.begin()
            async with asyncio.TaskGroup() as group:
                for device in self.robot.devices:
                    group.create_task(self._watch.watch(device))
                group.create_task(self._watch.watch_battery())
                group.create_task(self._follow_odometry())
                group.create_task(self._follow_bumpers())
                group.create_task(self._repeat_status())
                group.create_task(self.ranks.run())
        finally:
            self.halt(Occasion.STOP, "the daemon is ending")

    def halt(self, occasion: Occasion, reason: str) -> None:
        """Stop first, then everything else."""
        # First of all: no count, log or cancellation may stand between a stop and the wires.
        self.robot.stop_now()
        self.halts += 1
        self.counted.count("stops_total", cause=occasion)
        self.holding.end()
        self.mission.cancel(reason)
        self._current.apply(occasion, reason)

    async def stop(self, reason: str) -> None:
        """Stop everything and disarm; valid at any time."""
        self.halt(Occasion.STOP, reason)
        # A client that was answered may start the next mission at once, and must not find this one still
        # ending.
        await self.mission.ended()

    def use(self, place: MapInUse, tie: Tie | None = None) -> None:
        """Make another map the one in use, and tell everybody.

        Raises:
            MissionError: a mission is under way.
        """
        self.require_replaceable_map()
        self._told.adopt(place, tie)

    def require_replaceable_map(self) -> None:
        """Raise MissionError if the map in use cannot be changed now: a mission ends on the map that it began on."""
        if self.mission.is_busy:
            raise MissionError("the map cannot be changed while a mission is under way")

    async def _follow_odometry(self) -> None:
        with self.robot.drive.odometry.subscribe() as stream:
            async for odometry in stream:
                self._told.moved(odometry, predicts=not self.mission.pauses_prediction)

    async def _follow_bumpers(self) -> None:
        pressed: set[float] = set()
        with self.robot.drive.readouts.subscribe() as stream:
            async for readout in stream:
                # The edge alone: a bumper stays pressed for as long as the robot leans there, and is one
                # obstacle.
                bumps_rad = [bumper_rad for bumper_rad in readout.bumpers_rad if bumper_rad not in pressed]
                pressed = set(readout.bumpers_rad)
                here = self.robot.drive.odometry.latest
                if bumps_rad and here is not None and self._planning.keeps_bumps:
                    self.whereabouts.bumped(here.in_odom, bumps_rad, self._planning.robot_radius_m)

    async def _repeat_status(self) -> None:
        while True:
            await asyncio.sleep(1.0)
            self.publish_status()
