"""``make senses``: how few readings are enough, which of two equal rooms it is, and whether being carried off shows."""

import argparse
import asyncio
import sys
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from statistics import fmean, median

from robotd.sim.buildings.log_file import read_log
from robotd.sim.buildings.world import load_world, world_names
from tests.studies.senses import on_logs
from tests.studies.senses.ground import Ground
from tests.studies.senses.trials import Came, CarriedOff, carried_off, look, resolve

_MAP_SEED = 1
_TWINS = "symmetric"


def main() -> None:
    """Try and print; fails if anybody is sure of a wrong place."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--places", type=int, default=200, help="looks in each world (default: %(default)s)")
    parser.add_argument("--twins", type=int, default=100, help="robots among equal rooms (default: %(default)s)")
    parser.add_argument("--carried", type=int, default=200, help="robots carried off (default: %(default)s)")
    parser.add_argument("--cutoff", type=float, default=6.0, help="how far a reading sees [m] (default: %(default)s)")
    parser.add_argument("--log", type=Path, help="be carried off in this recorded building, and do nothing else")
    arguments = parser.parse_args()
    told = _on_log(arguments.log, arguments.carried) if arguments.log else _in_worlds(arguments)
    sys.exit(told[Came.WRONG] > 0)


def _in_worlds(arguments: argparse.Namespace) -> Counter[Came]:
    told = Counter[Came]()
    for world in world_names():
        ground = Ground.of(load_world(world), _MAP_SEED, arguments.cutoff)
        told += _looks(world, ground, arguments.places)
        if world == _TWINS:
            told += _resolved(ground, arguments.twins)
        else:
            told += _carried(world, ground, arguments.carried)
    return told


def _on_log(log: Path, robots: int) -> Counter[Came]:
    ground = on_logs.LoggedGround.of(read_log(log).scans, robots)
    tried = [on_logs.carried_off(ground, robot) for robot in range(len(ground.asked) // 2)]
    print(f"{log.name}, nothing known: {_in_words(one.known for one in tried)}", flush=True)
    carried = _told(log.name, [one.carried for one in tried if one.carried is not None])
    return carried + Counter(one.known for one in tried)


def _looks(world: str, ground: Ground, places: int) -> Counter[Came]:
    looks = [asyncio.run(look(ground, seed)) for seed in range(places)]
    if looks:
        readings = [one.readings for one in looks]
        spread = f"readings: mean {fmean(readings):.1f}, median {median(readings):.0f}, most {max(readings)}"
        print(f"{world}: {_in_words(one.came for one in looks)}; {spread}", flush=True)
    return Counter(one.came for one in looks)


def _resolved(ground: Ground, robots: int) -> Counter[Came]:
    done = [asyncio.run(resolve(ground, seed)) for seed in range(robots)]
    if done:
        stops, way_m = fmean(one.stops for one in done), fmean(one.way_m for one in done)
        print(f"twins: {_in_words(one.came for one in done)}; {stops:.1f} stops, {way_m:.1f} m, mean", flush=True)
    return Counter(one.came for one in done)


def _carried(world: str, ground: Ground, robots: int) -> Counter[Came]:
    tried = (asyncio.run(carried_off(ground, seed)) for seed in range(robots))
    return _told(world, [one for one in tried if one is not None])


def _told(where: str, done: list[CarriedOff]) -> Counter[Came]:
    if done:
        noticed = sum(one.noticed for one in done)
        print(
            f"carried off in {where}: noticed {noticed} of {len(done)}; then {_in_words(one.came for one in done)}",
            flush=True,
        )
    return Counter(one.came for one in done)


def _in_words(these: Iterable[Came]) -> str:
    counts = Counter(these)
    return ", ".join(f"{counts[one]} {one}" for one in Came if counts[one])


if __name__ == "__main__":
    main()
