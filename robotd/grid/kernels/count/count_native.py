"""Counting feasible poses, in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.draw.draw_kernel import Beams
from robotd.grid.kernels.draw.draw_native import drawn_of
from robotd.grid.kernels.shared.library import ffi, instructions_named, ints, lib, octets, put_map, words
from robotd.grid.kernels.shared.packed_map import PackedMap, Words


def count_feasible(
    counters: Words,
    the_map: PackedMap,
    beams: Beams,
    *,
    subtract: bool = False,
    threads: int = 1,
    instructions: str | None = None,
) -> None:
    """See :class:`.CountKernel`; ``instructions`` is one of ``INSTRUCTION_SETS``, the best one if None.

    Raises:
        ValueError: this processor lacks those instructions.
    """
    job = ffi.new("count_job *")
    put_map(job.map, the_map)
    job.drawn = drawn_of(beams)
    job.headings, job.bits, job.counters = counters.shape[1], counters.shape[2], words(counters)
    job.subtract, job.threads, job.instructions = subtract, threads, instructions_named(instructions)
    scratch = words(np.empty(lib.count_scratch_words(job), np.uint64))
    job.scratch = scratch
    if not lib.count_feasible(job):
        raise ValueError(f"this processor has no {instructions}")


def greatest(counters: Words) -> int:
    """See :class:`.CountKernel`."""
    tiles, headings, bits, _ = counters.shape
    return int(lib.greatest(words(counters), tiles * headings, bits))


def at_least(counters: Words, the_map: PackedMap, least: int) -> Words:
    """See :class:`.CountKernel`."""
    tiles, headings, bits, _ = counters.shape
    masks = np.zeros((headings, the_map.rows, the_map.words), np.uint64)
    if least >> bits == 0:
        sizes = (tiles, headings, bits, least, the_map.rows, the_map.words)
        lib.at_least(words(counters), ints(the_map.tiles), *sizes, words(masks))
    return masks


def heat(
    counters: Words,
    the_map: PackedMap,
    first: tuple[int, int],
    shape: tuple[int, int],
    *,
    readings: int,
    block: int,
) -> NDArray[np.uint8]:
    """See :class:`.CountKernel`."""
    (rows, cols), (tiles, headings, bits, _) = shape, counters.shape
    levels = np.zeros((-(-rows // block), -(-cols // block)), np.uint8)
    job = ffi.new("heat_job *")
    job.counters, job.tiles, job.levels = words(counters), ints(the_map.tiles), octets(levels)
    job.tile_count, job.headings, job.bits, job.readings = tiles, headings, bits, readings
    job.first, job.rows, job.cols, job.block = first, rows, cols, block
    lib.heat(job)
    return levels
