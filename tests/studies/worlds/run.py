"""``make worlds``: whole daemons map worlds and find themselves in them; fails if one is sure and wrong."""

import argparse
import sys
from collections import Counter
from pathlib import Path

from robotd.sim.buildings.world import load_world
from tests.studies.worlds.trial import Found, Trial, tried

HERE = Path(__file__).parent
WORLDS = tuple(sorted(path.stem for path in HERE.glob("*.toml")))


def main() -> None:
    """Try and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=WORLDS, help="one world (default: all)")
    parser.add_argument("--seeds", type=int, default=20, help="robots in each (default: %(default)s)")
    parser.add_argument("--first", type=int, default=0, help="the first one's seed (default: %(default)s)")
    arguments = parser.parse_args()
    seeds = range(arguments.first, arguments.first + arguments.seeds)
    trials = {world: [_told(world, seed) for seed in seeds] for world in WORLDS if arguments.only in (None, world)}
    print(f"\n{'world':14}{'robots':>8}{'mapped whole':>14}" + "".join(f"{found:>28}" for found in Found))
    for world, done in trials.items():
        found = sum((trial.found for trial in done), Counter[Found]())
        whole = sum(trial.swept == trial.stops for trial in done)
        print(f"{world:14}{len(done):8}{whole:14}" + "".join(f"{found[one]:28}" for one in Found))
    sys.exit(any(trial.found[Found.WRONG_AND_SURE] for done in trials.values() for trial in done))


def _told(world: str, seed: int) -> Trial:
    trial = tried(load_world(str(HERE / f"{world}.toml")), seed)
    print(f"{world} {seed}: {trial.swept} of {trial.stops} stops mapped", flush=True)
    for found, words in trial.probes:
        print(f"    {found}: {words}", flush=True)
    return trial


if __name__ == "__main__":
    main()
