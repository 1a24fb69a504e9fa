"""One writer at a time in a directory of maps, whichever process it belongs to; readers need no leave."""

import contextlib
import fcntl
import os
import stat
import threading
from collections.abc import Iterator
from pathlib import Path

from robotd.core.errors import MapError

_NAME = ".lock"
_PAUSE_S = 0.02
WAIT_S = 20.0
"""Longer than the largest map takes to reach a slow disk, shorter than a client waits for its answer."""


@contextlib.contextmanager
def sole_writer(root: Path, wait_s: float = WAIT_S) -> Iterator[None]:
    """Keep every other writer out of ``root``, which must exist, for the length of a ``with`` block.

    The lock is the kernel's and ends with the process, however it ends; the file stays behind. Anyone who may open the
    file may hold it: so nobody may who could not write beside it anyway.

    Raises:
        MapError: another writer held it for all of ``wait_s`` [s]; names its process.
        OSError: the lock cannot be had here.
    """
    descriptor = _locked(root, wait_s)
    try:
        _say_whose(descriptor)
        yield
    finally:
        os.close(descriptor)


def _locked(root: Path, wait_s: float) -> int:
    for _ in range(max(1, round(wait_s / _PAUSE_S))):
        descriptor = _opened(root)
        try:
            # Again and again rather than once and waiting: a flock that waits cannot be given up.
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if _is_still(root / _NAME, descriptor):
                return descriptor
        except BlockingIOError:
            holder = os.pread(descriptor, 32, 0).decode(errors="replace").strip()
        except BaseException:
            os.close(descriptor)
            raise
        else:
            holder = ""
        os.close(descriptor)
        threading.Event().wait(_PAUSE_S)
    whose = f"process {holder}" if holder.isdecimal() else "another process"
    raise MapError(f"{whose} has been writing to {root} for {wait_s:.0f} s; nothing was changed: try again")


def _opened(root: Path) -> int:
    place = root.stat()
    writers = place.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
    flags = os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK
    descriptor = os.open(root / _NAME, flags, 0o600)
    with contextlib.suppress(PermissionError):  # it is another writer's file, who has seen to it
        if os.geteuid() == 0:  # a save by root must not lock out the daemon, whose directory it is
            os.fchown(descriptor, place.st_uid, place.st_gid)
        # Shifted by one a right to write is one to read: the file is opened for both.
        os.fchmod(descriptor, 0o600 | writers | writers << 1)
    return descriptor


def _is_still(path: Path, descriptor: int) -> bool:
    """Return whether the name leads to the file that we locked: somebody may have removed it while we waited."""
    try:
        return os.path.samestat(path.stat(), os.fstat(descriptor))
    except FileNotFoundError:
        return False


def _say_whose(descriptor: int) -> None:
    with contextlib.suppress(OSError):  # a full disk: the lock holds all the same, only nobody learns whose it is
        os.ftruncate(descriptor, 0)
        os.pwrite(descriptor, f"{os.getpid()}\n".encode(), 0)
