"""What is made of a recording: a report, a file for Foxglove, a bag. ``robotctl`` makes it, in a process of its own.

A recording tells what the daemon did when it is replayed, which takes the whole engine, much memory and some time. The
gateway has none of the engine, and must not: that process may take what it likes of both, and die, without a page
noticing.
"""

import asyncio
import contextlib
import os
import shutil
import sys
import tempfile
from collections import OrderedDict
from dataclasses import dataclass
from pathlib import Path

from robotd.core.errors import ServerError
from robotd.core.text import printable

_KEPT = 4
"""Files, the ones asked for last: a download that broke off goes on, and an eager one costs one replay."""
_PATIENCE_S = 600.0
_DIES_FIRST = "1000"
_NICE = 10
"""Stops are handed on by the same machine meanwhile."""
_LONGEST_REASON = 300


@dataclass(frozen=True, slots=True)
class Form:
    """What is made, and by which verb."""

    ending: str
    """Of the address, after the recording's own name."""
    verb: tuple[str, ...]
    made: str
    """Name of what the verb writes."""
    media_type: str
    is_folder: bool = False
    """Whether that is a folder, which is sent as a zip."""


FORMS = (
    Form(".html", ("report",), "report.html", "text/html"),
    Form(".foxglove.mcap", ("export", "foxglove"), "foxglove.mcap", "application/octet-stream"),
    Form(".bag.zip", ("export", "bag"), "bag", "application/zip", is_folder=True),
)


class MadeFiles:
    """Makes them, one at a time, and keeps the last ones for as long as the gateway runs."""

    def __init__(self) -> None:
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._made: OrderedDict[tuple[str, int, str], Path] = OrderedDict()
        self._turn = asyncio.Lock()

    async def of(self, recording: Path, form: Form) -> Path:
        """Return the file of this form.

        Raises:
            ServerError: another one is being made, or this one cannot be, in ``robotctl``'s words.
        """
        # A recording that is under way grows, and what was made of it before is not what would be made now.
        key = (recording.name, _changed_ns(recording), form.ending)
        if key not in self._made:
            if self._turn.locked():
                raise ServerError("busy", "something is being made of a recording already: try again soon")
            async with self._turn:
                self._made[key] = await self._make(recording, form)
        self._made.move_to_end(key)
        while len(self._made) > _KEPT:
            _, oldest = self._made.popitem(last=False)
            shutil.rmtree(oldest.parent, ignore_errors=True)
        return self._made[key]

    def forget(self) -> None:
        """Remove all of it."""
        self._made.clear()
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None

    async def _make(self, recording: Path, form: Form) -> Path:
        self._folder = self._folder or tempfile.TemporaryDirectory(prefix="robotd-gateway-")
        place = Path(tempfile.mkdtemp(dir=self._folder.name))
        out = place / form.made
        try:
            await _robotctl(*form.verb, str(recording), str(out))
            if form.is_folder:
                name = recording.name.removesuffix(".mcap")
                packed = await asyncio.to_thread(shutil.make_archive, str(place / name), "zip", out)
                shutil.rmtree(out)
                return Path(packed)
        except BaseException:
            shutil.rmtree(place, ignore_errors=True)
            raise
        return out


async def _robotctl(*arguments: str) -> None:
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "robotd.cli.main", *arguments),
        stdin=asyncio.subprocess.DEVNULL,
        stdout=asyncio.subprocess.DEVNULL,
        stderr=asyncio.subprocess.PIPE,
    )
    _let_it_go_first(process.pid)
    try:
        async with asyncio.timeout(_PATIENCE_S):
            _, said = await process.communicate()
    except TimeoutError:
        raise ServerError("refused", f"it was not made within {_PATIENCE_S / 60:.0f} minutes") from None
    finally:
        if process.returncode is None:
            process.kill()
            await process.wait()
    if process.returncode != 0:
        lines = said.decode(errors="replace").strip().splitlines() or ["no reason was given"]
        raise ServerError("refused", printable(lines[-1], _LONGEST_REASON))


def _let_it_go_first(pid: int) -> None:
    """Let a process be the one that waits, and that ends if memory runs out; what is not allowed is done without."""
    with contextlib.suppress(OSError):
        Path(f"/proc/{pid}/oom_score_adj").write_text(_DIES_FIRST)
        os.setpriority(os.PRIO_PROCESS, pid, _NICE)


def _changed_ns(file: Path) -> int:
    return file.stat().st_mtime_ns
