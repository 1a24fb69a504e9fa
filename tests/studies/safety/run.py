"""``make safety``: how late stops are on the wires in real time, all processors busy; fails if they are too late."""

import argparse
import asyncio
import contextlib
import math
import os
import re
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from robotd.sim.emulators.catalogue import Dialects, Firmware
from tests.studies.safety import consoles_table
from tests.support.real_rig import NICE, give_precedence, rig
from tests.support.spinning import spinning
from tests.support.ways_to_end import CAUSES, ON_C_BOARDS

BOUND_MS = 50.0
GATEWAY = "gateway"
_CONSOLE_TRIALS = 20
_TRIALS = {
    "lease expiry": 500,
    "client killed": 500,
    "loop stall": 500,
    "SIGTERM": 500,
    "daemon killed": 25,
    ON_C_BOARDS: 25,
}


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=(*CAUSES, GATEWAY), help="one cause, or those of the console (default: all)")
    parser.add_argument("--share", type=float, default=1.0, help="of the trials (default: %(default)s)")
    parser.add_argument("--idle", action="store_true", help="leave the processors alone")
    arguments = parser.parse_args()
    if arguments.only == GATEWAY:
        sys.exit(consoles_table.measure(max(1, round(_CONSOLE_TRIALS * arguments.share))))
    causes = [arguments.only] if arguments.only else list(CAUSES)
    load = "idle" if arguments.idle else "busy"
    print(f"{os.cpu_count()} processors kept {load}; daemon at nice {NICE} as in its unit; others' load: {_load()}")
    print("how late the stop was on all three wires [ms]; of a killed daemon: the deadman's stop of the base")
    print(f"{'':16}{'trials':>8}{'p50':>8}{'p99':>8}{'p99.9':>8}{'max':>8}")
    with _precedence(), contextlib.nullcontext() if arguments.idle else spinning(os.cpu_count() or 1):
        is_late = [_measure(cause, max(2, round(_TRIALS[cause] * arguments.share))) for cause in causes]
    print("loop stall: counted from 0.2 s after the loop stood still; so long it may, by design")
    sys.exit(any(is_late))


def _measure(cause: str, trials: int) -> bool:
    late_ms = sorted(asyncio.run(measured(cause, trials)))
    p50, p99, p999 = (percentile(late_ms, share) for share in (0.5, 0.99, 0.999))
    print(f"{cause:16}{len(late_ms):8}{p50:8.1f}{p99:8.1f}{p999:8.1f}{late_ms[-1]:8.1f}", flush=True)
    return p999 > BOUND_MS


async def measured(cause: str, trials: int) -> list[float]:
    """Return how late the stop was in each trial [ms]."""
    with tempfile.TemporaryDirectory(prefix="robotd-safety-") as directory:
        async with rig(Path(directory), Dialects(boards=Firmware.C if cause == ON_C_BOARDS else Firmware.PYTHON)) as it:
            return [late_ms async for late_ms in CAUSES[cause](it, trials)]


def percentile(ascending: list[float], share: float) -> float:
    """Return the least of the numbers that at least this share of them does not exceed."""
    return ascending[math.ceil(share * len(ascending)) - 1]


def _load() -> str:
    return f"{os.getloadavg()[0]:.1f} over the last minute"


@contextlib.contextmanager
def _precedence() -> Iterator[None]:
    """Let boards and wires not wait for this machine's processors: they stand for things that have none of them.

    A board is a machine of its own. The wire is a pseudo-terminal, whose bytes a worker of the kernel carries; a real
    port puts them out by itself.
    """
    session = Path("/proc/self/autogroup")
    before = session.read_text().split()[-1] if session.exists() else ""
    give_precedence(os.getpid())
    workers = _carriers()
    _renice(workers, NICE)
    try:
        yield
    finally:
        _renice(workers, 0)
        if before:
            session.write_text(before)


def _carriers() -> list[int]:
    """Return the workers of the kernel that carry what is written to terminals; there are others among them."""
    names = ((int(file.parent.name), file.read_text()) for file in Path("/proc").glob("[0-9]*/comm"))
    return [
        pid for pid, name in names if re.match(r"kworker/u\d+:", name) and os.getpriority(os.PRIO_PROCESS, pid) == 0
    ]


def _renice(pids: list[int], nice: int) -> None:
    for pid in pids:
        with contextlib.suppress(PermissionError, ProcessLookupError):
            os.setpriority(os.PRIO_PROCESS, pid, nice)


if __name__ == "__main__":
    main()
