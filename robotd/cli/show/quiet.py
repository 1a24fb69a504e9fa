"""What of all that is published is news to somebody who watches."""

from robotd.client.feed import Gap
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import Status, SweepProgress
from robotd.contract.topics import Published
from robotd.core.pose import Odometry


class Quiet:
    """Lets through what changes: no routine, and no status that says what the last one did."""

    def __init__(self) -> None:
        self._said: tuple[object, ...] = ()

    def lets(self, event: Published | Gap) -> bool:
        """Return whether to show an event."""
        match event:
            case Odometry() | SweepProgress():
                return False
            case PoseEstimate():
                return event.final and event.state is not PoseState.PREDICTED
            case Status():
                faults = tuple((device.name, device.link, device.faults) for device in event.devices)
                said, self._said = self._said, (event.mode, event.reason, event.held, faults)
                return said != self._said
            case _:
                return True
