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
    """Return the first difference in words; a recording that was cut may have lost what its last inputs led to."""
    if report.differences:
        return str(report.differences[0])
    if was_cut:
        return None
    if not report.complete:
        return "the recording is not complete"
    return None if report.digest == report.recorded_digest else "the digests of the results differ"
