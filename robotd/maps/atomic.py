"""Directories that appear on disk whole or not at all, whenever the power goes.

Everything is written beside its place, synced file by file, synced as a directory, renamed into place, and
the rename is synced. All calls that change maps are here, through :mod:`os`.
"""

import os
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path

_READABLE_BY_ALL = 0o644
_LISTABLE_BY_ALL = 0o755


Blocks = Iterable[bytes]
"""A file in pieces, as often as it is asked for: what is large is never in memory whole."""


def write_synced(path: Path, blocks: Blocks) -> None:
    """Write a new file down to the disk.

    Raises:
        OSError: it exists already, or the disk refused a part of it.
    """
    # Only a new one: to write into a file that is there would change it before its successor is whole.
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, _READABLE_BY_ALL)
    try:
        for block in blocks:
            rest = memoryview(block)
            while rest:
                # The disk may take a part alone, as it does when it is nearly full.
                rest = rest[os.write(descriptor, rest) :]
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def sync_directory(path: Path) -> None:
    """Bring the names in a directory down to the disk; raises OSError."""
    descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def make_directory(path: Path) -> None:
    """Make a directory, and those it lies in, unless they are there; raises OSError."""
    if path.is_dir():
        return
    if path.parent != path:
        make_directory(path.parent)
    os.mkdir(path, _LISTABLE_BY_ALL)  # noqa: PTH102  # every change of the disk goes through os, for the fault tests
    # Its own name, too, or power that fails would take all maps in it along.
    sync_directory(path.parent)


def publish_directory(temporary: Path, final: Path, files: Mapping[str, Blocks]) -> None:
    """Make the directory ``final`` with these files: after a crash at any moment it is there whole, or not there.

    ``temporary`` must lie on the same file system; after a crash it may be left behind.

    Raises:
        OSError: ``final`` exists already, or the disk refused.
    """
    make_directory(temporary)
    for name, blocks in files.items():
        write_synced(temporary / name, blocks)
    sync_directory(temporary)  # before its name: the disk may write the two in another order than we did
    os.rename(temporary, final)  # noqa: PTH104  # every change of the disk goes through os, for the fault tests
    sync_directory(final.parent)


def replace_file(temporary: Path, final: Path, data: bytes) -> None:
    """Put another file in the place of one: after a crash at any moment there is the old one or the new, whole.

    ``temporary``, a directory to be, must lie on the same file system; after a crash it may be left behind.

    Raises:
        OSError: the disk refused.
    """
    make_directory(temporary)
    write_synced(temporary / final.name, (data,))
    os.rename(temporary / final.name, final)  # noqa: PTH104  # every change of the disk goes through os, for the fault tests
    sync_directory(final.parent)
    remove_leftover(temporary)


def withdraw_directory(path: Path, bin_path: Path) -> None:
    """Take a directory out of its place in one step, then remove it bit by bit; raises OSError."""
    # First the name: a reader finds it whole or not at all, never half removed.
    os.rename(path, bin_path)  # noqa: PTH104  # every change of the disk goes through os, for the fault tests
    remove_leftover(bin_path)


def remove_leftover(path: Path) -> None:
    """Remove a directory that is not in use, as far as that is possible."""
    # What will not go does no harm: temporary places are sought round it.
    shutil.rmtree(path, ignore_errors=True)
