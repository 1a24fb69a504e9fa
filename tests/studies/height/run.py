"""``make height``: what layers at further tilts gain among tables and crates; fails if a look is sure and wrong."""

import argparse
import math
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

from robotd.core.reading import Tilt
from robotd.sim.buildings.world import Wall, World, load_world
from tests.studies.height.mapped import Mapped
from tests.studies.senses.trials import Came

DOWN, UP = Tilt(math.radians(-13.75), 2.1), Tilt(math.radians(6.0), 4.0)
"""LILY's own, to the floor 2.25 m ahead, and one that meets table tops: at 0.70 m after 1.4 m."""
CRATE = Wall(((2.2, 4.5), (2.9, 4.5), (2.9, 5.0), (2.2, 5.0)), height_m=0.35, name="crate in the left room")
MANNERS = {
    "level, 6 m": (6.0, ()),
    "level, 2.1 m": (2.1, ()),
    "level, 6 m, and down": (6.0, (DOWN,)),
    "level, 2.1 m, and down": (2.1, (DOWN,)),
    "level, 6 m, down and up": (6.0, (DOWN, UP)),
    "level, 2.1 m, down and up": (2.1, (DOWN, UP)),
}


def furnished() -> World:
    """Return the laboratory with tables on legs, and things that end below the level beam."""
    return load_world(str(Path(__file__).parent / "furnished.toml"))


def told_apart_by_a_crate() -> World:
    """Return two equal rooms, in one of which stands a crate that the level beam passes over."""
    twins = load_world("symmetric")
    return replace(twins, name="twins with a crate", wall=(*twins.wall, CRATE))


def main() -> None:
    """Try and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--places", type=int, default=100, help="looks, and ways, on each map (default: %(default)s)")
    places = parser.parse_args().places
    total = Counter[Came]()
    for world in (furnished(), told_apart_by_a_crate()):
        print(
            f"\n{world.name:27}{'':2}"
            + "".join(f"{came:>16}" for came in Came)
            + f"{'ways free':>16}{'into a thing':>14}{'refused':>9}"
        )
        for manner, (cut_off_m, tilts) in MANNERS.items():
            mapped = Mapped.of(world, cut_off_m, tilts)
            looks, ways = mapped.looks(places), mapped.ways(places)
            counts = "".join(f"{looks[came]:16}" for came in Came)
            print(f"{manner:29}{counts}{ways.free:16}{ways.into_something:14}{ways.refused:9}", flush=True)
            total += looks
    sys.exit(total[Came.WRONG] > 0)


if __name__ == "__main__":
    main()
