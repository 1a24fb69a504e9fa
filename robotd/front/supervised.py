"""The heart's front: a process of its own, watched over, and started again."""

import logging
from collections.abc import Callable
from functools import partial

from robotd import __version__
from robotd.children.child import Child, Death
from robotd.children.process import Process, Program, spawn
from robotd.children.resident import resident_bytes
from robotd.core.counted import Counted
from robotd.front.heart_side import LANES, HeartSide

MEMORY_BYTES = 2**30
"""Of address space, most of which is never touched: the last wall, behind all limits of the server's own."""


def front_of(side: HeartSide, halt: Callable[[str], None], counted: Counted) -> Child:
    """Return the front that serves clients; it begins when it is run.

    Args:
        side: what it is served by.
        halt: stops the robot, and is told why: called when there is no front, and none can be had. One that was well
            and died is followed by another within a second; until then missions go on as long as their leases.
        counted: where its memory is shown: it sees no file, its own in /proc neither.
    """
    return Child(
        "front",
        __version__,
        start=partial(_start, side.runtime_dir, counted),
        serve=side.serve,
        died=partial(_died, halt),
    )


def _start(runtime_dir: str, counted: Counted) -> Process:
    level = logging.getLevelName(logging.getLogger().getEffectiveLevel())
    process = spawn(Program(("-m", "robotd.front"), LANES, (level,), MEMORY_BYTES, runtime_dir))
    counted.show("resident_bytes", partial(resident_bytes, process.pid), process="front")
    return process


def _died(halt: Callable[[str], None], death: Death) -> None:
    # One that was of use is followed by another; one that never was is a fault that will not mend, and nobody
    # could send a stop.
    if not death.was_ready:
        halt(f"no client can be heard: {death.cause}")
