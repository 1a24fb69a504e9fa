"""Many trials on one bench: a daemon that lives through them all, as it should."""

import random
import tempfile
from collections.abc import Mapping
from pathlib import Path

from robotd.core.clock import run_virtual
from robotd.sim.emulators.catalogue import Dialects
from tests.studies.liars.lies import TONGUES
from tests.studies.liars.trial import Outcome, try_once
from tests.support.bench import bench

READINGS = 12
"""Of a sweep: few, so that missions come round soon."""

ROBOTS: Mapping[str, Dialects] = {
    "own boards": Dialects(),
    "rwi, ptu, dimetix": Dialects("rwi-ascii", "ptu", "dimetix"),
    "rflex, dynamixel, tfmini": Dialects("rflex", "dynamixel", "tfmini-s"),
    "own, scip": Dialects(pantilt="fixed", rangefinder="scip"),
    "rwi, own, lw20": Dialects("rwi-ascii", "board", "lw20"),
    "own, dynamixel, lwnx": Dialects("board", "dynamixel", "lwnx"),
    "rflex, ptu, disto": Dialects("rflex", "ptu", "disto"),
}
"""Every dialect that is emulated, at least once."""


def run_block(robot: str, state: str, seeds: range) -> list[Outcome]:
    """Run trials on the virtual clock, on one bench until a daemon dies."""
    outcomes: list[Outcome] = []
    while len(outcomes) < len(seeds):
        with tempfile.TemporaryDirectory(prefix="robotd-liars-") as directory:
            outcomes += run_virtual(run_in(Path(directory), robot, state, seeds[len(outcomes) :]))
    return outcomes


async def run_in(directory: Path, robot: str, state: str, seeds: range) -> list[Outcome]:
    """Run trials on one bench, which keeps its recording in a directory, until one fails."""
    dialects = ROBOTS[robot]
    tongues = {
        device: TONGUES[device, dialect]
        for device in ("drive", "pantilt", "rangefinder")
        if (device, dialect := getattr(dialects, device)) in TONGUES
    }
    outcomes: list[Outcome] = []
    try:
        async with bench(directory, dialects, READINGS) as it:
            for seed in seeds:
                device = random.Random(f"{robot}/{state}/{seed}").choice(sorted(tongues))
                try:
                    outcomes.append(await try_once(it, robot, state, device, seed, tongues[device]))
                except AssertionError as error:
                    outcomes.append(Outcome(robot, state, device, seed, (), "lost", str(error)))
                if outcomes[-1].is_failure:
                    break  # the next one begins with a daemon that is well
    except TimeoutError as error:
        outcomes.append(Outcome(robot, state, "", seeds[len(outcomes)], (), "lost", f"the bench: {error!r}"))
    return outcomes
