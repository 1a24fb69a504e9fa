"""Several duties that belong together, of which none may outlive another."""

import asyncio
from collections.abc import Coroutine
from typing import Any, NoReturn


async def together(*duties: Coroutine[Any, Any, object]) -> NoReturn:
    """Do all of them until one ends with an error; end the others, and raise that error."""
    tasks = [asyncio.ensure_future(duty) for duty in duties]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        ended = next(task for task in tasks if task.done())  # in their order: the same every time
    finally:
        for task in tasks:
            task.cancel()
        # Each is seen to its end: one left running would go on with what is given up.
        await asyncio.gather(*tasks, return_exceptions=True)
    ended.result()
    raise AssertionError("a duty only ends with an error")
