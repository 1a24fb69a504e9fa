"""Counting feasible poses, in C."""

import numpy as np

from robotd.grid.kernels._native import ffi, lib
from robotd.grid.kernels.draw.draw_kernel import Beams
from robotd.grid.kernels.shared.buffers import ints, words
from robotd.grid.kernels.shared.packed_map import PAD_WORDS, TILE_ROWS, PackedMap, Words

INSTRUCTION_SETS = ("portable", "avx2", "avx512")
_THREADS_MAX = 16
"""As in count.c."""


def instruction_set() -> str:
    """Return which instructions this processor lets the counting use."""
    name: bytes = ffi.string(lib.instruction_set())
    return name.decode()


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
    (tiles, headings, bits, _), (_, word_count, row_count) = counters.shape, the_map.planes.shape
    workers, slots = min(threads, _THREADS_MAX), beams.slots
    spare = np.empty(workers * ((slots + 3) * TILE_ROWS + 2 * slots), np.uint64)
    job = ffi.new("count_job *")
    job.planes, job.blocked_by = words(the_map.planes), the_map.blocked_by
    job.words, job.rows = word_count - 2 * PAD_WORDS, row_count - 2 * TILE_ROWS
    job.tiles, job.tile_count = ints(the_map.tiles), tiles
    job.drawn, job.headings, job.bits = ints(beams.numbers), headings, bits
    job.counters, job.spare = words(counters), words(spare)
    level = -1 if instructions is None else INSTRUCTION_SETS.index(instructions)
    if not lib.count_feasible(job, subtract, workers, level):
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
