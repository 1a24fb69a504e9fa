"""What verbs write: never over a file of another kind or one that is read; beside the old one first, then in its place.

Options for files and directories are declared by :func:`output_argument`, and :func:`refuse` looks at all of a command
line before its verb begins: a slip of the shell must not cost a log.
"""

import argparse
import os
import stat
import tempfile
import zlib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path, PosixPath

from robotd.core.errors import RobotdError

STANDARD_OUTPUT = "-"
CONFIG_MARK = "# Made by robotctl"
"""What a configuration begins with that a verb wrote, and may write again."""
DEMO_MARK = ".robotd-demo"
"""What is in a directory that a demonstration made, and may clear again."""
_HEAD_BYTES = 1024
_GZIP = zlib.MAX_WBITS | 16


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of file or directory that verbs write."""

    name: str
    """With its article: ``a PNG picture``."""
    is_one: Callable[[bytes], bool] | None = None
    """Whether a file that begins so is one; None for a directory."""
    may_hold: Callable[[set[str]], bool] | None = None
    """Whether a directory that holds such names is one; None if it may be any."""


def _is_building(head: bytes) -> bool:
    with suppress(zlib.error):
        return zlib.decompressobj(_GZIP).decompress(head, _HEAD_BYTES).startswith(b'{"log":')
    return False


def _is_demo(names: set[str]) -> bool:
    return DEMO_MARK in names or {"robotd.log", "truth.jsonl"} <= names


PNG = Kind("a PNG picture", lambda head: head.startswith(b"\x89PNG"))
EVAL_LINES = Kind("a file of JSON lines of eval", lambda head: head.startswith(b'{"parameters":'))
TRUTH_LINES = Kind("a file of true poses", lambda head: head.startswith(b'{"t_ns":'))
RECORDED_BUILDING = Kind("a recorded building", _is_building)
MADE_CONFIG = Kind("a configuration made by robotctl", lambda head: head.startswith(CONFIG_MARK.encode()))
PICTURES = Kind("a directory for pictures")
LINKS = Kind("a directory for links")
DEMO = Kind("the directory of a demonstration", may_hold=_is_demo)


class OutputPath(PosixPath):
    """Where a verb was told to write."""

    kind: Kind


def output_argument(
    parser: argparse.ArgumentParser,
    name: str,
    kind: Kind | Callable[[Path], Kind],
    summary: str,
    **others: object,
) -> None:
    """Take the name of a file to write, or of a directory to write into; the name may tell which of several kinds."""

    def path(text: str) -> OutputPath:
        found = OutputPath(text)
        found.kind = kind if isinstance(kind, Kind) else kind(found)
        return found

    metavar = "DIR" if isinstance(kind, Kind) and kind.is_one is None else "FILE"
    parser.add_argument(name, type=path, help=summary, **{"metavar": metavar, **others})  # type: ignore[arg-type]  # as argparse takes them


def refuse(arguments: argparse.Namespace) -> None:
    """Refuse a command line that would write over what is not of that kind, or over what it reads.

    Raises:
        RobotdError: it would; nothing was written.
    """
    given = list(_paths(vars(arguments).values()))
    outputs = [path for path in given if isinstance(path, OutputPath) and str(path) != STANDARD_OUTPUT]
    for number, output in enumerate(outputs):
        check(output, output.kind)
        for other in (*outputs[:number], *(path for path in given if not isinstance(path, OutputPath))):
            _refuse_same(output, other)


def check(path: Path, kind: Kind) -> None:
    """Refuse to write where something else is.

    Raises:
        RobotdError: there is a file of another kind, or a directory in place of a file, or the other way round.
    """
    try:
        mode = path.stat().st_mode
        if kind.is_one is None:
            _check_directory(path, kind, mode)
        elif stat.S_ISDIR(mode):
            raise RobotdError(f"{path}: is a directory; {kind.name} was to be written there")
        elif stat.S_ISREG(mode):
            with path.open("rb") as file:
                head = file.read(_HEAD_BYTES)
            # An empty file may be written over: `mktemp` makes one.
            if head and not kind.is_one(head):
                raise RobotdError(f"{path}: is there, and is not {kind.name}; it is left as it is")
    except FileNotFoundError:
        return
    except OSError as error:
        raise RobotdError(f"{path}: {error.strerror}") from error


def _check_directory(path: Path, kind: Kind, mode: int) -> None:
    if not stat.S_ISDIR(mode):
        raise RobotdError(f"{path}: is a file, not {kind.name}; it is left as it is")
    names = {entry.name for entry in path.iterdir()}
    if names and kind.may_hold is not None and not kind.may_hold(names):
        raise RobotdError(f"{path}: is not empty, and is not {kind.name}; it is left as it is")


def _refuse_same(output: OutputPath, other: Path) -> None:
    """Refuse an output that is another file of the command line, by whatever name, or would clear it away."""
    with suppress(OSError):
        if stat.S_ISREG(other.stat().st_mode) and other.samefile(output):
            raise RobotdError(f"{output}: would be written over {other}, which this very command line names, too")
    if output.kind.may_hold is not None and other.exists() and other.resolve().is_relative_to(output.resolve()):
        raise RobotdError(f"{other}: lies in {output}, which is cleared first")


def _paths(values: Iterable[object]) -> Iterator[Path]:
    """Yield what may name a file among the values of a command line: worlds are names or files."""
    for value in values:
        if isinstance(value, Path):
            yield value
        elif isinstance(value, str) and "\0" not in value:
            yield Path(value)
        elif isinstance(value, list | tuple):
            yield from _paths(value)


def write(path: Path, content: bytes) -> None:
    """Write a file whole or not at all, in a directory that is made if it is not there.

    What is no plain file, such as a terminal, a pipe or ``/dev/stdout``, is written to as it is; a link stays one.

    Raises:
        RobotdError: it cannot be written; an older one is as it was.
    """
    try:
        # A pipe cannot be replaced by a file, and somebody reads at its other end.
        if path.exists() and (not path.is_file() or path.is_relative_to("/dev")):
            path.write_bytes(content)
            return
        # Through links: what is replaced is the file, and the link still leads to it.
        path = path.resolve()
        path.parent.mkdir(parents=True, exist_ok=True)
        _replace(path, content)
    except OSError as error:
        raise RobotdError(f"cannot write {path}: {error.strerror or error}") from error


def part_of(path: Path) -> Path:
    """Return where a file is while it is written piece by piece."""
    return path.with_name(f"{path.name}.part")


@contextmanager
def writing(path: Path) -> Iterator[Callable[[bytes], None]]:
    """Write a file piece by piece, beside the old one first and in its place at the end, whatever ends it but a kill.

    Each piece is handed to the system at once, so what a killed program has written is beside it, named ``.part``.

    Raises:
        RobotdError: it cannot be written; an older one is as it was.
    """
    part = part_of(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with part.open("wb") as file:

            def piece(content: bytes) -> None:
                file.write(content)
                file.flush()

            try:
                yield piece
            finally:
                os.fsync(file.fileno())
        part.replace(path)
    except OSError as error:
        raise RobotdError(f"cannot write {path}: {error.strerror or error}") from error


def _replace(path: Path, content: bytes) -> None:
    # A temporary file is for its owner alone; what takes the place of another keeps who may read it.
    mode = stat.S_IMODE(path.stat().st_mode) if path.exists() else 0o666 & ~_umask()
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with open(handle, "wb") as file:  # noqa: PTH123  # a descriptor, not a path
            file.write(content)
            file.flush()
            os.fchmod(file.fileno(), mode)
            os.fsync(file.fileno())
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
