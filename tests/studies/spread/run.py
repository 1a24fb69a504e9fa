"""``make spread``: short recordings asked by one worker and by two, ended, killed, resumed: all answer the same."""

import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.studies.spread.recordings import write_recordings

_CLOCKED = {"cpu_s", "wall_s"}
_CASES = "10"
_PATIENCE_S = 600.0


@dataclass(frozen=True, slots=True)
class Spreading:
    """One way to spread the cases."""

    name: str
    words: tuple[str, ...]
    worker_dies: bool = False
    """Whether a worker is killed when a third is answered."""
    is_ended: bool = False
    """Whether all of it is killed when a third is answered, and begun again."""


WAYS = (
    Spreading("one process", ("--workers", "1")),
    Spreading("two processes", ("--workers", "2")),
    Spreading("two processes, one killed", ("--workers", "2"), worker_dies=True),
    Spreading("two processes, ended and resumed", ("--workers", "2"), is_ended=True),
    Spreading("Dask, one worker", ("--scheduler", "local:1")),
    Spreading("Dask, two workers", ("--scheduler", "local:2")),
    Spreading("Dask, two workers, one killed", ("--scheduler", "local:2"), worker_dies=True),
)


def main(words: Sequence[str] | None = None) -> None:
    """Ask in all ways and print a table; fails if one way answers anything else than the first."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000, help="recordings (default: %(default)s)")
    parser.add_argument("--only", default="", help="ways with this in their names, and the first (default: all)")
    arguments = parser.parse_args(words)
    with tempfile.TemporaryDirectory() as scratch:
        logs = write_recordings(Path(scratch) / "logs", arguments.count)
        print(f"{len(logs)} recordings, {_CASES} cases each")
        print("| way | time | recordings a second | lines |\n|---|---|---|---|")
        first: list[Any] = []
        for way in (WAYS[0], *(way for way in WAYS[1:] if arguments.only in way.name)):
            file = Path(scratch) / "answers.jsonl"
            taken_s = asked_in(way, logs, file)
            lines = answers_in(file)
            first = first or lines
            same = "the same" if lines == first else "OTHERS"
            print(f"| {way.name} | {taken_s:.1f} s | {len(logs) / taken_s:.1f} | {len(lines)}, {same} |", flush=True)
            if lines != first or not lines:
                sys.exit(f"{way.name}: answers differ from those of the first way")
            file.unlink()


def asked_in(way: Spreading, logs: Sequence[Path], file: Path) -> float:
    """Have ``robotctl eval`` answer all, and return how long that took, the time when it was ended included."""
    begun_s = time.monotonic()
    asking = _begun(way, logs, file)
    if way.worker_dies or way.is_ended:
        _wait_for_lines(file.with_name(f"{file.name}.part"), 10 * len(logs) // 3, asking)
        os.kill(_worker_of(asking.pid) if way.worker_dies else asking.pid, signal.SIGKILL)
    if way.is_ended:
        asking.wait(_PATIENCE_S)
        asking = _begun(way, logs, file, "--resume")
    if asking.wait() != 0:
        sys.exit(f"{way.name}: robotctl eval failed")
    return time.monotonic() - begun_s


def answers_in(file: Path) -> list[Any]:
    """Return all that was answered, but for what a clock measured and what it was asked with."""
    lines = [json.loads(line) for line in file.read_text().splitlines()]
    return [{key: value for key, value in line.items() if key not in _CLOCKED} for line in lines[1:]]


def _begun(way: Spreading, logs: Sequence[Path], file: Path, *more: str) -> "subprocess.Popen[bytes]":
    words = ("--cases", _CASES, "--range-max", "4", "--clear", "3", "--json", str(file), *way.words, *more)
    command = [sys.executable, "-m", "robotd.cli.main", "eval", *map(str, logs), *words]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def _wait_for_lines(part: Path, count: int, asking: "subprocess.Popen[bytes]") -> None:
    until_s = time.monotonic() + _PATIENCE_S
    while not part.exists() or part.read_bytes().count(b"\n") < count:
        if asking.poll() is not None or time.monotonic() > until_s:
            sys.exit("robotctl eval ended before a third was answered")
        time.sleep(0.05)


def _worker_of(pid: int) -> int:
    """Return a child of a process that answers cases."""
    for task in Path(f"/proc/{pid}/task").iterdir():
        for child in (task / "children").read_text().split():
            if b"spawn_main" in Path(f"/proc/{child}/cmdline").read_bytes():
                return int(child)
    sys.exit(f"process {pid} has no workers")


if __name__ == "__main__":
    main()
