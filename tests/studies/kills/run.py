"""``make kills``: a daemon that explores is killed at every write of its maps; another one goes on to the same map."""

import argparse
import sys
import tempfile
from pathlib import Path

from robotd.config import Config
from robotd.sim.buildings.world import load_world, world_names
from tests.studies.kills.trial import Resumed, killed

ENDINGS = {"complete", "good_enough", "unreachable"}
WORST_MAX_M, UNSEEN_MAX = 0.15, 0.02


def main() -> None:
    """Kill and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", help="one world (default: all that come with robotd)")
    parser.add_argument("--seeds", type=int, default=1, help="robots in each (default: %(default)s)")
    arguments = parser.parse_args()
    worlds = [arguments.only] if arguments.only else world_names()
    faults = sum(_faults(world, seed) for world in worlds for seed in range(1, arguments.seeds + 1))
    print("no kill cost more than the stop that was being written" if not faults else f"{faults} faults")
    sys.exit(faults > 0)


def is_same(resumed: Resumed) -> bool:
    """Return whether the map came out as it would have without the kill: as whole, and as straight as maps are."""
    is_whole = resumed.ended.ending in ENDINGS and resumed.unseen_share <= UNSEEN_MAX
    return is_whole and resumed.ended.worst_m <= WORST_MAX_M


def _faults(world: str, seed: int) -> int:
    """Return how many kills cost more than they may."""
    with tempfile.TemporaryDirectory(prefix="robotd-kills-") as directory:
        robot = killed(load_world(world), seed, Path(directory), Config())
        lost = [cut for cut in robot.cuts if not cut.is_prefix or cut.whole_stops - cut.stops > 1]
        states = robot.states()
        print(f"{world} {seed}: {robot.without.ending}; {len(robot.cuts)} kills, {len(lost)} cost more than a stop")
        faults = len(lost)
        for cut in states:
            it = robot.resumed(cut)
            faults += not is_same(it)
            print(
                f"    after {cut.stops} stops: {it.ended.ending}, worst pose {1000 * it.ended.worst_m:.0f} mm, "
                f"not seen {it.unseen_share:.1%}{'' if is_same(it) else '  another map'}",
                flush=True,
            )
    return faults


if __name__ == "__main__":
    main()
