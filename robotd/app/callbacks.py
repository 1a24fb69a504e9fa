"""An error in a bare callback of the loop stops the robot: asyncio by itself would log it, and all would go on.

An error in a task ends the task and, with its group, the daemon. What a timer or a signal calls belongs to no task; nor
does what is told of a stall.
"""

import asyncio
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def stopping_on_errors(halt: Callable[[str], None]) -> Iterator[None]:
    """Stop the robot for each error in a callback of the running loop, for the length of a ``with`` block.

    Args:
        halt: stops it, and is told why.
    """
    loop = asyncio.get_running_loop()
    before = loop.get_exception_handler()

    def handle(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        error = context.get("exception")
        if "handle" in context and isinstance(error, Exception):  # the rest is of what was forgotten long ago
            halt(f"internal error: {error!r}")
        # After the stop: it writes a traceback, and a disk may take its time.
        loop.default_exception_handler(context)

    loop.set_exception_handler(handle)
    try:
        yield
    finally:
        loop.set_exception_handler(before)


def fail(error: Exception, what: str) -> None:
    """Treat an error as one of a bare callback of the running loop."""
    asyncio.get_running_loop().call_exception_handler({"message": what, "exception": error, "handle": None})
