"""Counting poses that cannot be excluded, in C."""

from collections.abc import Sequence

from robotd.grid.fans import FanBeams
from robotd.grid.kernels._native import ffi, lib
from robotd.grid.kernels.shared.buffers import ints, words
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
    tiles, headings, bits, _ = counters.shape
    fans, planes = fan_beams.fans, [words(plane) for plane in grown]
    job = ffi.new("fan_job *")
    pointers = ffi.new("uint64_t *[]", planes)
    job.free, job.blocking, job.grown = words(the_map.free), words(the_map.blocking), pointers
    job.words, job.rows = the_map.words, the_map.rows
    job.tiles, job.tile_count = ints(the_map.tiles), tiles
    job.lines, job.windows = ints(fans.lines), ints(fans.windows)
    job.lists, job.fan_count, job.beams = ints(fan_beams.lists), len(fans.lines), ints(fan_beams.beams)
    job.headings, job.bits, job.counters = headings, bits, words(counters)
    lib.count_fans(job, subtract, threads)
