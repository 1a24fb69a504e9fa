"""One way of a form, in or out, as it was tried."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Trip:
    """What went, and how far what came back is from it."""

    form: str
    way: str
    """``in`` or ``out``."""
    size_bytes: int
    holds: str
    worst: float
    allowed: float
    unit: str
    reader: str
    """Whose program read it, or wrote what is read."""

    @property
    def is_true(self) -> bool:
        """Whether what came back is as near as is promised."""
        return self.worst <= self.allowed


def size_bytes(path: Path) -> int:
    """Return how large a file is, or all in a directory."""
    return sum(one.stat().st_size for one in ([path] if path.is_file() else path.rglob("*")) if one.is_file())
