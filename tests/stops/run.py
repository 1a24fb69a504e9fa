"""``make stops``: whatever ends the daemon, in whatever motion, whatever the devices speak; fails if one moves on."""

import argparse
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from importlib.util import find_spec

from robotd.hardware.devices.catalogue import MOTORLESS, SCANNERS
from robotd.sim.emulators.catalogue import DRIVES, OWN, PANTILTS, RANGEFINDERS, Dialects, Firmware
from tests.stops.causes import CAUSES
from tests.stops.trial import Outcome, run_trial

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
    parser.add_argument("--trials", type=int, default=8, help="of each kind (default: %(default)s)")
    parser.add_argument("--only", default="", help="rows whose name holds this, for example rflex")
    parser.add_argument("--processes", type=int, default=2, help="at a time (default: %(default)s)")
    arguments = parser.parse_args()
    tried = [row for row in rows() if arguments.only in str(row)]
    print(f"{arguments.trials} trials of each kind, on the virtual clock, each at a random moment of the motion:")
    print(
        "how many came to rest; then the latest, in ms from the cause: stop on the last wire, rest, end of the daemon"
    )
    columns = [name.removeprefix("SIG").removeprefix("error: ")[: _WIDTH - 1] for name in CAUSES]
    print(f"{'':28}" + "".join(f"{name:>{_WIDTH}}" for name in columns) + f"{'stop':>{_WIDTH}}{'rest':>7}{'end':>6}")
    bad = 0
    with ProcessPoolExecutor(arguments.processes) as pool:
        running = pool.map(
            _trial, [(row, cause, seed) for row in tried for cause in CAUSES for seed in range(arguments.trials)]
        )
        for row in tried:
            cells = [[next(running) for _ in range(arguments.trials)] for _ in CAUSES]
            bad += sum(failed(outcome) for cell in cells for outcome in cell)
            print(f"{row!s:28}" + "".join(f"{_passed(cell):>{_WIDTH}}" for cell in cells) + _latest(cells), flush=True)
    print(
        f"{bad} of {len(tried) * len(CAUSES) * arguments.trials} moved on, or were stopped later than in {STOP_S:g} s"
    )
    sys.exit(bad > 0)


def _trial(what: tuple[Row, str, int]) -> Outcome:
    row, cause, seed = what
    return run_trial(row.dialects, row.activity, cause, seed)


def _passed(cell: list[Outcome]) -> str:
    return f"{sum(not failed(outcome) for outcome in cell)}/{len(cell)}"


def _latest(cells: list[list[Outcome]]) -> str:
    outcomes = [outcome for cell in cells for outcome in cell]
    stop, rest, ended = (
        _ms([outcome.stop_s for outcome in outcomes]),
        _ms([outcome.rest_s for outcome in outcomes]),
        _ms([outcome.ended_s for outcome in outcomes]),
    )
    return f"{stop:>{_WIDTH}}{rest:>7}{ended:>6}"


def _ms(times_s: Sequence[float | None]) -> str:
    known_s = [time_s for time_s in times_s if time_s is not None]
    return f"{max(known_s) * 1000:.0f}" if len(known_s) == len(times_s) else "never"


if __name__ == "__main__":
    main()
