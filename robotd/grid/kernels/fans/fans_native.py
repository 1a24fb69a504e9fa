"""Counting poses that cannot be excluded, in C."""

from collections.abc import Sequence

from robotd.grid.fans import FanBeams
from robotd.grid.kernels.shared.library import ffi, ints, lib, put_map, words
from robotd.grid.kernels.shared.packed_map import PackedMap, Words


def count_fans(
    counters: Words,
    the_map: PackedMap,
    grown: Sequence[Words],
    fan_beams: FanBeams,
    *,
    subtract: bool = False,
    threads: int = 1,
) -> None:
    """See :class:`.FansKernel`."""
    fans, planes = fan_beams.fans, [words(plane) for plane in grown]
    job = ffi.new("fan_job *")
    # Kept by name until the call is over: the job's pointer alone would not keep it alive.
    pointers = ffi.new("uint64_t *[]", planes)
    put_map(job.map, the_map)
    job.grown = pointers
    job.lines, job.windows = ints(fans.lines), ints(fans.windows)
    job.lists, job.fan_count, job.beams = ints(fan_beams.lists), len(fans.lines), ints(fan_beams.beams)
    job.headings, job.bits, job.counters = counters.shape[1], counters.shape[2], words(counters)
    job.subtract, job.threads = subtract, threads
    lib.count_fans(job)
