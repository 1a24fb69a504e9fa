"""The kernels in C. Importing this fails where they were not compiled; each call releases the GIL.

Every function has a twin of the same name and the same results in :mod:`robotd.grid.kernels.twins`, where it is
described.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels._native import ffi, lib
from robotd.grid.kernels.layout import TILE_ROWS, BeamGroups, PackedMap, Words

INSTRUCTION_SETS = ("portable", "avx2", "avx512")


def instruction_set() -> str:
    """Return which instructions this processor lets the counting use."""
    name: bytes = ffi.string(lib.instruction_set())
    return name.decode()


def count_feasible(
    counters: Words,
    the_map: PackedMap,
    groups: BeamGroups,
    *,
    subtract: bool = False,
    threads: int = 1,
    instructions: str | None = None,
) -> None:
    """See the twin; ``instructions`` is one of ``INSTRUCTION_SETS``, the best one if None.

    Raises:
        ValueError: this processor lacks those instructions.
    """
    tiles, headings, bits, _ = counters.shape
    pending = np.empty((threads, headings, 7, TILE_ROWS), np.uint64)
    waiting = np.empty((threads, headings), np.int32)
    buffers = {
        "occupied": _words(the_map.occupied),
        "grown": _words(the_map.grown),
        "tiles": _ints(the_map.tiles),
        "chains": _ints(groups.chains),
        "groups": _ints(groups.groups),
        "beams": _ints(groups.beams),
        "counters": _words(counters, writable=True),
        "pending": _words(pending, writable=True),
        "waiting": _ints(waiting, writable=True),
    }
    sizes = {
        "words": the_map.words,
        "rows": the_map.rows,
        "tile_count": tiles,
        "group_count": len(groups.groups) - 1,
        "headings": headings,
        "bits": bits,
    }
    job = ffi.new("count_job *", buffers | sizes)
    level = -1 if instructions is None else INSTRUCTION_SETS.index(instructions)
    if not lib.count_feasible(job, subtract, threads, level):
        raise ValueError(f"this processor has no {instructions}")


def greatest(counters: Words) -> int:
    """See the twin."""
    tiles, headings, bits, _ = counters.shape
    return int(lib.greatest(_words(counters), tiles * headings, bits))


def at_least(counters: Words, the_map: PackedMap, least: int) -> Words:
    """See the twin."""
    tiles, headings, bits, _ = counters.shape
    masks = np.zeros((headings, the_map.rows, the_map.words), np.uint64)
    if least >> bits == 0:
        sizes = (tiles, headings, bits, least, the_map.rows, the_map.words)
        lib.at_least(_words(counters), _ints(the_map.tiles), *sizes, _words(masks, writable=True))
    return masks


def _words(array: Words, *, writable: bool = False) -> Any:
    return ffi.from_buffer("uint64_t[]", array, require_writable=writable)


def _ints(array: NDArray[np.int32], *, writable: bool = False) -> Any:
    return ffi.from_buffer("int32_t[]", array, require_writable=writable)
