"""Arrays as the C side sees them: pointers that keep their array alive; partial functions, which cost least."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels._native import ffi

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
