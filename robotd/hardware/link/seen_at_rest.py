"""The last thing on a line: it is not given up before its device was seen to rest, or for as long as that may take.

A stop is on the wire at once, but not every device obeys it at once: one hears only the first of two orders, of
another a byte was damaged. Whatever ends a conversation (a signal, an error of ours in whatever task), the device says
its stop again until it was obeyed, and only then the line is closed.
"""

import asyncio
from collections.abc import Coroutine
from typing import Any

from robotd.core.errors import RobotdError

REST_WITHIN_S = 0.3
"""Longest wait. A stop that was not heard in all that time is for the device's own watchdog, if it has one."""


async def seen_at_rest(coming_to_rest: Coroutine[Any, Any, None]) -> None:
    """Wait until a device was seen to rest, cannot be seen any more, or did not say so in :data:`REST_WITHIN_S`.

    To be cancelled meanwhile is to be hastened.
    """
    try:
        async with asyncio.timeout(REST_WITHIN_S):
            await coming_to_rest
    except (TimeoutError, RobotdError):
        return  # it was told; that the line is lost, or what it answers, is no news any more
