"""One daemon per runtime directory: a second bind would silently steal the first one's sockets."""

import contextlib
import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from robotd.core.errors import TransportError

_NAME = "robotd.lock"


@contextmanager
def lock_directory(directory: Path) -> Iterator[None]:
    """Hold the runtime directory, made if need be, for the length of a ``with`` block.

    The lock is the kernel's and ends with the process, however it ends; the file stays behind.

    Raises:
        TransportError: another process holds it, or the directory cannot be had.
    """
    try:
        directory.mkdir(mode=0o750, parents=True, exist_ok=True)
        descriptor = os.open(directory / _NAME, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o640)
    except OSError as error:
        raise TransportError(f"runtime directory {directory}: {error.strerror}") from error
    try:
        _lock(descriptor, directory)
        yield
    finally:
        os.close(descriptor)


def _lock(descriptor: int, directory: Path) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        holder = os.pread(descriptor, 32, 0).decode(errors="replace").strip() or "unknown"
        raise TransportError(f"another robotd (process {holder}) serves from {directory}") from None
    with contextlib.suppress(OSError):  # a full disk: the lock holds all the same, only nobody learns whose it is
        os.ftruncate(descriptor, 0)
        os.pwrite(descriptor, f"{os.getpid()}\n".encode(), 0)
