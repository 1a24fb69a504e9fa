"""Routine news at a bearable rate: odometry 20 times a second is enough for a reader; what is rare is never thinned."""

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import SweepProgress
from robotd.contract.topics import Published
from robotd.core.clock import NS_PER_S
from robotd.core.pose import Odometry


class Decimator:
    """Lets routine events of each type through at most ``rate_hz``, by their own time stamps."""

    def __init__(self, rate_hz: float) -> None:
        self._period_ns = round(NS_PER_S / rate_hz)
        self._passed_ns: dict[type[Published], int] = {}

    def passes(self, event: Published) -> bool:
        """Return whether an event is to be published."""
        if not is_routine(event):
            return True
        before_ns = self._passed_ns.get(type(event))
        # An event older than the last passes: one time stamp far ahead would else silence its type for as long.
        if before_ns is not None and 0 <= event.time_ns - before_ns < self._period_ns:
            return False
        self._passed_ns[type(event)] = event.time_ns
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
