"""The compiled library: arrays as it sees them, and constants that it must have in common with Python.

Pointers keep their array alive. They are made by partial functions, which cost least.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels._native import ffi, lib
from robotd.grid.kernels.shared.packed_map import PAD_WORDS, TILE_ROWS, WORD_CELLS, PackedMap

__all__ = [
    "INSTRUCTION_SETS",
    "agree",
    "ffi",
    "floats",
    "instruction_set",
    "instructions_named",
    "ints",
    "lib",
    "longs",
    "octets",
    "put_map",
    "shorts",
    "words",
]

words: Callable[[NDArray[np.uint64]], Any] = partial(ffi.from_buffer, "uint64_t[]")
"""Return ``uint64_t *``."""
longs: Callable[[NDArray[np.int64]], Any] = partial(ffi.from_buffer, "int64_t[]")
"""Return ``int64_t *``."""
ints: Callable[[NDArray[np.int32]], Any] = partial(ffi.from_buffer, "int32_t[]")
"""Return ``int32_t *``."""
floats: Callable[[NDArray[np.float64]], Any] = partial(ffi.from_buffer, "double[]")
"""Return ``double *``."""
shorts: Callable[[NDArray[np.uint16]], Any] = partial(ffi.from_buffer, "uint16_t[]")
"""Return ``uint16_t *``."""
octets: Callable[[NDArray[np.uint8]], Any] = partial(ffi.from_buffer, "uint8_t[]")
"""Return ``uint8_t *``."""


def agree(**constants: float) -> None:
    """Make sure that the library was compiled with the constants that Python computes with.

    Raises:
        ImportError: it was not, or knows one of them not at all: its source is another.
    """
    for name, value in constants.items():
        compiled = getattr(lib, name, None)
        if compiled != value:
            raise ImportError(f"the library was compiled from other source: {name} is {compiled} in it, not {value}")


# When imported: a library of other source is refused before it computes anything, and the twins are used.
agree(TILE_ROWS=TILE_ROWS, WORD_CELLS=WORD_CELLS, PAD_WORDS=PAD_WORDS)

INSTRUCTION_SETS: tuple[str, ...] = tuple(
    ffi.string(lib.instruction_name(number)).decode() for number in range(lib.INSTRUCTION_SETS)
)
"""What kernels were compiled for, each set after those that it outdoes."""


def instruction_set() -> str:
    """Return which instructions this processor lets the counting use."""
    best: int = lib.instructions_for(-1)
    return INSTRUCTION_SETS[best]


def instructions_named(name: str | None) -> int:
    """Return the number of a set, -1 if it may be the best that this processor has."""
    return -1 if name is None else INSTRUCTION_SETS.index(name)


def put_map(packed_map: Any, the_map: PackedMap) -> None:
    """Fill the C struct of a packed map."""
    _, word_count, row_count = the_map.planes.shape
    packed_map.planes, packed_map.blocked_by = words(the_map.planes), the_map.blocked_by
    packed_map.words, packed_map.rows = word_count - 2 * PAD_WORDS, row_count - 2 * TILE_ROWS
    packed_map.tiles, packed_map.tile_count = ints(the_map.tiles), len(the_map.tiles)
