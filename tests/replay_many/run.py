"""Many random sessions, each recorded and replayed: how many differ, and how to repeat those that do."""

import argparse
import logging
import sys
from concurrent.futures import ProcessPoolExecutor

from tests.replay_many.session import VENDOR_ROBOTS, Outcome, run_session

ACTIONS = 12


def main() -> int:
    """Run the sessions and print what came of them; 1 if one differs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=500, help="sessions (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the first (default: %(default)s)")
    parser.add_argument("--actions", type=int, default=ACTIONS, help="what is done in each (default: %(default)s)")
    parser.add_argument("--vendor", action="store_true", help="robots of vendor devices, one after the other by seed")
    arguments = parser.parse_args()
    logging.disable(logging.CRITICAL)  # what goes wrong here goes wrong on purpose
    seeds = range(arguments.seed, arguments.seed + arguments.count)
    outcomes = []
    with ProcessPoolExecutor(2) as pool:
        robots = [VENDOR_ROBOTS[seed % len(VENDOR_ROBOTS)] if arguments.vendor else None for seed in seeds]
        for outcome in pool.map(run_session, seeds, [arguments.actions] * len(seeds), robots, chunksize=4):
            outcomes.append(outcome)
            if outcome.differs is not None:
                _tell(outcome, f"--actions {arguments.actions}{' --vendor' * arguments.vendor}")
    differ = sum(outcome.differs is not None for outcome in outcomes)
    results = sum(outcome.results for outcome in outcomes)
    print(f"{len(outcomes)} sessions, {results} results: {differ} differ")
    return int(differ > 0)


def _tell(outcome: Outcome, options: str) -> None:
    print(f"seed {outcome.seed}: {outcome.differs}")
    print(f"  after {', '.join(outcome.done)}")
    print(f"  again: python -m tests.replay_many.run --count 1 --seed {outcome.seed} {options}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
