"""Whole recordings that were crafted, replayed as ``robotctl replay`` does: a verdict, or a typed error, in bounds."""

import argparse
import contextlib
import io
import logging
import signal
import tempfile
from collections.abc import Iterator
from functools import cache, partial
from pathlib import Path
from types import FrameType

from robotd.cli.exit_codes import FAILED, OK
from robotd.cli.verbs.recordings import VERBS
from robotd.core.errors import RobotdError
from tests.studies.fuzz.crafting import CHANGES, contain, crafted, double, keep, set_times, splice
from tests.studies.fuzz.session import LIVES, session
from tests.studies.fuzz.target import MIB, Target

_LONGEST_S = 20.0
"""Of the processor; a replay of what was really recorded takes a tenth of a second."""
_REPLAY = next(verb.run for verb in VERBS if verb.name == "replay")


class _TakesTooLong(KeyboardInterrupt):
    """Raised into a replay that does not end; of a kind that no loop and no task takes for an error of its own."""


def _replayed(life: str, script: bytes) -> str:
    """Replay a crafted recording and return what is said of it.

    Nothing may be complained of by the loop, and nothing may be written.
    """
    file, lived = _file(), session(life)
    file.write_bytes(crafted(lived, script))
    said = io.StringIO()
    with _in_time(), _heard() as complaints, contextlib.redirect_stdout(said):
        code = _REPLAY(argparse.Namespace(file=file, json=len(script) % 2 == 1))
    assert not complaints, "\n".join(complaints)
    assert code in {OK, FAILED}
    assert said.getvalue()
    assert not lived.directory.exists()
    return said.getvalue()


@cache
def _directory() -> "tempfile.TemporaryDirectory[str]":
    return tempfile.TemporaryDirectory(prefix="fuzz-replays-")


def _file() -> Path:
    return Path(_directory().name) / "a.mcap"


@contextlib.contextmanager
def _in_time() -> Iterator[None]:
    def end(number: int, frame: FrameType | None) -> None:
        raise _TakesTooLong

    before = signal.signal(signal.SIGVTALRM, end)
    signal.setitimer(signal.ITIMER_VIRTUAL, _LONGEST_S, _LONGEST_S)
    try:
        yield
    except _TakesTooLong as error:
        raise AssertionError(f"a replay took more than {_LONGEST_S} s of the processor") from error
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)


@contextlib.contextmanager
def _heard() -> Iterator[list[str]]:
    """Collect what asyncio complains of: errors that nobody took. What the daemon logs is not of interest."""
    complaints: list[str] = []

    class Ear(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            if record.name == "asyncio":
                complaints.append(logging.Formatter().format(record))

    ear, root = Ear(logging.ERROR), logging.getLogger()
    others, level = root.handlers[:], root.level
    root.handlers[:] = [ear]
    root.setLevel(logging.ERROR)
    try:
        yield complaints
    finally:
        root.handlers[:] = others
        root.setLevel(level)


def _scripts() -> list[bytes]:
    """Return changes after which there is a verdict: none, and some."""
    kinds = (CHANGES.index(one) for one in (keep, double, set_times, splice, contain))
    return [b"", *(bytes((kind, 130, 0, 3)) + b"1" for kind in kinds)]


_TOKENS = (
    *(b"\n" + bytes((kind,)) + at + b"\0" for kind in range(len(CHANGES)) for at in (b"\x01", b"\x13")),
    *(
        b"null",
        b"true",
        b"[]",
        b"{}",
        b'""',
        b"-1",
        b"1e400",
        b"NaN",
        b"Infinity",
        b"9" * 20,
        b"1" * 5000,
        b"1e308",
    ),
    *(b'"board"', b'"rflex"', b'"rwi-ascii"', b'"ptu"', b'"dynamixel"', b'"fixed"', b'"scip"', b'"lw20"'),
    *(b"stall", b"silence", b"line_broke", b"go_on", b"give_up", b"lease", b"begun", b"\xed\xa0\x80", b'"\\ud800"'),
    *(b"serial/drive/to_board", b"line/pantilt", b"insert", b"prepare", b"narrow", b"begin map", b"use_map"),
)

REPLAYS = tuple(
    Target(
        f"replay-that-{life}",
        partial(_replayed, life),
        _scripts,
        ("robotd/recording", "robotd/app/replaying.py", "robotd/mission"),
        typed=(RobotdError,),
        tokens=_TOKENS,
        size_max=256,
        executions=4,
        measured=2,
        peak_max=64 * MIB,
        outlined=True,
    )
    for life in LIVES
)
