"""``make sessions``: a hundred stops, fifty with furniture moved; fails for one sure and wrong, or lost for good."""

import argparse
import sys

from robotd.sim.buildings.world import load_world
from tests.studies.sessions.trial import Found, Trial, tried


def main() -> None:
    """Try and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5, help="robots (default: %(default)s)")
    parser.add_argument("--share", type=float, default=0.15, help="of the furniture is moved (default: %(default)s)")
    parser.add_argument("--first", type=int, default=100, help="stops before that (default: %(default)s)")
    parser.add_argument("--later", type=int, default=50, help="stops after that (default: %(default)s)")
    arguments = parser.parse_args()
    heads = "".join(f"{found:>16}" for found in Found)
    print(f"{'robot':>5}{heads}{'longest unsure':>16}{'moved':>7}{'listed':>8}{'elsewhere':>11}", flush=True)
    world, stops = load_world("laboratory"), (arguments.first, arguments.later)
    trials = [_told(seed, tried(world, arguments.share, stops, seed)) for seed in range(arguments.seeds)]
    sys.exit(any(trial.counts[Found.WRONG] or trial.is_lost_for_good for trial in trials))


def _told(seed: int, trial: Trial) -> Trial:
    counts = "".join(f"{trial.counts[found]:16}" for found in Found)
    places = f"{trial.moved:7}{trial.listed:8}{trial.listed_elsewhere:11}"
    print(f"{seed:5}{counts}{trial.longest_unsure:16}{places}", flush=True)
    return trial


if __name__ == "__main__":
    main()
