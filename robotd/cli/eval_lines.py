"""The JSON lines of ``eval``: written as results come, and read again to go on where a run was ended."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from robotd.cli.outputs import STANDARD_OUTPUT, part_of, write, writing
from robotd.core.errors import RobotdError
from robotd.evaluation.answered import Answered

Say = Callable[[dict[str, Any]], None]


@contextmanager
def result_lines(file: Path | None) -> Iterator[Say]:
    """Say documents as JSON lines, each as soon as it is known, to a file, to standard output, or to nobody."""
    if file is None:
        yield lambda _: None
    elif is_standard_output(file):
        yield lambda document: print(_line(document), flush=True)
    else:
        with writing(file) as write_piece:
            yield lambda document: write_piece(f"{_line(document)}\n".encode())


def answered_before(file: Path | None) -> Answered:
    """Return what a run answered that wrote this file; of one that was killed, what it had written so far.

    That goes into the file itself: another kill is to lose nothing of it while it is written once more, in order.

    Raises:
        RobotdError: there is no file to go on with, or it cannot be read.
    """
    if file is None or is_standard_output(file):
        raise RobotdError("--resume goes on with a file of lines: name it by --json")
    part = part_of(file)
    try:
        lines = [
            line for path in (file, part) if path.exists() for line in path.read_text(errors="replace").splitlines()
        ]
        if part.exists():
            write(file, "".join(f"{line}\n" for line in lines).encode())
    except OSError as error:
        raise RobotdError(f"cannot read {error.filename}: {error.strerror}") from error
    return Answered.of_lines(lines)


def is_standard_output(file: Path | None) -> bool:
    """Whether lines go to standard output, in place of the tables."""
    return str(file) == STANDARD_OUTPUT


def _line(document: dict[str, Any]) -> str:
    return json.dumps(document, allow_nan=False)
