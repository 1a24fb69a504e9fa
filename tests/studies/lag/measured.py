"""The daemon, with two things more: it notes how long each callback held its loop, and how late a timer of a
millisecond came. When it is told to end it writes both to a file.
"""

import asyncio
import os
import sys
import time
from array import array
from pathlib import Path
from typing import NoReturn

from robotd.app.daemon import run
from robotd.children.process import Program
from robotd.config import load
from robotd.core.log import configure
from robotd.head import far
from tests.studies.lag.samples import Samples

ROOT = Path(__file__).parents[3]
BEAT_NS = 1_000_000
REGIONS = "regions"
"""In place of a map's answers, every estimate holds 32 large regions."""


def _time_callbacks(into: "array[int]") -> None:
    """Note when each callback of a loop began and how long it took [ns]."""
    run_one = asyncio.Handle._run  # there is no other place that sees every callback

    def timed(handle: asyncio.Handle) -> None:
        began_ns = time.monotonic_ns()
        run_one(handle)
        into.extend((began_ns, time.monotonic_ns() - began_ns))

    asyncio.Handle._run = timed  # type: ignore[assignment,method-assign]  # as above


async def _beat(into: "array[int]") -> NoReturn:
    """Note how late each beat of a millisecond was [ns]."""
    while True:
        due_ns = time.monotonic_ns() + BEAT_NS
        await asyncio.sleep(BEAT_NS / 1e9)
        into.extend((due_ns, max(0, time.monotonic_ns() - due_ns)))


def _answer_with_regions() -> None:
    os.environ["PYTHONPATH"] = str(ROOT)  # a child looks for no module where it was started
    far.program = lambda log_level: Program(("-m", "tests.studies.lag.regions_head"), arguments=(log_level,))


async def _main(samples_file: Path, config_file: Path) -> None:
    callbacks, beats = array("q"), array("q")
    _time_callbacks(callbacks)
    beating = asyncio.create_task(_beat(beats))
    try:
        await run(load(config_file))
    finally:
        beating.cancel()
        Samples.of(callbacks, beats).write(samples_file)


if __name__ == "__main__":
    if sys.argv[1] == REGIONS:
        _answer_with_regions()
    configure("error")  # the table is what people read
    asyncio.run(_main(Path(sys.argv[2]), Path(sys.argv[3])))
