"""``make demo-busy``: whether the demonstration comes to its end beside busy programs, slowly as it may be."""

import argparse
import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tests.studies.busy.freezing import FREEZES, NOBODY, Freeze, children, freezing
from tests.studies.busy.outcome import HEADER, Outcome
from tests.support.spinning import spinning

_LONGEST_S = 7200.0
"""A room takes five minutes, a building of ninety stops an hour."""


@dataclass(frozen=True, slots=True)
class Beside:
    """What a demonstration has to live with."""

    busy: int
    """Busy programs at normal priority."""
    nice: int = 0
    """Of the demonstration."""
    freeze: Freeze = NOBODY


def demonstration(demo: list[str], directory: Path, beside: Beside) -> Outcome:
    """Run one to its end, in a directory of its own."""
    directory.mkdir(parents=True)
    said = directory / "said.txt"
    began_s = time.monotonic()
    command = [sys.executable, "-m", "robotd.cli.main", "demo", *demo, "--out", str(directory / "demo")]
    with spinning(beside.busy), said.open("w") as output:
        process = subprocess.Popen(command, stdout=output, stderr=output)
        with _ended(process), freezing(beside.freeze, process.pid, directory / "demo" / "run"):
            while process.poll() is None and time.monotonic() - began_s < _LONGEST_S:
                _give_way(process.pid, beside.nice)
                time.sleep(0.2)
    log = directory / "demo" / "robotd.log"
    text = log.read_text(errors="replace") if log.exists() else ""
    return Outcome.of(process.returncode, time.monotonic() - began_s, said.read_text(errors="replace"), text)


@contextlib.contextmanager
def _ended(process: "subprocess.Popen[bytes]") -> Iterator[None]:
    """Let it end its own processes before we go, whatever ends us."""
    try:
        yield
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        process.wait()


def _give_way(demo: int, nice: int) -> None:
    """Take the priority of all its processes down, and of their sessions where the kernel has groups of them."""
    for pid in (demo, *children(demo)) if nice else ():
        with contextlib.suppress(OSError):
            if os.getpriority(os.PRIO_PROCESS, pid) != nice:
                os.setpriority(os.PRIO_PROCESS, pid, nice)
                if pid != demo:  # its session is ours
                    Path(f"/proc/{pid}/autogroup").write_text(str(nice))


def _wanted(arguments: argparse.Namespace) -> Iterator[Beside]:
    for _ in range(arguments.runs):
        for busy in arguments.busy:
            yield Beside(busy, arguments.nice)
        if arguments.harsh:
            yield Beside(2, 15)
            yield from (Beside(0, 0, freeze) for freeze in FREEZES)


def main() -> int:
    """Print the table; 1 unless all finished."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--busy", type=int, nargs="+", default=[2, 4, 8], metavar="N", help="busy programs")
    parser.add_argument("--runs", type=int, default=10, help="beside each (default: %(default)s)")
    parser.add_argument("--world", default="laboratory", help="room to be mapped (default: %(default)s)")
    parser.add_argument("--log", help="a CARMEN log: its building in place of the room")
    parser.add_argument("--nice", type=int, default=0, help="of the demonstration (default: 0)")
    parser.add_argument("--harsh", action="store_true", help="nice beside two, and processes that stand still, as well")
    parser.add_argument("--keep", type=Path, help="directory that keeps what the demonstrations wrote")
    arguments = parser.parse_args()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    demo = ["building", arguments.log] if arguments.log else ["room", arguments.world]
    print(f"{os.cpu_count()} processors, load {os.getloadavg()[0]:.1f} before; seconds include the start\n{HEADER}")
    all_finished = True
    with tempfile.TemporaryDirectory(prefix="robotd-busy-") as scratch:
        for number, beside in enumerate(_wanted(arguments)):
            outcome = demonstration(demo, (arguments.keep or Path(scratch)) / str(number), beside)
            print(outcome.row(beside.busy, beside.nice, str(beside.freeze)), flush=True)
            all_finished = all_finished and outcome.finished
    return 0 if all_finished else 1


if __name__ == "__main__":
    sys.exit(main())
