"""What was made last, kept for the next that needs the same."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

Made = TypeVar("Made")


@dataclass(slots=True, eq=False)
class LastMade(Generic[Made]):
    """One thing and its key: a process that works through a thousand logs keeps one map."""

    _kept: tuple[str, Made] | None = None

    def of(self, key: str, make: Callable[[], Made]) -> Made:
        """Return what was made last if it has this key, else make it."""
        kept = self._kept  # read once: another thread of a worker may put its own there
        if kept is None or kept[0] != key:
            kept = self._kept = (key, make())
        return kept[1]
