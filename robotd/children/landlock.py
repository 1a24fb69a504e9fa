"""What this process may still do with files, whatever user it runs as: given up for good, by Landlock of Linux.

Names and numbers are those of ``linux/landlock.h``; its three system calls have the same numbers on x86-64, aarch64
and all else that a robot has. What the running kernel cannot refuse yet is left out: each version of the interface adds
to the one before.
"""

import ctypes
import enum
import os
import struct
from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from pathlib import Path

_CREATE_RULESET, _ADD_RULE, _RESTRICT_SELF = 444, 445, 446
_ONLY_THE_VERSION = 1
_PATH_BENEATH = 1
_PR_SET_NO_NEW_PRIVS = 38
_RULESET = struct.Struct("=QQQ")
_RULE = struct.Struct("=Qi")
_NO_TCP = 0b11
_NO_ABSTRACT_SOCKETS_NO_SIGNALS = 0b11

_libc = ctypes.CDLL(None, use_errno=True)


class Access(enum.Flag):
    """What is done with a file, or in a directory."""

    EXECUTE = enum.auto()
    WRITE_FILE = enum.auto()
    READ_FILE = enum.auto()
    READ_DIR = enum.auto()
    REMOVE_DIR = enum.auto()
    REMOVE_FILE = enum.auto()
    MAKE_CHAR = enum.auto()
    MAKE_DIR = enum.auto()
    MAKE_REG = enum.auto()
    MAKE_SOCK = enum.auto()
    MAKE_FIFO = enum.auto()
    MAKE_BLOCK = enum.auto()
    MAKE_SYM = enum.auto()
    REFER = enum.auto()
    TRUNCATE = enum.auto()
    IOCTL_DEV = enum.auto()

    OF_A_FILE = EXECUTE | WRITE_FILE | READ_FILE | TRUNCATE | IOCTL_DEV
    """The rest has a meaning for directories alone."""


_SINCE = {Access.REFER: 2, Access.TRUNCATE: 3, Access.IOCTL_DEV: 5}
"""The version of the interface that can refuse it, where that is not the first."""


def version() -> int:
    """Return the version of the interface that the kernel has; OSError if it has none, or refuses to tell."""
    return _called(_CREATE_RULESET, None, ctypes.c_size_t(0), _ONLY_THE_VERSION)


def no_new_privileges() -> None:
    """Let no program that this process starts have more rights than it has."""
    _libc.prctl(_PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)


def confine(allowed: Mapping[Path, Access]) -> None:
    """Give up all that is done with files but this; TCP as well, and to send signals to others.

    It holds for the calling thread and for the threads and processes that it starts, and for what is opened from here
    on: what is open stays so.

    Args:
        allowed: what may be done with a file, or below a directory. What is not there is left out.

    Raises:
        OSError: the kernel has no Landlock, or refuses it.
    """
    there = version()
    # A right that this kernel does not know would make it refuse all of them.
    handled = _all(access for access in Access if _SINCE.get(access, 1) <= there)
    tcp, scoped = _NO_TCP if there >= 4 else 0, _NO_ABSTRACT_SOCKETS_NO_SIGNALS if there >= 6 else 0
    attributes = _RULESET.pack(handled.value, tcp, scoped)
    no_new_privileges()  # without which the kernel refuses it
    with ExitStack() as stack:
        ruleset = _called(_CREATE_RULESET, attributes, ctypes.c_size_t(len(attributes)), 0)
        stack.callback(os.close, ruleset)
        for path, access in allowed.items():
            _allow(ruleset, path, access & handled)
        _called(_RESTRICT_SELF, ruleset, 0)


def _allow(ruleset: int, path: Path, access: Access) -> None:
    try:
        # A handle for naming alone: the child need not have the right to read what it is allowed to list.
        place = os.open(path, os.O_PATH | os.O_CLOEXEC)
    except FileNotFoundError:
        return
    try:
        # Rights of directories on a plain file are an error to the kernel.
        rights = access if path.is_dir() else access & Access.OF_A_FILE
        _called(_ADD_RULE, ruleset, _PATH_BENEATH, _RULE.pack(rights.value, place), 0)
    finally:
        os.close(place)


def _all(rights: Iterable[Access]) -> Access:
    together = Access(0)
    for one in rights:
        together |= one
    return together


def _called(*arguments: object) -> int:
    result: int = _libc.syscall(*arguments)
    if result < 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))
    return result
