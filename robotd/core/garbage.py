"""Garbage is looked for without keeping the loop: what has lived long is looked at once, and no more.

A full collection of Python's looks at all objects that are there, and holds the interpreter meanwhile. Fifty thousand
are there when the daemon has begun, and take 14 ms; what it remembers for recordings grows to some hundred thousand.
They are freed when nobody refers to them, as ever; what is given up by this is to find those that refer to each other
in a ring, if that was alive in a full collection before.
"""

import gc
from collections.abc import Iterator
from contextlib import contextmanager

_FULL = 2


@contextmanager
def looked_at_once() -> Iterator[None]:
    """Leave what is there out of all collections, and what a full one finds alive out of those to come."""
    gc.callbacks.append(_leave_out)
    gc.freeze()
    try:
        yield
    finally:
        gc.callbacks.remove(_leave_out)
        gc.unfreeze()


def _leave_out(phase: str, info: dict[str, int]) -> None:
    if phase == "stop" and info["generation"] == _FULL:
        gc.freeze()
