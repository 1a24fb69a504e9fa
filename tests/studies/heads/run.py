"""``make heads``: kill -9 and SIGSTOP of the head, whatever the robot is at."""

import argparse
import os
import random
import sys
import tempfile
from itertools import cycle, product
from pathlib import Path

from robotd.core.clock import run_counting
from tests.studies.heads.trial import STATES, WAYS, Outcome, subject
from tests.support.repeated import Repeated, repeated


def main() -> int:
    """Run the trials, print a table, and return 0 if nothing went wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    print(f"two kinds of death in {len(STATES)} states; load {os.getloadavg()[0]:.1f}", flush=True)
    made = run_counting(measured(arguments.trials, arguments.seed))
    columns = f"{'stop, ms: median':>17} {'most':>7} {'back, s: median':>16} {'most':>6}"
    print(f"{'at':12} {'by':8} {'trials':>6} {columns}  wrong")
    for state, way in product(STATES, WAYS):
        print(_row(state, way, [outcome for kind, outcome in made.found if kind == (state, way)]), flush=True)
    for failure in made.failures:
        print(f"not ended: {failure}")
    return int(bool(made.failures) or any(outcome.wrong for _, outcome in made.found))


async def measured(trials: int, seed: int) -> Repeated[tuple[tuple[str, str], Outcome]]:
    """Return the outcomes of trials, each of one kind after the other."""
    kinds = cycle(product(STATES, WAYS))
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory(prefix="robotd-heads-") as directory:
        async with subject(Path(directory)) as one:

            async def trial() -> tuple[tuple[str, str], Outcome]:
                state, way = next(kinds)
                return (state, way), await one.trial(state, way, rng)

            return await repeated(trials, trial)


def _row(state: str, way: str, outcomes: list[Outcome]) -> str:
    stops = sorted(outcome.stop_ms for outcome in outcomes if outcome.stop_ms is not None)
    backs = sorted(outcome.back_s for outcome in outcomes)
    stop = f"{stops[len(stops) // 2]:17.1f} {stops[-1]:7.1f}" if stops else f"{'':17} {'':7}"
    back = f"{backs[len(backs) // 2]:16.2f} {backs[-1]:6.2f}" if backs else ""
    wrong = "; ".join(outcome.wrong for outcome in outcomes if outcome.wrong)
    return f"{state:12} {way:8} {len(outcomes):6} {stop} {back}  {wrong or 'nothing'}"


if __name__ == "__main__":
    sys.exit(main())
