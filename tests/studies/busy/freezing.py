"""Lets one process of a demonstration stand still while its robot drives, as a machine that swaps would."""

import contextlib
import os
import signal
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from robotd.client import Client
from robotd.contract.events import MissionPhase, MissionProgress
from robotd.contract.topics import Topic
from robotd.core.errors import RobotdError

_EVERY_S = 12.0
"""Fewer a minute than a mission may be held."""
_UNDER_WAY_S = 0.4
"""After a leg began."""
WORDS = {"simulator": "sim", "daemon": "robotd.app.daemon"}
"""How the command line of each is told; the client is the demonstration itself."""


@dataclass(frozen=True, slots=True)
class Freeze:
    """Who stands still, and for how long."""

    who: str = ""
    lasts_s: float = 0.0

    def __str__(self) -> str:
        return f"{self.who} {self.lasts_s:g} s" if self.who else ""

    def process(self, demo: int) -> int | None:
        """Return its number, given that of the demonstration; None if it does not live."""
        if self.who == "client":
            return demo
        for child in children(demo):
            with contextlib.suppress(OSError):
                if WORDS[self.who] in Path(f"/proc/{child}/cmdline").read_text().split("\0"):
                    return child
        return None


NOBODY = Freeze()
FREEZES = (
    Freeze("simulator", 0.5),
    Freeze("simulator", 2.0),
    Freeze("simulator", 5.0),
    Freeze("daemon", 0.5),
    Freeze("client", 0.8),
)


def children(pid: int) -> list[int]:
    """Return the processes that a process started.

    By asking each for its parent: the kernel's own list of children leaves some out while others end.
    """
    return sorted(int(stat.parent.name) for stat in Path("/proc").glob("[0-9]*/stat") if _parent(stat) == pid)


def _parent(stat: Path) -> int | None:
    with contextlib.suppress(OSError):  # it may end meanwhile
        return int(stat.read_text().rpartition(")")[2].split()[1])
    return None


@contextlib.contextmanager
def freezing(freeze: Freeze, demo: int, runtime_dir: Path) -> Iterator[list[float]]:
    """Do so again and again while the block lasts; yields a list that grows with the times of it."""
    over, done = threading.Event(), list[float]()
    thread = threading.Thread(target=_freeze, args=(freeze, demo, runtime_dir, over, done))
    if freeze.who:
        thread.start()
    try:
        yield done
    finally:
        over.set()
        if freeze.who:
            thread.join()


def _freeze(freeze: Freeze, demo: int, runtime_dir: Path, over: threading.Event, done: list[float]) -> None:
    with Client(runtime_dir) as client, client.subscribe(Topic.MISSION) as events:
        while not over.is_set():
            with contextlib.suppress(RobotdError):
                event = events.next(0.2)
                if not (isinstance(event, MissionProgress) and event.phase is MissionPhase.DRIVING):
                    continue
                if (done and time.monotonic() - done[-1] < _EVERY_S) or over.wait(_UNDER_WAY_S):
                    continue
                process = freeze.process(demo)
                if process is not None:
                    done.append(time.monotonic())
                    _stand_still(process, freeze.lasts_s, over)


def _stand_still(process: int, lasts_s: float, over: threading.Event) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.kill(process, signal.SIGSTOP)
        try:
            over.wait(lasts_s)
        finally:
            os.kill(process, signal.SIGCONT)
