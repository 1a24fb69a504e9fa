"""A disk whose every change is watched: what a process that is killed before the next one leaves on it."""

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

_CHANGING = ("open", "write", "fsync", "rename", "mkdir")


class WatchedOs:
    """:mod:`os` for :mod:`robotd.maps.atomic`: before each call that may change the disk, a directory is copied."""

    def __init__(self, root: Path, copies: Path, seen: Callable[[], None]) -> None:
        """Watch ``root``; number n of its copies is what is left by who is killed just before change n."""
        self.changes = 0
        self._root = root
        self._copies = copies
        self._seen = seen

    def __getattr__(self, name: str) -> Any:
        """Return what :mod:`os` has, or the same watched."""
        real = getattr(os, name)
        if name not in _CHANGING:
            return real

        def watched(*arguments: Any) -> Any:
            self.copy()
            return real(*arguments)

        return watched

    def copy(self) -> None:
        """Copy what is there by now."""
        place = self.at(self.changes)
        if self._root.is_dir():
            shutil.copytree(self._root, place)
        else:
            place.mkdir(parents=True)
        self.changes += 1
        self._seen()

    def at(self, change: int) -> Path:
        """Return the copy that was made before a change."""
        return self._copies / str(change)
