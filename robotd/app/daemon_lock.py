"""One daemon per runtime directory: a second bind would silently steal the first one's sockets."""

import contextlib
import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from robotd.core.errors import TransportError

_NAME = "robotd.lock"
_MODE = 0o600


@contextmanager
def lock_directory(directory: Path) -> Iterator[None]:
    """Hold the runtime directory, made if need be, for the length of a ``with`` block.

    The lock is the kernel's and ends with the process, however it ends; the file stays behind. Anyone who may open the
    file, if only to read it, may lock it and keep the daemon out: so nobody but the daemon's user may.

    Raises:
        TransportError: another process holds it, or the directory cannot be had.
    """
    try:
        directory.mkdir(mode=0o750, parents=True, exist_ok=True)
        # O_NOFOLLOW: what lies there may be a link, and the file behind it would be emptied.
        descriptor = os.open(directory / _NAME, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, _MODE)
    except OSError as error:
        raise _unusable(directory, error) from error
    try:
        _lock(descriptor, directory)
        yield
    finally:
        with contextlib.suppress(OSError):  # the descriptor is gone all the same, and the lock with it
            os.close(descriptor)


def _unusable(directory: Path, error: OSError) -> TransportError:
    return TransportError(f"runtime directory {directory}: {error.strerror}")


def _lock(descriptor: int, directory: Path) -> None:
    try:
        os.fchmod(descriptor, _MODE)  # one of an earlier version may be open to the group
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise TransportError(f"another robotd (process {_holder(descriptor)}) serves from {directory}") from None
    except OSError as error:
        raise _unusable(directory, error) from error
    with contextlib.suppress(OSError):  # a full disk: the lock holds all the same, only nobody learns whose it is
        os.ftruncate(descriptor, 0)
        os.pwrite(descriptor, f"{os.getpid()}\n".encode(), 0)


def _holder(descriptor: int) -> str:
    try:
        return os.pread(descriptor, 32, 0).decode(errors="replace").strip() or "unknown"
    except OSError:  # that somebody holds it is what matters
        return "unknown"
