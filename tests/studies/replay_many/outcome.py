"""What became of a session: whether its replay differed, and from what."""

from dataclasses import dataclass
from pathlib import Path

from robotd.app.replaying import ReplayReport


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a session."""

    seed: int
    done: tuple[str, ...]
    """What was done to the daemon, in order."""
    differs: str | None
    """The first difference of its replay; None if there is none."""
    results: int
    kept: Path | None = None
    """Where its recording is kept, if it is."""


def difference(report: ReplayReport, *, was_cut: bool = False) -> str | None:
    """Return the first difference in words.

    The digests say no more: where no result differs, they can do so only by results that the recorded daemon had no
    time for, within a tenth of a second before its recording ended.

    Args:
        report: of the replay.
        was_cut: the daemon was killed, and the recording is not complete.
    """
    if report.differences:
        return str(report.differences[0])
    return None if report.complete or was_cut else "the recording is not complete"
