"""The mission under way: one at a time, under a lease, and each of them ends with a last word."""

import asyncio
import logging
from collections.abc import Callable

from robotd.contract.events import Commander, MissionPhase, MissionProgress
from robotd.contract.missions import Mission
from robotd.contract.modes import Mode
from robotd.core.clock import now_ns
from robotd.core.errors import MissionError, RobotdError
from robotd.mission.missions.context import MissionContext, Reporter
from robotd.mission.missions.rows import MISSION_ROWS, Host, MissionRow
from robotd.mission.missions.saving_advice import with_advice
from robotd.mission.safety.arming import Arming
from robotd.mission.safety.current_mode import CurrentMode
from robotd.mission.safety.holding import Holding
from robotd.mission.safety.lease import Lease
from robotd.mission.safety.mode_table import Occasion
from robotd.mission.safety.stopper import Stopper

MakeLease = Callable[[float, Callable[[], None]], Lease]
NoteCause = Callable[[str, dict[str, int]], None]

log = logging.getLogger(__name__)


class MissionUnderWay:
    """Starts missions, and ends each: when it is done, fails, is stopped, or its client falls silent."""

    def __init__(
        self,
        stopper: Stopper,
        context: MissionContext,
        host: Host,
        current: CurrentMode,
        *,
        arming: Arming,
        holding: Holding,
        make_lease: MakeLease,
        note_cause: NoteCause,
    ) -> None:
        """Prepare; there is no mission yet.

        Args:
            stopper: stops the robot when a mission ends badly.
            context: what missions work with.
            host: what missions need beside that.
            current: the mode, which a mission changes by its beginning and its end.
            arming: knows which devices are armed for it.
            holding: knows what stall of ours may have led to a failure.
            make_lease: makes what calls a function once this many seconds have passed.
            note_cause: told that a lease ran out, before anything comes of it.
        """
        self._stopper = stopper
        self._context = context
        self._host = host
        self._current = current
        self._arming = arming
        self._holding = holding
        self._make_lease = make_lease
        self._note_cause = note_cause
        self._task: asyncio.Task[None] | None = None
        self._number = 0
        self._row: MissionRow | None = None
        """Of the mission that is under way, or was last."""
        self._lease: Lease | None = None
        self._commander: Commander | None = None
        self._stopped_by: str | None = None
        """Why the mission that is ending, or ended last, was stopped; None if it was not."""

    @property
    def is_busy(self) -> bool:
        """Whether a mission has not ended yet; it may have been stopped already, and its mode be over."""
        return self._task is not None and not self._task.done()

    @property
    def mission_id(self) -> int | None:
        """The number of the mission that the robot is allowed to carry out now."""
        return self._number if self._current.mode is Mode.UNDER_WAY else None

    @property
    def pauses_prediction(self) -> bool:
        """Whether what the mission finds is a better word on where the robot is than odometry."""
        return self._current.mode is Mode.UNDER_WAY and self._row is not None and self._row.pauses_prediction

    @property
    def commander(self) -> Commander | None:
        """Whose mission the robot is allowed to carry out now."""
        return self._commander if self._current.mode is Mode.UNDER_WAY else None

    def start(self, mission: Mission, lease_s: float, client: str = "") -> int:
        """Start a client's mission under a lease and return its number.

        Raises:
            MissionError: not armed, or another mission is under way.
        """
        row = MISSION_ROWS[type(mission)]
        # The table refuses it as well, but does not know the next step.
        if self._current.mode is Mode.DISARMED:
            raise MissionError(
                f"cannot {mission.cmd}: the robot is disarmed ({self._current.reason}, {self._current.age_in_words}"
                " ago); arm it first, with: robotctl arm"
            )
        self._current.require(Occasion.START, f"start {mission.doing}")
        if row.needs_base and self._context.robot.drive not in self._arming.armed:
            raise MissionError(
                f"cannot {mission.cmd}: the drive is not armed, and the robot can only look where it stands;"
                " plug it in, then: robotctl arm"
            )
        # Never used twice in a daemon's life: a renewal that comes late must not keep another mission alive.
        self._number += 1
        number = self._number
        report = Reporter(number, mission.kind, row.stops(mission), self._context.publish, self._advised)
        # Bound to this number: the lease of a mission that has ended must not stop the next one.
        lease = self._lease = self._make_lease(lease_s, lambda: self.lease_expired(number))
        self._row = row
        self._stopped_by = None
        self._commander = Commander(client, mission.kind, now_ns(), lease_s)
        # Before the task takes its first step: who asks for the status at once is told that a mission is under
        # way.
        self._current.start(mission.doing, f"mission {number}")
        self._task = asyncio.create_task(self._run(row, mission, report), name=f"mission {number}")
        # A callback and not the end of `_run`: a task that is cancelled before its first step never gets there.
        self._task.add_done_callback(lambda task: self._ended(task, lease, report))
        return number

    def renew(self, mission_id: int) -> None:
        """Keep a mission's lease alive; MissionError if that mission is not under way."""
        if not self.is_busy or mission_id != self._number or self._lease is None:
            why = f" any more: {self._current.reason}" if mission_id == self._number else ""
            raise MissionError(f"mission {mission_id} is not under way{why}")
        self._lease.renew()

    def lease_expired(self, mission_id: int) -> None:
        """Stop the mission whose client fell silent; nothing happens if it has ended."""
        if self.is_busy and mission_id == self._number:
            # Before the note: a stop waits for no note.
            self._stopper.robot.stop_now()
            self._note_cause("lease", {"mission_id": mission_id})
            self._fail(f"the lease of mission {mission_id} expired: its client fell silent")

    def cancel(self, reason: str) -> None:
        """End the mission because the robot was stopped; a mission that stops the robot itself ends by itself."""
        # Cancelled from within, it could not tell its last word.
        if self._task is None or self._task is asyncio.current_task():
            return
        # What comes while it ends does not explain why it ends. Not asked of the task: one whose time for an answer has
        # just run out is being cancelled, too, and not because of that.
        if not self._task.done() and self._stopped_by is None:
            self._stopped_by = reason
        # Said again even if it is ending already: a step that swallowed the first cancellation must not go on.
        self._task.cancel()

    async def ended(self) -> None:
        """Wait until the mission that was stopped has ended."""
        if self._task is not None:
            await asyncio.wait((self._task,))

    async def _run(self, row: MissionRow, mission: Mission, report: Reporter) -> None:
        try:
            report.at(MissionPhase.STARTED)
            message = await row.carry_out(self._host, self._context, mission, report)
            # Held in its last step: devices are armed again by a mission under way, and by nothing else.
            await self._context.hold.over()
        except MissionError as error:  # it cannot be done: the robot stands, and stays armed
            self._current.apply(Occasion.FINISH, str(error))
            report.at(MissionPhase.FAILED, message=str(error))
        except RobotdError as error:
            report.at(MissionPhase.FAILED, message=self._fail(str(error)))
        except Exception as error:
            # A mistake of ours, after which nothing is known of the robot: the stop first, then the traceback.
            self._stopper.halt(Occasion.STOP, f"internal error: {error!r}")
            log.exception("mission %d", report.mission_id)
            report.at(MissionPhase.FAILED, message=self._current.reason)
        else:
            self._current.apply(Occasion.FINISH, message)
            report.at(MissionPhase.DONE, report.stops, message)

    def _fail(self, reason: str) -> str:
        reason = self._holding.blamed(reason)
        self._stopper.halt(Occasion.STOP, reason)
        return reason

    def _advised(self, step: MissionProgress) -> MissionProgress:
        return with_advice(step, self._context.whereabouts.map_in_use)

    def _ended(self, task: asyncio.Task[None], lease: Lease, report: Reporter) -> None:
        """Take the lease back; a mission may be cancelled before its first step, and that is an end too."""
        lease.end()
        if task.cancelled():
            report.at(MissionPhase.STOPPED, message=self._stopped_by or "")
