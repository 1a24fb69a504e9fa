"""``make safety ONLY=gateway``: how soon the robot is told to stop when its console ends, however it ends."""

import asyncio
import os
import tempfile
from collections.abc import AsyncIterator, Callable
from functools import partial
from pathlib import Path

from tests.studies.safety.consoles import ENDINGS, STARVED, ending, starved
from tests.support.real_rig import Rig, rig
from tests.support.spinning import spinning

STARVED_WITHIN_S = 3.0
"""A gateway that gets no processor can say nothing: then the lease has stopped the robot long before."""


def measure(trials: int) -> bool:
    """Print a line for each ending; return whether any stop came too late."""
    load = os.getloadavg()[0]
    print(f"{os.cpu_count()} processors; load of others: {load:.1f} over the last minute; page and gateway on loopback")
    print("from the moment it is harmed, or STOP is pressed, to the stop on all three wires [s]")
    print(f"{'':16}{'trials':>8}{'p50':>8}{'max':>8}{'bound':>8}  because")
    late = [_row(what.name, trials, partial(ending, what), what.within_s, what.because) for what in ENDINGS]
    with spinning(2 * (os.cpu_count() or 1)):
        late.append(_row(STARVED, trials, starved, STARVED_WITHIN_S, "STOP as soon as it can, or else the lease"))
    return any(late)


def _row(
    name: str, trials: int, tried: Callable[[Rig, int], AsyncIterator[float]], within_s: float, because: str
) -> bool:
    took_s = sorted(asyncio.run(measured(tried, trials)))
    middle, most = took_s[len(took_s) // 2], took_s[-1]
    print(f"{name:16}{len(took_s):8}{middle:8.3f}{most:8.3f}{within_s:8.2f}  {because}", flush=True)
    return most > within_s


async def measured(tried: Callable[[Rig, int], AsyncIterator[float]], trials: int) -> list[float]:
    """Return how long each trial took [s]."""
    with tempfile.TemporaryDirectory(prefix="robotd-console-") as directory:
        async with rig(Path(directory)) as it:
            return [took_s async for took_s in tried(it, trials)]
