"""Where a recording may go: below one directory, and not among the maps, whatever a client asks for."""

import os
from pathlib import Path

from robotd.core.errors import RecordingError


def make_place(directory: Path, name: str, kept_out: Path) -> Path:
    """Return the file to record to, and make the directories it lies in.

    Args:
        directory: what recordings go below.
        name: the file, from there on; or its whole path.
        kept_out: a directory that holds something else, the maps.

    Raises:
        RecordingError: the file lies elsewhere, if only through a link; or the directories cannot be made.
    """
    # `..` is refused even where it stays below: behind a link it leads elsewhere than it reads.
    if "\0" in name or ".." in Path(name).parts:
        raise _elsewhere(directory, name)
    # Compared as they really lie: a link among the recordings could lead anywhere.
    root, file = _real(directory), _real(directory / name)
    if root not in file.parents or file.is_relative_to(_real(kept_out)):
        raise _elsewhere(directory, name)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RecordingError(f"cannot record to {str(file.parent)!r}: {error.strerror}") from error
    return file


def _real(path: Path) -> Path:
    return Path(os.path.realpath(path))  # which takes links that lead in a circle, other than Path.resolve


def _elsewhere(directory: Path, name: str) -> RecordingError:
    return RecordingError(
        f"cannot record to {name!r}: recordings go below {directory} (recording.dir) alone, and not among the maps;"
        " name a file to be made there"
    )
