"""Raw odometry at the scans of a log: chained out of a corrected log, or between the ODOM lines about a scan."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from robotd.core.angles import wrap_rad
from robotd.core.pose import IDENTITY, Pose2
from robotd.logs.records import Odom


@dataclass(slots=True)
class OdometryTrack:
    """The ODOM lines in file order, and where in them the scans came.

    In corrected logs (GMapping) an ODOM after each scan copies the scan's pose, and the next ones are raw odometry of
    the *laser*, begun again there: the steps between the copies are chained back into one path.
    """

    lines: list[Odom] = field(default_factory=list)
    """What the ODOM lines say; copies of a scan's pose are left out."""
    copies: int = 0
    """How many copied the pose of the scan before them."""
    chained: Pose2 = IDENTITY
    """The path so far."""
    _last: Pose2 | None = None
    _scan: Pose2 | None = None

    def take(self, odom: Odom) -> None:
        """Take the next ODOM line."""
        # Equal to the last bit: a copy is written by the same program from the same number, a measurement
        # never.
        if self._scan is not None and odom.pose == self._scan:
            self.copies += 1  # no measurement: from here on odometry is told from this pose
        else:
            self.lines.append(odom)
            self.chained = odom.pose if self._last is None else self.chained @ self._last.inverse() @ odom.pose
        self._last = odom.pose
        self._scan = None

    def pass_scan(self, laser_pose: Pose2 | None) -> None:
        """Note that a scan stands here in the file."""
        self._scan = laser_pose


def pose_between(lines: Sequence[Odom], after: int, time_s: float | None) -> Pose2 | None:
    """Return where the wheels believed to be at a time.

    Args:
        lines: the ODOM lines in file order, which alone is right: clocks of logs jump, or stand still.
        after: how many of them stand before the scan in the file.
        time_s: when the scan was taken; None, or a time that fits nowhere near, is for the line before the scan.
    """
    if not lines:
        return None
    at = min(max(after - 1, 0), len(lines) - 1)
    if time_s is None:
        return lines[at].pose
    # Looked for beside the place in the file, and no farther than times ascend: a clock that jumped would lead
    # anywhere.
    while at + 2 < len(lines) and _ascends(lines, at) and _time(lines, at + 1) <= time_s:
        at += 1
    while at > 0 and _ascends(lines, at - 1) and _time(lines, at) > time_s:
        at -= 1
    if at + 1 == len(lines) or not _ascends(lines, at):
        return lines[at].pose
    share = (time_s - _time(lines, at)) / (_time(lines, at + 1) - _time(lines, at))
    return _between(lines[at].pose, lines[at + 1].pose, min(max(share, 0.0), 1.0))


def _time(lines: Sequence[Odom], at: int) -> float:
    time_s = lines[at].time_s
    return 0.0 if time_s is None else time_s


def _ascends(lines: Sequence[Odom], at: int) -> bool:
    here_s, next_s = lines[at].time_s, lines[at + 1].time_s
    return here_s is not None and next_s is not None and here_s < next_s


def _between(one: Pose2, other: Pose2, share: float) -> Pose2:
    turned_rad = wrap_rad(other.heading_rad - one.heading_rad)
    return Pose2(
        one.x_m + share * (other.x_m - one.x_m),
        one.y_m + share * (other.y_m - one.y_m),
        wrap_rad(one.heading_rad + share * turned_rad),
    )
