"""What is left to a child of the files of this machine: its program, and a directory in which it makes sockets.

It opens no device, map or recording, starts no program, and sends no signal to its parent; the same user may do all of
that, and a child that strangers talk to may go wrong in whatever way.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

from robotd.children.landlock import Access, confine, no_new_privileges

_READ = Access.READ_FILE | Access.READ_DIR
_MAKE_SOCKETS = Access.READ_DIR | Access.MAKE_SOCK | Access.REMOVE_FILE
_PACKAGE = Path(__file__).parents[1]


def confine_to_program(sockets_in: str) -> str:
    """Give up all files but those; return why the kernel does not take it, empty if it does.

    To be called before there are threads: what they may do is not changed by it.
    """
    allowed = dict.fromkeys(_program(), _READ)
    if sockets_in:
        # It may remove its sockets as well: what a killed front left behind is in the way of the next one's
        # bind.
        allowed[Path(sockets_in).absolute()] = _MAKE_SOCKETS
    try:
        confine(allowed)
    except OSError as error:
        # All that is left where the kernel has no Landlock: no program that it might start can be more than it
        # is.
        no_new_privileges()
        return error.strerror or str(error)
    return ""


def _program() -> Iterator[Path]:
    """Yield where Python, what it imports, and the libraries of these lie."""
    yield from (_PACKAGE, Path(sys.prefix), Path(sys.base_prefix))
    yield from (place for place in map(Path, sys.path) if place.is_absolute())
    yield from (Path("/usr"), Path("/lib"), Path("/lib64"), Path("/etc/ld.so.cache"))
    # The log's clock, and how many processors there are, which the libraries of linear algebra ask for.
    yield from (Path("/etc/localtime"), Path("/sys/devices/system/cpu"))
