"""The files of the console as they were built: in memory, packed once, under names that tell their content."""

import gzip
import hashlib
import mimetypes
from dataclasses import dataclass
from importlib import resources
from importlib.resources.abc import Traversable

BUILT = "built"
_PACKED = {".js", ".css", ".html", ".svg", ".json", ".webmanifest", ".txt"}


@dataclass(frozen=True, slots=True)
class ConsoleFile:
    """One file of the console as it is served: its bytes, plain and packed, and its type."""

    data: bytes
    packed: bytes | None
    """The same by gzip, where that is worth it."""
    content_type: str
    is_named_by_content: bool
    """Whether it may be kept for ever: another content has another name."""


class ConsoleFiles:
    """What is served to everybody, signed in or not: no secret is in it."""

    def __init__(self) -> None:
        root = resources.files("robotd.gateway.web") / BUILT
        self._files = dict(_found(root, "")) if root.is_dir() else {}
        content = b"".join(file.data for _, file in sorted(self._files.items()))
        self.version = hashlib.sha256(content).hexdigest()[:12]
        """Changes with every build; a page that is older offers to load itself again."""

    @property
    def are_built(self) -> bool:
        """Whether there is a console at all."""
        return "index.html" in self._files

    def find(self, name: str) -> ConsoleFile | None:
        """Return a file by its name, as ``app/console-ABC.js``."""
        return self._files.get(name)


def _found(folder: Traversable, prefix: str) -> list[tuple[str, ConsoleFile]]:
    found: list[tuple[str, ConsoleFile]] = []
    for item in folder.iterdir():
        name = f"{prefix}{item.name}"
        found.extend(_found(item, f"{name}/") if item.is_dir() else [(name, _read(name, item.read_bytes()))])
    return found


def _read(name: str, data: bytes) -> ConsoleFile:
    ending = f".{name.rpartition('.')[2]}"
    content_type = {".js": "text/javascript", ".webmanifest": "application/manifest+json"}.get(ending)
    content_type = content_type or mimetypes.guess_type(name)[0] or "application/octet-stream"
    packed = gzip.compress(data, 9, mtime=0) if ending in _PACKED else None
    return ConsoleFile(data, packed, content_type, is_named_by_content="-" in name and name.startswith("app/"))
