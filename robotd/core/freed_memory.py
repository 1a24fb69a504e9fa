"""Memory that was freed goes back to the kernel."""

import ctypes
from contextlib import suppress

_M_MMAP_THRESHOLD = -3
_LARGE_BYTES = 2**20


def give_back_what_is_large() -> None:
    """Let this process keep nothing of what is large and was freed, a map's bytes for one.

    glibc does so only until the first time: what is as large as something that was freed before, up to 32 MiB, it takes
    from a heap that shrinks at its end alone. Where there is no glibc nothing happens.
    """
    with suppress(AttributeError):
        ctypes.CDLL(None).mallopt(_M_MMAP_THRESHOLD, _LARGE_BYTES)
