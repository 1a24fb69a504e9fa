"""Arrays as the C side sees them: pointers that keep their array alive."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels._native import ffi


def words(array: NDArray[np.uint64]) -> Any:
    """Return ``uint64_t *``."""
    return ffi.from_buffer("uint64_t[]", array)


def ints(array: NDArray[np.int32]) -> Any:
    """Return ``int32_t *``."""
    return ffi.from_buffer("int32_t[]", array)


def floats(array: NDArray[np.float64]) -> Any:
    """Return ``double *``."""
    return ffi.from_buffer("double[]", array)


def shorts(array: NDArray[np.uint16]) -> Any:
    """Return ``uint16_t *``."""
    return ffi.from_buffer("uint16_t[]", array)


def octets(array: NDArray[np.uint8]) -> Any:
    """Return ``uint8_t *``."""
    return ffi.from_buffer("uint8_t[]", array)
