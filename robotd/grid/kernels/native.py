"""The kernels in C. Importing this fails where they were not compiled; each call releases the GIL.

Every function has a twin of the same name and the same results in :mod:`robotd.grid.kernels.twins`, where it is
described.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels._native import ffi, lib
from robotd.grid.kernels.layout import SLOTS, TILE_ROWS, Beams, BeamSettings, PackedMap, Rays, Words
from robotd.grid.ray import ray_steps, sample_counts
from robotd.grid.tables import UpdateTable

INSTRUCTION_SETS = ("portable", "avx2", "avx512")
_THREADS_MAX = 16
"""As in count.c."""


def instruction_set() -> str:
    """Return which instructions this processor lets the counting use."""
    name: bytes = ffi.string(lib.instruction_set())
    return name.decode()


def draw_beams(readings: NDArray[np.float64], headings_rad: NDArray[np.float64], how: BeamSettings) -> Beams:
    """See the twin."""
    count = len(readings) * len(headings_rad)
    bearings_rad = (readings[:, :1] + headings_rad).ravel()
    ahead = np.stack((np.sin(bearings_rad), np.cos(bearings_rad)), axis=1)
    turned = np.stack((headings_rad, np.sin(headings_rad), np.cos(headings_rad)), axis=1)
    table = np.empty(1 << (2 * count).bit_length(), np.int32)
    keys, steps = np.empty((2 * count, 5), np.int64), np.empty((2 * count, 4))
    sizes, drawn = np.empty(2 * count, np.int32), np.empty((count, 4), np.int32)
    job = ffi.new("draw_job *")
    job.readings, job.headings, job.ahead = _floats(readings), _floats(turned), _floats(ahead)
    job.reading_count, job.heading_count = len(readings), len(headings_rad)
    job.resolution_m, job.error_radius_cells, job.reach_cells = (
        how.resolution_m,
        how.error_radius_cells,
        how.reach_cells,
    )
    job.table, job.table_size, job.drawn = _ints(table), len(table), _ints(drawn)
    job.keys, job.steps, job.sizes = ffi.from_buffer("int64_t[]", keys), _floats(steps), _ints(sizes)
    groups = lib.draw_groups(job)
    cells, longest = int(sizes[:groups].sum()), int(sizes[:groups].max(initial=1))
    slots = max(SLOTS, 2 * longest) if count > SLOTS else max(count, 1)
    batches_max = min(groups, 2 * count // slots + 1) + 1
    chains, ends = np.empty((cells, 3), np.int32), np.empty(groups + 1, np.int32)
    batches, batch_of = np.empty(batches_max + 1, np.int32), np.empty(groups, np.int32)
    lists = np.empty(batches_max * len(headings_rad) + 1, np.int32)
    beams = np.empty((count, 3), np.int32)
    out = (_ints(array) for array in (chains, ends, batches, batch_of, lists, beams))
    number = lib.draw_chains(job, groups, slots, *out)
    return Beams(chains, ends, batches[: number + 1], lists[: number * len(headings_rad) + 1], beams, slots)


def count_feasible(
    counters: Words,
    the_map: PackedMap,
    beams: Beams,
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
    kept = np.empty((min(threads, _THREADS_MAX), beams.slots + 1, TILE_ROWS), np.uint64)
    job = ffi.new("count_job *")
    job.occupied, job.grown = _words(the_map.occupied), _words(the_map.grown)
    job.words, job.rows = the_map.words, the_map.rows
    job.tiles, job.tile_count = _ints(the_map.tiles), tiles
    job.chains, job.groups = _ints(beams.chains), _ints(beams.groups)
    job.batches, job.batch_count = _ints(beams.batches), len(beams.batches) - 1
    job.lists, job.beams, job.slots = _ints(beams.lists), _ints(beams.beams), beams.slots
    job.headings, job.bits = headings, bits
    job.counters, job.kept = _words(counters), _words(kept)
    level = -1 if instructions is None else INSTRUCTION_SETS.index(instructions)
    if not lib.count_feasible(job, subtract, min(threads, _THREADS_MAX), level):
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
        lib.at_least(_words(counters), _ints(the_map.tiles), *sizes, _words(masks))
    return masks


def insert_rays(
    cells: NDArray[np.uint8], rays: Rays, lower: UpdateTable, higher: UpdateTable, *, at_once: bool
) -> NDArray[np.intp]:
    """See the twin.

    Raises:
        ValueError: the cells are read-only.
    """
    rows, cols = cells.shape
    samples = sample_counts(rays.bearings_rad, rays.lengths_cells)
    beams = np.column_stack((rays.starts, ray_steps(rays.bearings_rad), samples))
    changed = np.empty(min(cells.size, int(np.minimum(samples, cells.size).sum()) + len(samples)), np.int64)
    number = lib.insert_beams(
        ffi.from_buffer("uint8_t[]", cells, require_writable=True),
        rows,
        cols,
        _floats(beams),
        ffi.from_buffer("int64_t[]", rays.hits.astype(np.int64)),
        len(beams),
        ffi.from_buffer("uint8_t[]", lower),
        ffi.from_buffer("uint8_t[]", higher),
        at_once,
        ffi.from_buffer("uint8_t[]", np.empty(cells.size, np.uint8)),
        ffi.from_buffer("int64_t[]", changed),
    )
    return changed[:number].astype(np.intp)


def _words(array: Words) -> Any:
    return ffi.from_buffer("uint64_t[]", array)


def _ints(array: NDArray[np.int32]) -> Any:
    return ffi.from_buffer("int32_t[]", array)


def _floats(array: NDArray[np.float64]) -> Any:
    return ffi.from_buffer("double[]", array)
