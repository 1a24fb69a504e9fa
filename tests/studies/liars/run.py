"""``make liars``: right checksums and absurd values, in every dialect and state of the daemon; it lives, and rests."""

import argparse
import logging
import sys
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor

from tests.studies.liars.block import ROBOTS, run_block
from tests.studies.liars.trial import STATES, Outcome

_TRIALS = 10_000
_BLOCK = 30
_WIDTH = 17
_SHOWN = 40


def main() -> None:
    """Run the trials and print what became of them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=_TRIALS, help="in which a lie is told (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the first trial (default: %(default)s)")
    parser.add_argument("--processes", type=int, default=2, help="at a time (default: %(default)s)")
    parser.add_argument("--robot", choices=ROBOTS, help="one robot (default: all)")
    parser.add_argument("--state", choices=STATES, help="one state (default: all)")
    arguments = parser.parse_args()
    robots = [arguments.robot] if arguments.robot else list(ROBOTS)
    states = [arguments.state] if arguments.state else list(STATES)
    print(f"{len(robots)} robots x {len(states)} states on the virtual clock, {arguments.trials} lies")
    outcomes = _run(robots, states, arguments)
    _print(robots, states, outcomes)
    sys.exit(any(outcome.is_failure for outcome in outcomes))


def _run(robots: Sequence[str], states: Sequence[str], arguments: argparse.Namespace) -> list[Outcome]:
    """Run blocks of every cell in turn until enough lies were told."""
    outcomes: list[Outcome] = []
    seed = arguments.seed
    with ProcessPoolExecutor(arguments.processes, initializer=logging.disable) as pool:
        while (missing := arguments.trials - _told(outcomes)) > 0:
            cells = [(robot, state) for robot in robots for state in states]
            size = min(_BLOCK, max(1, -(-missing // len(cells))))
            seeds = range(seed, seed + size)
            running = [pool.submit(run_block, robot, state, seeds) for robot, state in cells]
            for block in running:
                outcomes += block.result()
            seed += size
            _say_failures([outcome for outcome in outcomes if outcome.is_failure and outcome.seed in seeds])
            print(f"{_told(outcomes)} lies told, {sum(one.is_failure for one in outcomes)} failures", flush=True)
    return outcomes


def _told(outcomes: Sequence[Outcome]) -> int:
    return sum(bool(outcome.told) for outcome in outcomes)


def _say_failures(failed: Sequence[Outcome]) -> None:
    for one in failed[:_SHOWN]:
        where = f"{one.robot}, {one.state}, {one.device}, seed {one.seed}"
        print(f"FAILED {one.end}: {where}: {one.detail}\n    {'; '.join(one.told)}", flush=True)


def _print(robots: Sequence[str], states: Sequence[str], outcomes: Sequence[Outcome]) -> None:
    print("lies told: faulted / disarmed / went on")
    print(f"{'':26}" + "".join(f"{state:>{_WIDTH}}" for state in states))
    for robot in robots:
        row = (_text([one for one in outcomes if (one.robot, one.state) == (robot, state)]) for state in states)
        print(f"{robot:26}" + "".join(f"{text:>{_WIDTH}}" for text in row))
    ends = Counter(one.end for one in outcomes)
    told = _told(outcomes)
    print(
        f"{told} lies: {ends['died']} deaths, {ends['internal']} internal errors, {ends['moved']} motions after a stop,"
        f" {ends['froze']} silent freezes, {ends['lost']} that did not come back"
    )


def _text(cell: Sequence[Outcome]) -> str:
    ends = Counter(one.end for one in cell if one.told)
    return f"{sum(ends.values())}: {ends['faulted']}/{ends['disarmed']}/{ends['went on']}"


if __name__ == "__main__":
    main()
