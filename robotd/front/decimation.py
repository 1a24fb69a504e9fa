"""Routine news at a bearable rate: odometry 20 times a second is enough for a reader; what is rare is never thinned."""

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import SweepProgress
from robotd.contract.topics import Published
from robotd.core.clock import NS_PER_S
from robotd.core.pose import Odometry


class Decimator:
    """Lets routine events of each type through at most ``rate_hz`` in the mean, by their own time stamps."""

    def __init__(self, rate_hz: float) -> None:
        self._period_ns = round(NS_PER_S / rate_hz)
        self._last_ns: dict[type[Published], int] = {}
        """Of each type that passed."""
        self._due_ns: dict[type[Published], int] = {}
        """When the next one of each type passes."""

    def passes(self, event: Published) -> bool:
        """Return whether an event is to be published."""
        if not is_routine(event):
            return True
        kind, at_ns = type(event), event.time_ns
        due_ns = self._due_ns.get(kind, at_ns)
        # An event older than the last passes: one time stamp far ahead would else silence its type for as long.
        is_older = at_ns < self._last_ns.get(kind, at_ns)
        if at_ns < due_ns and not is_older:
            return False
        # From when it was due: from now on, of events each 40 ms only every second one would come 50 ms after another.
        is_on_time = not is_older and at_ns - due_ns < self._period_ns
        self._due_ns[kind] = (due_ns if is_on_time else at_ns) + self._period_ns
        self._last_ns[kind] = at_ns
        return True


def is_routine(event: Published) -> bool:
    """Return whether another event like this one follows soon, and says more."""
    match event:
        case Odometry():
            return True
        case SweepProgress(taken=taken, total=total):
            return taken < total
        case PoseEstimate(state=state):
            return state is PoseState.PREDICTED
        case _:
            return False
