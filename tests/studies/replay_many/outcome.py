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


def difference(report: ReplayReport, *, was_cut: bool = False, was_ended: bool = False) -> str | None:
    """Return the first difference in words.

    Args:
        report: of the replay.
        was_cut: the daemon was killed, and the recording is not complete.
        was_ended: the daemon ended before the recording did: it may have had no time for what its last inputs led to,
            and then the replay has more results than the recording, which is no difference.
    """
    if report.differences:
        return str(report.differences[0])
    if not report.complete and not was_cut:
        return "the recording is not complete"
    if was_cut or was_ended:
        return None
    return None if report.digest == report.recorded_digest else "the digests of the results differ"
