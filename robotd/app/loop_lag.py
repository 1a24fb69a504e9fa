"""How late the heart's loop is, for who watches over many robots."""

import asyncio
from typing import NoReturn

from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.counted import Counted

_LOOK_EVERY_S = 0.1


async def measure_lag(counted: Counted) -> NoReturn:
    """Count ten times a second how much later than it asked for it is called."""
    while True:
        asked_ns = now_ns()
        await asyncio.sleep(_LOOK_EVERY_S)
        counted.observe("loop_lag_seconds", max(0.0, (now_ns() - asked_ns) / NS_PER_S - _LOOK_EVERY_S))
