"""Logs of other programs on the command line: how they are read, and what is said of them."""

import argparse
import math
from dataclasses import dataclass
from pathlib import Path

from robotd.cli.quantities import positive
from robotd.cli.show.terminal import complain
from robotd.core.errors import RecordingError
from robotd.logs.scan import RecordedLog
from robotd.sim.buildings.log_file import read_log

LOG_HELP = (
    "a CARMEN log or a CSV of sweeps, as it is or packed (.gz, .bz2, .xz), - is standard input; "
    "or a bag of ROS: a .bag, or the directory of one of ROS 2"
)
RAW_HELP = "take a log whose poses are raw odometry all the same"


@dataclass(frozen=True, slots=True)
class Reading:
    """How logs are read."""

    range_max_m: float
    """Believe no range beyond; ``inf`` believes all that the log does not call a miss."""
    fov_rad: float | None
    """What the scanner sees; None where the log says it."""
    scan_topic: str | None
    """Which scanner of a bag; None for the one that scanned most."""

    @classmethod
    def of(cls, arguments: argparse.Namespace) -> "Reading":
        """Return what the options of :func:`reading_arguments` say."""
        fov_rad = None if arguments.fov_deg is None else math.radians(arguments.fov_deg)
        range_max_m = math.inf if arguments.range_max is None else arguments.range_max
        return cls(range_max_m, fov_rad, arguments.scan_topic)

    def read(self, path: Path) -> RecordedLog:
        """Read a log, and say on standard error what must be said of it.

        Raises:
            RecordingError: it cannot be read, or no scan in it is whole.
        """
        log = self.reread(path)
        for remark in log.remarks():
            complain(f"{path}: {remark}")
        return log

    def reread(self, path: Path) -> RecordedLog:
        """Read a log of which everything was said before.

        Raises:
            RecordingError: it cannot be read, or no scan in it is whole.
        """
        return read_log(path, fov_rad=self.fov_rad, scan_topic=self.scan_topic).believed_to(self.range_max_m)


def reading_arguments(parser: argparse.ArgumentParser, range_max_m: float | None = None) -> None:
    """Take what a log of any kind may not say itself."""
    range_max_argument(parser, range_max_m)
    fov_argument(parser)
    scan_topic_argument(parser)


def range_max_argument(parser: argparse.ArgumentParser, range_max_m: float | None = None) -> None:
    """Take how far ranges are believed."""
    parser.set_defaults(fov_deg=None, scan_topic=None)  # of other kinds of logs
    default = "all that the log has" if range_max_m is None else f"{range_max_m:g}"
    parser.add_argument(
        "--range-max",
        type=positive,
        default=range_max_m,
        metavar="M",
        help=f"believe no range beyond this [m]; such a beam met nothing (default: {default})",
    )


def fov_argument(parser: argparse.ArgumentParser) -> None:
    """Take what the scanner of a CARMEN log sees."""
    parser.add_argument(
        "--fov-deg",
        type=_field_of_view,
        metavar="DEG",
        help="what the scanner of a CARMEN log sees, from its first beam to its last [deg] (default: what the log "
        "says, else by the number of beams)",
    )


def scan_topic_argument(parser: argparse.ArgumentParser) -> None:
    """Take which scanner of a bag is meant."""
    parser.add_argument(
        "--scan-topic", metavar="TOPIC", help="which scanner of a bag (default: the one that scanned most)"
    )


def refuse_raw_odometry(path: Path, log: RecordedLog) -> None:
    """Refuse a log whose poses are no truth.

    Raises:
        RecordingError: they are raw odometry.
    """
    if log.is_raw_odometry:
        raise RecordingError(
            f"{path}: its poses are raw odometry ({log.why}), and no truth; --raw takes them all the same"
        )


def _field_of_view(text: str) -> float:
    degrees = positive(text)
    if not 1.0 <= degrees <= 360.0:
        raise argparse.ArgumentTypeError(f"must be from 1 to 360, got {text}")
    return degrees
