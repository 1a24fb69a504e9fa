"""How much memory a process has."""

import os
from pathlib import Path


def resident_bytes(pid: int | None = None) -> float:
    """Return how much of a process is in memory, of this one if None; 0 of one that is not there."""
    whose = "self" if pid is None else str(pid)
    try:
        pages = Path(f"/proc/{whose}/statm").read_text(encoding="ascii").split()[1]
    except (OSError, IndexError):
        return 0.0
    return float(int(pages) * os.sysconf("SC_PAGE_SIZE"))
