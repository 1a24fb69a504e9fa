"""Several duties that belong together, of which none may outlive another."""

import asyncio
from collections.abc import Coroutine, Iterable
from typing import Any, NoReturn


async def together(*duties: Coroutine[Any, Any, object]) -> NoReturn:
    """Do all of them until one ends with an error; end the others, and raise that error."""
    tasks = [asyncio.ensure_future(duty) for duty in duties]
    try:
        # Not a task group: that would raise groups of errors, and callers tell one error from another by its
        # type.
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        first = next(task for task in tasks if task.done())  # in their order: the same every time
    finally:
        await ended(tasks)
    first.result()
    raise AssertionError("a duty only ends with an error")


async def ended(tasks: Iterable["asyncio.Future[Any]"]) -> list[Exception]:
    """Cancel tasks, see each to its end, and return what they raised by themselves: to be cancelled is no error."""
    waited = list(tasks)
    for task in waited:
        task.cancel()
    # One left running would go on with what is given up.
    outcomes = await asyncio.gather(*waited, return_exceptions=True)
    return [outcome for outcome in outcomes if isinstance(outcome, Exception)]
