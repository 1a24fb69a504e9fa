"""Several duties of one conversation, of which none may outlive another."""

import asyncio
from collections.abc import Coroutine
from typing import Any, NoReturn


async def together(*duties: Coroutine[Any, Any, NoReturn]) -> NoReturn:
    """Do all of them until one ends with an error; end the others, and raise that error."""
    tasks = [asyncio.ensure_future(duty) for duty in duties]
    try:
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
    done.pop().result()
    raise AssertionError("a duty only ends with an error")
