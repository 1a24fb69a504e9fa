"""Counts what a sweep does, whatever the machine: exact predicates, and the curves that are intersected."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Any
from unittest.mock import patch

from robotd.exact import points, sweep
from robotd.exact.supports import HalfCircle, SupportLine


@dataclass(slots=True)
class Operations:
    """How often a sweep asked something of numbers."""

    comparisons: int = 0
    """Of two points: the queue."""
    sides: int = 0
    """Of a point and a curve: the status."""
    orders: int = 0
    """Of two curves through a point: what leaves an event."""
    intersections: int = 0
    """Of two neighbours."""

    @property
    def all_of_them(self) -> int:
        """Their sum."""
        return self.comparisons + self.sides + self.orders + self.intersections


_COUNTED = (
    (points, "compare_points", "comparisons"),
    (SupportLine, "side", "sides"),
    (HalfCircle, "side", "sides"),
    (sweep, "order_after", "orders"),
    (sweep, "crossings", "intersections"),
)


@contextmanager
def counted() -> Iterator[Operations]:
    """Count everything that is asked meanwhile."""
    operations = Operations()
    with ExitStack() as stack:
        for place, name, counter in _COUNTED:
            stack.enter_context(patch.object(place, name, _counting(getattr(place, name), operations, counter)))
        yield operations


def _counting(work: Callable[..., Any], operations: Operations, counter: str) -> Callable[..., Any]:
    def count(*arguments: object) -> Any:
        setattr(operations, counter, getattr(operations, counter) + 1)
        return work(*arguments)

    return count
