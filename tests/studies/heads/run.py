"""``make heads``: kill -9 and SIGSTOP of the head, whatever the robot is at."""

import argparse
import os
import random
import sys
import tempfile
from itertools import product
from pathlib import Path

from robotd.core.clock import run_counting
from tests.studies.heads.trial import STATES, WAYS, Outcome, subject


def main() -> int:
    """Run the trials, print a table, and return 0 if nothing went wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    print(f"two kinds of death in {len(STATES)} states; load {os.getloadavg()[0]:.1f}")
    columns = f"{'stop, ms: median':>17} {'most':>7} {'back, s: median':>16} {'most':>6}"
    print(f"{'at':12} {'by':8} {'trials':>6} {columns}  wrong")
    found = run_counting(measured(arguments.trials, arguments.seed))
    for (state, way), outcomes in found.items():
        print(_row(state, way, outcomes), flush=True)
    return int(any(outcome.wrong for outcomes in found.values() for outcome in outcomes))


async def measured(trials: int, seed: int) -> dict[tuple[str, str], list[Outcome]]:
    """Return the outcomes of trials, shared out among all states and ways."""
    kinds = list(product(STATES, WAYS))
    found: dict[tuple[str, str], list[Outcome]] = {kind: [] for kind in kinds}
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory(prefix="robotd-heads-") as directory:
        async with subject(Path(directory)) as one:
            for number in range(trials):
                state, way = kinds[number % len(kinds)]
                found[state, way].append(await one.trial(state, way, rng))
    return found


def _row(state: str, way: str, outcomes: list[Outcome]) -> str:
    stops = sorted(outcome.stop_ms for outcome in outcomes if outcome.stop_ms is not None)
    backs = sorted(outcome.back_s for outcome in outcomes)
    stop = f"{stops[len(stops) // 2]:17.1f} {stops[-1]:7.1f}" if stops else f"{'':17} {'':7}"
    back = f"{backs[len(backs) // 2]:16.2f} {backs[-1]:6.2f}" if backs else ""
    wrong = "; ".join(outcome.wrong for outcome in outcomes if outcome.wrong)
    return f"{state:12} {way:8} {len(outcomes):6} {stop} {back}  {wrong or 'nothing'}"


if __name__ == "__main__":
    sys.exit(main())
