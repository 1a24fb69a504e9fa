"""Who holds a device: for the error message, as well as this process may know."""

import os
from pathlib import Path


def holder_of(path: str) -> str | None:
    """Return ``pid 123 (name)`` of a process that has ``path`` open, or None if none can be seen.

    A sandbox may hide other processes, or the table of locks.
    """
    try:
        # The table of locks is one file; the other way looks at every descriptor of every process.
        pid = _locking_pid(path)
    except OSError:
        pid = None
    pid = pid or _opening_pid(path)
    return None if pid is None else f"pid {pid} ({_name(pid)})"


def _locking_pid(path: str) -> int | None:
    device = Path(path).stat()
    wanted = f"{os.major(device.st_dev):02x}:{os.minor(device.st_dev):02x}:{device.st_ino}"
    for line in Path("/proc/locks").read_text().splitlines():
        fields = line.split()
        # 0 and -1 stand for a process that this one may not see.
        if wanted in fields and int(fields[fields.index(wanted) - 1]) > 0:
            return int(fields[fields.index(wanted) - 1])
    return None


def _opening_pid(path: str) -> int | None:
    wanted = os.path.realpath(path)
    for link in Path("/proc").glob("[0-9]*/fd/*"):
        try:
            if str(link.readlink()) == wanted:
                return int(link.parts[2])
        except OSError:
            continue  # not ours to look at, or gone meanwhile
    return None


def _name(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/comm").read_text().strip()
    except OSError:
        return "gone"
