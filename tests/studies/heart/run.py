"""``make heart``: whether a stop is on the wires in time, whatever clients do, and whatever becomes of the front."""

import argparse
import asyncio
import contextlib
import os
import signal
import sys
import tempfile
from collections.abc import Awaitable, Callable, Iterator
from datetime import UTC, datetime
from functools import partial
from itertools import product
from pathlib import Path

from tests.benchmarks.run import ROOT, commit
from tests.studies.heart.attackers import ATTACKERS
from tests.studies.heart.endings import MODES
from tests.studies.heart.rows import ATTACKED, ENDED, LEFT, Row, attack_row, end_row, ending_row, header
from tests.studies.safety.run import _precedence
from tests.support.spinning import spinning
from tests.support.this_machine import processor

PAGE = ROOT / "docs" / "benchmarks" / "heart.md"
NOW = "## Now\n"
_PER_TRIAL_S = 20.0
_AT_MOST_S = 300.0
"""What a row may take beside its trials; then it is given up, and that is said in its place."""

Measure = Callable[[Path, str], Awaitable[Row]]


def main() -> None:
    """Measure, print a table, write it where all was measured, and fail if a bound does not hold."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=100, help="of each attack (default: %(default)s)")
    parser.add_argument("--endings", type=int, default=50, help="of the front in each mode (default: %(default)s)")
    parser.add_argument("--only", choices=(*ATTACKERS, "endings", "SIGTERM"), help="some rows (default: all)")
    parser.add_argument("--beside", choices=("quiet", "busy"), help="one kind of neighbours (default: both)")
    arguments = parser.parse_args()
    lines = [introduction()]
    print(lines[0], flush=True)
    all_hold = True
    for columns, rows in tables(arguments.only, arguments.trials, arguments.endings).items():
        lines += ["", header(columns)]
        print(f"\n{lines[-1]}", flush=True)
        for beside in [arguments.beside] if arguments.beside else ["quiet", "busy"]:
            for row in _measured(rows, beside, max(arguments.trials, arguments.endings)):
                lines.append(row.line(beside))
                print(lines[-1], flush=True)
                all_hold &= not row.broken
    if not (arguments.only or arguments.beside):
        write_page(PAGE, "\n".join(lines))
    sys.exit(not all_hold)


def introduction() -> str:
    """Return where and how this was measured."""
    return (
        f"Commit {commit()}, {datetime.now(UTC):%Y-%m-%d}; {processor()}, {os.cpu_count()} processors, load"
        f" {os.getloadavg()[0]:.1f} before."
    )


def tables(only: str | None, trials: int, endings: int) -> dict[str, dict[str, Measure]]:
    """Return the rows of each table, by its columns and their names."""
    found: dict[str, dict[str, Measure]] = {}
    if attacks := [attack for attack in ATTACKERS if only in {None, attack}]:
        found[ATTACKED] = {attack: partial(attack_row, attack, trials) for attack in attacks}
    if only in {None, "endings"}:
        ways = product((signal.SIGKILL, signal.SIGSTOP), MODES)
        found[LEFT] = {f"{number.name} {mode}": partial(ending_row, mode, number, endings) for number, mode in ways}
    if only in {None, "SIGTERM"}:
        found[ENDED] = {"SIGTERM": partial(end_row, trials)}
    return found


def _measured(rows: dict[str, Measure], beside: str, trials: int) -> Iterator[Row]:
    longest_s = _AT_MOST_S + _PER_TRIAL_S * trials
    with _precedence(), spinning(os.cpu_count() or 1) if beside == "busy" else contextlib.nullcontext():
        for name, row in rows.items():
            with tempfile.TemporaryDirectory(prefix="robotd-heart-") as directory:
                yield asyncio.run(_within(longest_s, name, row(Path(directory), beside)))


async def _within(longest_s: float, name: str, measuring: Awaitable[Row]) -> Row:
    try:
        async with asyncio.timeout(longest_s):
            return await measuring
    except (TimeoutError, OSError) as error:
        return Row(name, 0, (), (f"given up: {error or f'more than {longest_s:g} s'}",))


def write_page(file: Path, table: str) -> None:
    """Write the tables in place of those that the page ends with."""
    kept, _, _ = file.read_text(encoding="utf-8").partition(NOW)
    file.write_text(f"{kept}{NOW}\n{table}\n", encoding="utf-8")
    print(f"written to {file}")


if __name__ == "__main__":
    main()
