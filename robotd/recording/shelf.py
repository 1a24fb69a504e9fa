"""What was recorded below one directory: listed, and removed one by one. Blocks on the disk: call it on a thread."""

import os
from collections.abc import Iterator
from pathlib import Path

from robotd.contract.answers import RecordingInfo, RecordingList
from robotd.core.errors import RecordingError

_SUFFIX = ".mcap"
_LISTED = 1000
"""What people look through; of older ones only their number is told."""


def list_recordings(directory: Path, kept_out: Path, under_way: Path | None) -> RecordingList:
    """Return the recordings below a directory, the newest first.

    Args:
        directory: where they are; it need not exist yet.
        kept_out: a directory in it that holds something else, the maps.
        under_way: the file that is being recorded to.
    """
    found = sorted(_found(directory, kept_out, under_way), key=lambda one: (-one.changed_unix_ns, one.path))
    return RecordingList(tuple(found[:_LISTED]), max(0, len(found) - _LISTED))


def _found(directory: Path, kept_out: Path, under_way: Path | None) -> Iterator[RecordingInfo]:
    # Links are not followed, and what cannot be read is left out: one odd entry is no reason to list no other.
    for folder, folders, files in os.walk(directory):
        folders[:] = [name for name in folders if not name.startswith(".") and Path(folder, name) != kept_out]
        for path in (Path(folder, name) for name in files if name.endswith(_SUFFIX)):
            try:
                about = path.lstat()
            except OSError:
                continue
            is_open = under_way is not None and os.path.realpath(path) == os.path.realpath(under_way)
            name = str(path.relative_to(directory))
            if path.is_file() and not path.is_symlink() and name.isprintable():
                yield RecordingInfo(name, about.st_size, about.st_mtime_ns, is_open)


def delete_recording(directory: Path, kept_out: Path, under_way: Path | None, name: str) -> None:
    """Remove a recording that :func:`list_recordings` lists.

    Raises:
        RecordingError: it is not listed, is under way, or the disk refused.
    """
    # Looked for, not put together: then no name leads anywhere else.
    one = next((found for found in _found(directory, kept_out, under_way) if found.path == name), None)
    if one is None:
        raise RecordingError(f"there is no recording {name!r} below {directory}")
    if one.is_open:
        raise RecordingError(f"{name!r} is being recorded: stop that first, with: robotctl record stop")
    try:
        (directory / name).unlink()
    except OSError as error:
        raise RecordingError(f"cannot delete {name!r}: {error.strerror or error}") from error
