"""``make stops``: whatever ends the daemon, in whatever motion, whatever the devices speak; fails if one moves on."""

import argparse
import logging
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass
from importlib.util import find_spec

from robotd.hardware.devices.dialects import MOTORLESS, SCANNERS
from robotd.sim.emulators.catalogue import DRIVES, OWN, PANTILTS, RANGEFINDERS, Dialects, Firmware
from tests.studies.stops.causes import CAUSES, ENDINGS, HEAD_LOST
from tests.studies.stops.processes import ACTIVITIES, run_real_trials
from tests.studies.stops.processes import CAUSES as REAL_CAUSES
from tests.studies.stops.trial import Outcome, run_trial

_WIDTH = 8
STOP_S = 0.05
"""The stop is on every wire so soon."""


@dataclass(frozen=True, slots=True)
class Row:
    """A device that speaks something, in a motion."""

    name: str
    activity: str
    dialects: Dialects

    def __str__(self) -> str:
        return f"{self.name}, {self.activity}"


def rows() -> Iterator[Row]:
    """All that is tried."""
    for drive in DRIVES:
        for activity in ("turning", "driving", "start-up"):
            yield Row(f"base {drive}", activity, Dialects(drive=drive))
    for pantilt in PANTILTS:
        if pantilt != MOTORLESS:
            yield Row(f"head {pantilt}", "head", Dialects(pantilt=pantilt))
    for rangefinder in RANGEFINDERS:
        if rangefinder not in SCANNERS:
            yield Row(f"laser {rangefinder}", "sweeping", Dialects(rangefinder=rangefinder))
    for scanner in SCANNERS:
        yield Row(f"laser {scanner}", "sweeping", Dialects(pantilt=MOTORLESS, rangefinder=scanner))
    if find_spec("robotd.sim.firmware._native") is not None:
        for activity in ("turning", "driving", "start-up", "head", "sweeping"):
            yield Row(f"{OWN} in C", activity, Dialects(boards=Firmware.C))


def failed(outcome: Outcome) -> bool:
    """Whether it moves on, or was stopped too late."""
    return outcome.rest_s is None or outcome.stop_s is None or outcome.stop_s > STOP_S


def main() -> None:
    """Try and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=8, help="of each kind in memory (default: %(default)s)")
    parser.add_argument("--real", type=int, default=2, help="of each kind with processes (default: %(default)s)")
    parser.add_argument("--only", default="", help="rows whose name holds this, for example rflex")
    parser.add_argument("--processes", type=int, default=2, help="at a time (default: %(default)s)")
    arguments = parser.parse_args()
    tried = [row for row in rows() if arguments.only in str(row)]
    bad = 0
    with ProcessPoolExecutor(arguments.processes, initializer=_quietly) as pool:
        if arguments.trials:
            bad += _in_memory(pool, tried, arguments.trials)
        if arguments.real:
            bad += _as_processes(pool, [row for row in tried if row.activity in ACTIVITIES], arguments.real)
    print(f"{bad} moved on, or were stopped later than in {STOP_S:g} s")
    sys.exit(bad > 0)


def _in_memory(pool: Executor, tried: Sequence[Row], trials: int) -> int:
    """Return how many failed."""
    print(f"{trials} trials of each kind, on the virtual clock, each at a random moment of the motion:")
    print(
        "how many came to rest; then the latest, in ms from the cause: stop on the last wire, rest, end of the daemon"
    )
    _print_head(list(CAUSES), "stop", "rest", "end")
    wanted = [(row, cause) for row in tried for cause in CAUSES if _applies(row, cause)]
    running = pool.map(_trial, [(row, cause, seed) for row, cause in wanted for seed in range(trials)])
    bad = 0
    for row in tried:
        cells = {cause: [next(running) for _ in range(trials)] for cause in CAUSES if (row, cause) in wanted}
        outcomes = [outcome for cell in cells.values() for outcome in cell]
        bad += sum(failed(outcome) for outcome in outcomes)
        latest = (
            _ms([outcome.stop_s for outcome in outcomes]),
            _ms([outcome.rest_s for outcome in outcomes]),
            _ms([outcome.ended_s for cause in cells if cause in ENDINGS for outcome in cells[cause]]),
        )
        _print_row(row, [_passed(cells[cause]) if cause in cells else "" for cause in CAUSES], *latest)
    return bad


def _as_processes(pool: Executor, tried: Sequence[Row], trials: int) -> int:
    """Return how many failed."""
    print(f"{trials} trials of each kind, processes on pseudo-terminals and the real clock; a stall lasts 2 s:")
    _print_head(list(REAL_CAUSES), "rest")
    running = pool.map(_real_trials, [(row, cause, trials) for row in tried for cause in REAL_CAUSES])
    bad = 0
    for row in tried:
        cells = [next(running) for _ in REAL_CAUSES]
        bad += sum(rest_s is None for cell in cells for rest_s in cell)
        texts = [f"{sum(rest_s is not None for rest_s in cell)}/{len(cell)}" for cell in cells]
        _print_row(row, texts, _ms([rest_s for cell in cells for rest_s in cell]))
    return bad


def _quietly() -> None:
    """Keep warnings of the daemons tried out of the table: with no handler of theirs they go to the terminal."""
    logging.getLogger("robotd").addHandler(logging.NullHandler())


def _applies(row: Row, cause: str) -> bool:
    """Whether a cause can be: a mission has a lease, a robot that is at something can be stopped, a head be lost."""
    if cause == HEAD_LOST:
        return row.activity in ACTIVITIES
    return cause in ENDINGS or row.activity not in {"start-up", "head"}


def _trial(what: tuple[Row, str, int]) -> Outcome:
    row, cause, seed = what
    return run_trial(row.dialects, row.activity, cause, seed)


def _real_trials(what: tuple[Row, str, int]) -> list[float | None]:
    row, cause, trials = what
    return run_real_trials(row.dialects, row.activity, cause, trials)


def _print_head(causes: Sequence[str], *latest: str) -> None:
    short = [name.removeprefix("SIG").removeprefix("error: ")[: _WIDTH - 1] for name in causes]
    _print_row("", short, *latest)


def _print_row(row: object, cells: Sequence[str], *latest: str) -> None:
    print(f"{row!s:28}" + "".join(f"{text:>{_WIDTH}}" for text in (*cells, *latest)), flush=True)


def _passed(cell: list[Outcome]) -> str:
    return f"{sum(not failed(outcome) for outcome in cell)}/{len(cell)}"


def _ms(times_s: Sequence[float | None]) -> str:
    known_s = [time_s for time_s in times_s if time_s is not None]
    return f"{max(known_s) * 1000:.0f}" if len(known_s) == len(times_s) else "never"


if __name__ == "__main__":
    main()
