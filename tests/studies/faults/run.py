"""``make faults``: every fault, on every cable, in every state of the daemon; fails if the robot once does not rest."""

import argparse
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor

from robotd.sim.faults.fault_words import FAULTS
from robotd.sim.robot import DEVICES
from tests.studies.faults.cell import Outcome, run_cell
from tests.support.states import STATES

_WIDTH = 15


def main() -> None:
    """Run the matrix and print it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=FAULTS, help="one fault (default: all)")
    parser.add_argument("--seed", type=int, default=1, help="of the faults (default: %(default)s)")
    parser.add_argument("--processes", type=int, default=2, help="at a time (default: %(default)s)")
    arguments = parser.parse_args()
    faults = [arguments.only] if arguments.only else list(FAULTS)
    cells = [(fault, state, device) for fault in faults for state in STATES for device in DEVICES]
    print(f"{len(faults)} faults x {len(STATES)} states x {len(DEVICES)} cables, on the virtual clock")
    print(
        "passed of 3, then ms of the slowest cable: stop on a wire / robot at rest; -: it went on, until told to stop"
    )
    print(f"{'':10}" + "".join(f"{state:>{_WIDTH}}" for state in STATES))
    outcomes: list[Outcome] = []
    with ProcessPoolExecutor(arguments.processes) as pool:
        running = pool.map(run_cell, *zip(*cells, strict=True), [arguments.seed] * len(cells))
        for fault in faults:
            row = [next(running) for _ in range(len(STATES) * len(DEVICES))]
            outcomes += row
            print(f"{fault:10}" + "".join(_text([o for o in row if o.state == state]) for state in STATES), flush=True)
    failed = [outcome for outcome in outcomes if outcome.failures]
    for outcome in failed:
        print(f"FAILED {outcome.fault}, {outcome.state}, {outcome.device}: {'; '.join(outcome.failures)}")
    print(f"{len(outcomes) - len(failed)} of {len(outcomes)} cells passed: it rests, and moves only when armed again")
    if not failed:
        print("nothing lost: each recording is read back whole, each map saved and loaded, cell by cell")
    sys.exit(bool(failed))


def _text(cell: Sequence[Outcome]) -> str:
    passed = sum(not outcome.failures for outcome in cell)
    stops_s = [outcome.stop_s for outcome in cell if outcome.stop_s is not None]
    stop = f"{max(stops_s) * 1000:.0f}" if stops_s else "-"
    rest = f"{max(outcome.rest_s for outcome in cell) * 1000:.0f}"
    return f"{f'{passed}/{len(cell)} {stop}/{rest}':>{_WIDTH}}"


if __name__ == "__main__":
    main()
