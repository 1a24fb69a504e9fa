"""Trials one after the other, each within its time: no study waits for ever for what does not come."""

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from robotd.core.errors import RobotdError

LONGEST_S = 120.0
GIVEN_UP_AFTER = 3

T = TypeVar("T")


@dataclass
class Repeated(Generic[T]):
    """What came of trials."""

    found: list[T] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)
    """Why some found nothing; more than a few are not waited for."""


async def repeated(trials: int, trial: Callable[[], Awaitable[T]]) -> Repeated[T]:
    """Make trials, until too many have failed."""
    result: Repeated[T] = Repeated()
    for number in range(trials):
        try:
            async with asyncio.timeout(LONGEST_S):
                result.found.append(await trial())
        except (TimeoutError, RobotdError, OSError) as error:
            result.failures.append(f"trial {number}: {error or f'nothing within {LONGEST_S:g} s'}")
            if len(result.failures) == GIVEN_UP_AFTER:
                break
    return result
