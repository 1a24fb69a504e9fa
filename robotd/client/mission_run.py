"""A client's side of a mission under way, without sockets: when to renew the lease, what concerns it, how it ended.

Nothing is left to a single message: the end is published, and every renewal is answered with the mission's latest
progress as well, so a reader that missed the one hears the other.
"""

from robotd.client.feed import Gap
from robotd.contract.answers import MissionStarted, Renewed
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import MissionPhase, MissionProgress, RangeMeasured, Status, SweepDone, SweepProgress
from robotd.contract.explored import ExploringEnded, StopChosen
from robotd.contract.topics import Published, Topic
from robotd.core.errors import MissionError, ServerError
from robotd.core.reading import Sweep

MISSION_TOPICS = (Topic.MISSION, Topic.SWEEP, Topic.POSE)
"""What a mission's client listens to."""
MissionEvent = (
    MissionProgress | SweepProgress | SweepDone | RangeMeasured | PoseEstimate | StopChosen | ExploringEnded | Status
)
"""What a mission's client is told; a status when the mission is held, and when it goes on."""

_RENEWALS_PER_LEASE = 4
"""Two in a row may be lost, and the third still comes in time."""
_GRACE_S = 0.2
"""How long published messages may lag behind the reply that the mission is over."""


class MissionRun:
    """One mission, followed to its end."""

    def __init__(self, started: MissionStarted, now_s: float) -> None:
        self.mission_id = started.mission_id
        self.is_over = False
        self._lease_s = started.lease_s
        self._period_s = started.lease_s / _RENEWALS_PER_LEASE
        self._late_s = 0.0
        """By how much a renewal was late at most; it tells our own fault from the daemon's."""
        self._held: str | None = None
        """Why the mission was held when a status said so last: only a change is news."""
        self._next_s = now_s + self._period_s
        self._has_begun = False
        """Whether its first word came: sweeps and poses before that are of another mission."""
        self._end: MissionProgress | None = None

    @property
    def is_ending(self) -> bool:
        """Whether the end is known: there is nothing to renew any more, though messages may still come."""
        return self._end is not None

    def wait_s(self, now_s: float) -> float:
        """Return how long to wait for a message at most before the next look at :meth:`is_due` or :meth:`overdue`."""
        return max(0.0, self._next_s - now_s)

    def is_due(self, now_s: float) -> bool:
        """Return whether to renew the lease now."""
        if self.is_ending or now_s < self._next_s:
            return False
        self._late_s = max(self._late_s, now_s - self._next_s)
        return True

    def refused(self, error: ServerError) -> ServerError:
        """Return why a renewal was refused, and what we have to do with it."""
        return ServerError(error.code, self._blamed(error.message))

    def renewed(self, answer: Renewed, now_s: float) -> None:
        """Take the answer to a renewal."""
        if answer.mission is not None and answer.mission.is_last:
            self._end = answer.mission
            self._next_s = now_s + _GRACE_S
        else:
            self._next_s = now_s + self._period_s

    def accept(self, event: Published | Gap) -> MissionEvent | None:
        """Return a published event if it concerns the mission; nothing does before the mission's own first word."""
        if isinstance(event, MissionProgress):
            if event.mission_id != self.mission_id:
                return None
            self._has_begun = True
            self._conclude(event)
        if isinstance(event, Status) and not self._is_news(event):
            return None
        return event if self._has_begun and isinstance(event, MissionEvent) else None

    def overdue(self, now_s: float) -> MissionProgress | None:
        """Return the end of the mission if it is known from a renewal and its message must have been missed."""
        if self.is_over or self._end is None or now_s < self._next_s:
            return None
        self._conclude(self._end)
        return self._end

    def check(self) -> None:
        """Return if the mission was done.

        Raises:
            MissionError: it was stopped, or it failed; says why.
        """
        if self._end is not None and self._end.phase is not MissionPhase.DONE:
            raise MissionError(f"{self._end.kind} {self._end.phase}: {self._blamed(self._end.message)}")

    def _is_news(self, status: Status) -> bool:
        """Return whether the mission has begun to be held since, or has gone on."""
        if status.mission_id != self.mission_id or not self._has_begun or status.held == self._held:
            return False
        self._held = status.held
        return True

    def _blamed(self, message: str) -> str:
        """Return a reason with what we have to do with it: we renewed so late that no lease outlasts it."""
        if self._period_s + self._late_s < self._lease_s:
            return message
        return (
            f"{message}; this program renewed its lease of {self._lease_s:g} s late by {self._late_s:.1f} s: it got no"
            " processor, or did not ask for the next event; the daemon's log has more; continue with: robotctl arm"
            " (after a fault robotctl clear first), then the mission again"
        )

    def _conclude(self, progress: MissionProgress) -> None:
        if progress.is_last:
            self._end = progress
            self.is_over = True


def final_estimate(events: list[MissionEvent]) -> PoseEstimate:
    """Return what a localization found: the last estimate of a whole sweep.

    Raises:
        MissionError: there is none.
    """
    for event in reversed(events):
        if isinstance(event, PoseEstimate) and event.final and event.state is not PoseState.PREDICTED:
            return event
    raise MissionError("the mission ended without an estimate")


def ranges_measured(events: list[MissionEvent]) -> tuple[RangeMeasured, ...]:
    """Return what was measured along the beam, in order."""
    return tuple(event for event in events if isinstance(event, RangeMeasured))


def last_sweep(events: list[MissionEvent]) -> Sweep:
    """Return the sweep that was taken; the last, where one was taken again.

    Raises:
        MissionError: there is none.
    """
    for event in reversed(events):
        if isinstance(event, SweepDone):
            return event.sweep
    raise MissionError("the mission ended without a sweep")
