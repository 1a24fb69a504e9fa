"""Many random sessions, each recorded and replayed: how many differ, and how to repeat those that do."""

import argparse
import logging
import os
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from tests.studies.replay_many.outcome import Outcome
from tests.studies.replay_many.real import run_real_session
from tests.studies.replay_many.session import VENDOR_ROBOTS, run_session
from tests.support.spinning import spinning

ACTIONS = 12
KEPT = Path("build/replays")
"""Where a recording of a real session goes that replays to anything else: that session cannot be had again."""


def main() -> int:
    """Run the sessions and print what came of them; 1 if one differs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=500, help="on the virtual clock (default: %(default)s)")
    parser.add_argument("--real", type=int, default=0, help="in real time, processors busy (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the first of each (default: %(default)s)")
    parser.add_argument("--actions", type=int, default=ACTIONS, help="what is done in each (default: %(default)s)")
    parser.add_argument("--vendor", action="store_true", help="robots of vendor devices, one after the other by seed")
    arguments = parser.parse_args()
    logging.disable(logging.CRITICAL)  # what goes wrong here goes wrong on purpose
    some_differ = _count(_virtual(arguments), "on the virtual clock")
    if arguments.real:
        some_differ |= _count(_real(arguments), f"in real time beside {_busy()} busy programs")
    return int(some_differ)


def _busy() -> int:
    return os.cpu_count() or 1


def _count(outcomes: Iterator[Outcome], how: str) -> bool:
    sessions = results = differ = 0
    for outcome in outcomes:
        sessions, results, differ = sessions + 1, results + outcome.results, differ + (outcome.differs is not None)
    print(f"{sessions} sessions {how}, {results} results: {differ} differ", flush=True)
    return differ > 0


def _virtual(arguments: argparse.Namespace) -> Iterator[Outcome]:
    seeds = range(arguments.seed, arguments.seed + arguments.count)
    with ProcessPoolExecutor(2) as pool:
        robots = [VENDOR_ROBOTS[seed % len(VENDOR_ROBOTS)] if arguments.vendor else None for seed in seeds]
        for outcome in pool.map(run_session, seeds, [arguments.actions] * len(seeds), robots, chunksize=4):
            if outcome.differs is not None:
                vendor = " --vendor" * arguments.vendor
                _tell(outcome, f"--count 1 --seed {outcome.seed} --actions {arguments.actions}{vendor}")
            yield outcome


def _real(arguments: argparse.Namespace) -> Iterator[Outcome]:
    with spinning(_busy()):
        for seed in range(arguments.seed, arguments.seed + arguments.real):
            outcome = run_real_session(seed, arguments.actions, KEPT)
            if outcome.differs is not None:
                _tell(outcome, f"--count 0 --real 1 --seed {seed} --actions {arguments.actions}")
                print(f"  which may end otherwise; this one: robotctl replay {outcome.kept}", flush=True)
            yield outcome


def _tell(outcome: Outcome, again: str) -> None:
    print(f"seed {outcome.seed}: {outcome.differs}")
    print(f"  after {', '.join(outcome.done)}")
    print(f"  again: python -m tests.studies.replay_many.run {again}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
