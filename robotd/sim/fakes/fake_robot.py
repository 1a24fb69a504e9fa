"""A recorded robot, to be hosted like an emulated one."""

from collections.abc import Mapping

from robotd.core.errors import RecordingError
from robotd.core.pose import IDENTITY, Pose2
from robotd.recording.comparison import Difference
from robotd.recording.reader import Recording
from robotd.sim.emulators.catalogue import OWN
from robotd.sim.fakes.fake_boards import fake_boards
from robotd.sim.hosting.board_clock import BoardClock
from robotd.sim.physics.walls import Point


class FakeRobot:
    """Three fake boards. Where the robot truly stood was not recorded."""

    def __init__(self, recording: Recording, dialects: Mapping[str, str]) -> None:
        """Take the parts of all boards.

        Args:
            recording: what the boards said.
            dialects: what each recorded device spoke.

        Raises:
            RecordingError: the recording holds no serial line of a device that we know, or a device spoke another
                protocol than our own, in which a fake knows no request from another.
        """
        _check_our_own(dialects)
        self.boards = fake_boards(recording)
        self.clocks = {device: BoardClock() for device in self.boards}
        self.start = IDENTITY
        self.stops_m: tuple[Point, ...] = ()
        self.probes_m: tuple[Point, ...] = ()

    @property
    def mismatches(self) -> tuple[Difference, ...]:
        """Requests that were not the recorded ones, in order of the recording's time."""
        found = (difference for board in self.boards.values() for difference in board.mismatches)
        return tuple(sorted(found, key=lambda difference: difference.time_ns))

    @property
    def finished(self) -> bool:
        """Whether the host has come to the end of the recording on every line."""
        return all(board.finished for board in self.boards.values())

    @property
    def truth(self) -> Pose2:
        """It is not known: the origin."""
        return IDENTITY

    @property
    def at_rest(self) -> bool:
        """Never, so that nothing notes a truth that is not known."""
        return False


def _check_our_own(dialects: Mapping[str, str]) -> None:
    others = [f"a {device} that speaks {dialect}" for device, dialect in dialects.items() if dialect != OWN]
    if others:
        raise RecordingError(
            f"the recording is of {', '.join(others)}: a fake answers for our own boards alone (dialect {OWN});"
            " robotctl replay runs the daemon on what any device said"
        )
