"""What verbs read: whether it is there is seen before anything is loaded that would make sense of it."""

import argparse
import errno
import os
from collections.abc import Iterable
from pathlib import Path, PosixPath

STANDARD_INPUT = "-"
RECORDING_HELP = "a recording (.mcap)"


class InputPath(PosixPath):
    """What a verb was told to read: a file, or a directory that is read as one."""


def input_argument(parser: argparse.ArgumentParser, name: str, summary: str, **others: object) -> None:
    """Take the name of what is read."""
    parser.add_argument(name, type=InputPath, help=summary, **others)  # type: ignore[arg-type]  # as argparse takes them


def require(values: Iterable[object]) -> None:
    """Look whether all that is to be read is there.

    Raises:
        OSError: something is not, or may not be read; names it.
    """
    for value in values:
        if isinstance(value, InputPath) and str(value) != STANDARD_INPUT:
            _require(value)
        elif isinstance(value, list):
            require(value)


def _require(path: Path) -> None:
    path.stat()
    if not os.access(path, os.R_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
