"""What it costs that array work is asked of another process: jobs and answers as bytes, there and back."""

import asyncio
import time
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from robotd.core.grid_bytes import packed_cells
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.head.answering import answer_to
from robotd.head.desk import Desk
from robotd.head.far import FarHead
from robotd.head.jobs import Forget, MapRef, Narrow, Prepare, TakeMap
from robotd.head.settings import HeadSettings
from robotd.head.wire import pack_answer, pack_job, unpack_answer, unpack_job
from robotd.localization.settings import LocalizationSettings
from tests.benchmarks import workload
from tests.benchmarks.timing import Timing, timed

_BATCH = 20
_RUNS = 500


def timings() -> Iterator[Timing]:
    """Workload S, the heading known to a degree: together the rows are what an estimate waits for more than before."""
    job, answer = _estimated()
    estimate = unpack_answer(Narrow, answer)
    there = timed("S: a batch of 20 readings into bytes and out of them", lambda: unpack_job(pack_job(job)), _RUNS)
    yield replace(there, note=f"{len(pack_job(job))} bytes")
    back = timed("S: its estimate, the same", lambda: unpack_answer(Narrow, pack_answer(estimate)), _RUNS)
    yield replace(back, note=f"{len(answer)} bytes")
    yield Timing("a job that takes no time, asked of the head", asyncio.run(_asked()), goal_ms=1.0)


def _estimated() -> tuple[Narrow, bytes]:
    """Return the last batch of a sweep, and its answer."""
    room = workload.room()
    (pose,) = workload.poses_in(room, 1)
    grid = OccupancyGrid(workload.SPEC)
    for number, where in enumerate(workload.poses_in(room, 4)):
        grid.insert(workload.sweep_of(room, number, where), where)
    readings = workload.sweep_of(room, 9, pose).measured
    headings_rad = LocalizationSettings().headings_near(pose.heading_rad)
    done = partial(answer_to, Desk(HeadSettings()))
    done(pack_job(TakeMap(1, grid.spec, memoryview(packed_cells(grid.cells)), GridSettings())))
    done(pack_job(Prepare(2, MapRef(1), "m", headings_rad, None)))
    done(pack_job(Narrow(2, readings[:-_BATCH], 0, final=False)))
    job = Narrow(2, readings[-_BATCH:], 0, final=True)
    return job, done(pack_job(job))


async def _asked() -> tuple[float, ...]:
    head, seconds = FarHead.spawned(HeadSettings(), "ERROR"), []
    running = asyncio.create_task(head.run())
    await head.ask(Forget(0))  # when it is there
    for _ in range(_RUNS):
        before_s = time.perf_counter()
        await head.ask(Forget(0))
        seconds.append(time.perf_counter() - before_s)
    running.cancel()
    await asyncio.wait((running,))
    return tuple(seconds)
