"""What a log of another program comes to: its scans, where their poses are from, and what must be said of it."""

import enum
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2

_NAMED_LINES = 5
"""Damaged lines that are named; of more only the number is told."""


class PoseSource(enum.StrEnum):
    """Where the poses of a log are from."""

    LOG = "log"
    """The log's own, and nothing speaks against them."""
    CORRECTED = "corrected"
    """A mapping program's: the log shows both them and the odometry that they correct."""
    RAW_ODOMETRY = "raw odometry"
    """What the wheels believed: metres and degrees off after a while."""


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """One turn of the recorded scanner."""

    robot_pose: Pose2
    """The robot's pose as the log has it: corrected, in a corrected log."""
    robot_from_laser: Pose2
    """Where the scanner sits on the robot."""
    odometry: Pose2
    """Raw odometry at the scan; continuous over the log."""
    angles_rad: NDArray[np.float64]
    """Directions of the beams in the laser's frame, ascending, ``float64[n]``, at least two; evenly, but for how well a
    head aims."""
    ranges_m: NDArray[np.float64]
    """Ranges ``float64[n]``; they mean something only where ``hit``."""
    hit: NDArray[np.bool_]
    """Where something came back, ``bool[n]``."""
    missed: NDArray[np.bool_]
    """Where nothing came back, ``bool[n]``; neither hit nor missed is a failed measurement."""
    time_s: float | None = None
    """When the log says that it was taken; such times may run backwards, and file order is right all the same."""

    @property
    def step_rad(self) -> float:
        """From beam to beam."""
        return float(self.angles_rad[-1] - self.angles_rad[0]) / (len(self.angles_rad) - 1)

    @property
    def laser_pose(self) -> Pose2:
        """Where the scanner was, in the frame of ``robot_pose``."""
        return self.robot_pose @ self.robot_from_laser


@dataclass(frozen=True, slots=True)
class Problem:
    """A line that was left out because it is damaged."""

    line: int
    """Its number, from 1."""
    message: str

    def __str__(self) -> str:
        """Say which and why."""
        return f"line {self.line}: {self.message}"


@dataclass(frozen=True, slots=True)
class RecordedLog:
    """The scans of a log, in file order."""

    scans: tuple[Scan, ...]
    no_return_from_m: float
    """Ranges from here on meant that nothing came back; ``inf`` where the log has no such code."""
    poses: PoseSource = PoseSource.LOG
    why: str = ""
    """How it is known where the poses are from."""
    problems: tuple[Problem, ...] = ()
    """The damaged lines, left out, in file order: the first of them."""
    damaged_lines: int = 0
    """How many there are."""
    assumed: tuple[str, ...] = ()
    """What the log does not say and was taken for granted, a line each."""

    @property
    def is_raw_odometry(self) -> bool:
        """Whether the poses are those of the wheels."""
        return self.poses is PoseSource.RAW_ODOMETRY

    def remarks(self) -> Iterator[str]:
        """Yield what people must be told of it, a line each."""
        if self.problems:
            lines = "a damaged line was" if self.damaged_lines == 1 else f"{self.damaged_lines} damaged lines were"
            named = "; ".join(map(str, self.problems[:_NAMED_LINES]))
            yield f"{lines} left out: {named}{'; ...' * (self.damaged_lines > _NAMED_LINES)}"
        yield from self.assumed
        if self.is_raw_odometry:
            yield f"ITS POSES ARE RAW ODOMETRY ({self.why}): a map made with them is bent, and none is the truth"

    def believed_to(self, range_max_m: float) -> "RecordedLog":
        """Return the log with every range beyond ``range_max_m`` as that of a beam that met nothing."""
        return replace(self, scans=tuple(_cut_off(scan, range_max_m) for scan in self.scans))


def _cut_off(scan: Scan, range_max_m: float) -> Scan:
    beyond = scan.hit & (scan.ranges_m > range_max_m)
    if not beyond.any():
        return scan
    # A miss and not a failure: the beam went that far, and met nothing on its way.
    return replace(scan, hit=scan.hit & ~beyond, missed=scan.missed | beyond)
