"""Which steps from line to line a parser's own code takes."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

Arc = tuple[str, int, int]
"""File, line, next line."""


class Coverage:
    """Collects the arcs of some files while it watches; the rest runs untraced."""

    def __init__(self, files: frozenset[str]) -> None:
        self._files = files
        self.arcs: set[Arc] = set()

    @contextmanager
    def watching(self) -> Iterator[None]:
        """Watch what runs in the block."""
        before = sys.gettrace()
        sys.settrace(self._called)
        try:
            yield
        finally:
            sys.settrace(before)

    def _called(self, frame: FrameType, event: str, argument: Any) -> Callable[..., Any] | None:
        file = frame.f_code.co_filename
        if file not in self._files:
            return None
        arcs, last = self.arcs, 0

        def stepped(frame: FrameType, event: str, argument: Any) -> Callable[..., Any]:
            nonlocal last
            line = frame.f_lineno
            arcs.add((file, last, line))
            last = line
            return stepped

        return stepped
