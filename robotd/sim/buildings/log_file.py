"""Open a log of another program: a text, plain or compressed, whatever its name says, or from standard input; or a bag.

Any byte may stand in a comment; what is neither text nor bag is named for what it is.
"""

import bz2
import gzip
import io
import lzma
import sys
import zlib
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from itertools import chain
from pathlib import Path
from typing import BinaryIO, cast

from robotd.core.errors import RecordingError
from robotd.interop.ros_bag import read_bag
from robotd.logs.carmen import parse_carmen
from robotd.logs.records import LINE_MAX
from robotd.logs.relations import Relations, parse_relations
from robotd.logs.scan import RecordedLog
from robotd.logs.sweeps_csv import is_header, parse_sweeps

STANDARD_INPUT = "-"
_HEAD = 1024
"""Bytes by which a file is known; the mark of a tar stands farthest in."""
_TAR_AT = 257
_Unpacked = gzip.GzipFile | bz2.BZ2File | lzma.LZMAFile
_UNPACKERS: dict[bytes, Callable[[BinaryIO], _Unpacked]] = {
    b"\x1f\x8b": lambda file: gzip.GzipFile(fileobj=file),
    b"BZh": bz2.BZ2File,
    b"\xfd7zXZ\x00": lzma.LZMAFile,
}
_OTHERS = {
    b"PK\x03\x04": "a zip archive; unpack it first (unzip)",
    b"PK\x05\x06": "an empty zip archive",
    b"7z\xbc\xaf\x27\x1c": "a 7z archive; unpack it first",
    b"Rar!": "a rar archive; unpack it first",
    b"\x28\xb5\x2f\xfd": "compressed by zstd; unpack it first (zstd -d)",
    b"\x1f\x9d": "compressed by compress; unpack it first (uncompress)",
    b"#ROSBAG": "a ROS bag; it must be unpacked, and be a file",
    b"\x89MCAP": "an MCAP recording; a bag of ROS 2 must be unpacked, and its name end with .mcap",
    b"version https://git-lfs": "a pointer of Git LFS: fetch the file itself (git lfs pull)",
}
_BAG_HEADS = {".bag": b"#ROSBAG", ".mcap": b"\x89MCAP", ".db3": b"SQLite format 3"}
"""What bags begin with, by how their names end; by the name alone their reader tells them apart."""
_PAGES = (b"<!doctype html", b"<html", b"<?xml")
_TEXTS = {b"\xef\xbb\xbf": "utf-8-sig", b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}


def read_log(path: Path, *, fov_rad: float | None = None, scan_topic: str | None = None) -> RecordedLog:
    """Return the scans of a log: a CARMEN log or a table, plain or packed by gzip, bzip2 or xz, or a bag of ROS.

    Args:
        path: the file; ``-`` is standard input; of a bag of ROS 2 its directory.
        fov_rad: what the scanner of a CARMEN log sees; None where the log says it, or it is assumed.
        scan_topic: which scanner of a bag; None for the one that scanned most.

    Raises:
        RecordingError: it cannot be read, is cut or no log; the reader of its kind objects.
        RobotdError: it is a bag, and the extra ``bags`` is not installed.
    """
    if _is_bag(path):
        return read_bag(path, scan_topic)
    with _opened(path) as lines:
        begun = list(_up_to_first(lines))
        if begun and is_header(begun[-1]):
            return parse_sweeps(chain(begun, lines), file=str(path))
        return parse_carmen(chain(begun, lines), file=str(path), fov_rad=fov_rad)


def _is_bag(path: Path) -> bool:
    with suppress(OSError):  # what cannot be looked at is opened next, which says why
        if path.is_dir():
            return (path / "metadata.yaml").exists()
        if path.suffix in _BAG_HEADS and path.is_file():
            with path.open("rb") as file:
                return file.read(_HEAD).startswith(_BAG_HEADS[path.suffix])
    return False


def _up_to_first(lines: Iterable[str]) -> Iterator[str]:
    """Yield the lines up to the first that is no comment, which tells what kind of text it is."""
    for line in lines:
        yield line
        if line.strip() and not line.startswith("#"):
            return


def read_relations(path: Path, log: RecordedLog) -> Relations:
    """Return the relations between the scans of a log from a file, plain or packed.

    Raises:
        RecordingError: the file cannot be read, or is none of this log; :func:`parse_relations` objects.
    """
    with _opened(path) as lines:
        return parse_relations(lines, log.scans, str(path))


@contextmanager
def _opened(path: Path) -> Iterator[Iterator[str]]:
    with ExitStack() as stack:
        try:
            is_piped = str(path) == STANDARD_INPUT
            raw = io.FileIO(sys.stdin.fileno(), closefd=False) if is_piped else io.FileIO(path)
            yield _lines(stack, path, stack.enter_context(io.BufferedReader(raw, _HEAD)))
        except (OSError, EOFError, zlib.error, lzma.LZMAError) as error:
            # Those who unpack raise OSError, too, but without a number of the system's.
            system = error.strerror if isinstance(error, OSError) else None
            raise RecordingError(f"{path}: {system or f'damaged or cut while packed: {error}'}") from error


def _lines(stack: ExitStack, path: Path, packed: io.BufferedReader) -> Iterator[str]:
    """Return the lines, none longer than :data:`LINE_MAX`."""
    file: io.BufferedReader = packed
    unpack = next((unpack for magic, unpack in _UNPACKERS.items() if packed.peek(_HEAD).startswith(magic)), None)
    if unpack is not None:
        unpacked = stack.enter_context(unpack(packed))
        file = io.BufferedReader(cast("io.RawIOBase", unpacked), _HEAD)
    head = file.peek(_HEAD)
    # Latin-1 has a letter for every byte, and any may stand in a comment.
    encoding = next((name for magic, name in _TEXTS.items() if head.startswith(magic)), "latin-1")
    _refuse_others(path, head, is_wide=encoding == "utf-16")
    text = io.TextIOWrapper(file, encoding=encoding, errors="replace")
    stack.callback(text.detach)  # the file is the stack's to close
    return iter(lambda: text.readline(LINE_MAX), "")


def _refuse_others(path: Path, head: bytes, *, is_wide: bool) -> None:
    """Name what is no text.

    Raises:
        RecordingError: it is none.
    """
    if not head:
        raise RecordingError(f"{path}: is empty")
    what = next((words for magic, words in _OTHERS.items() if head.startswith(magic)), None)
    if head[_TAR_AT:].startswith(b"ustar"):
        what = "a tar archive; unpack it first (tar xf)"
    if head.lstrip()[:16].lower().startswith(_PAGES):
        what = "a web page, not a CARMEN log"
    if what is not None:
        raise RecordingError(f"{path}: this is {what}")
    if not is_wide and b"\0" in head:  # in UTF-16 half of a plain text is zeros
        raise RecordingError(f"{path}: not a text: byte {head.index(0)} is 0x00")
