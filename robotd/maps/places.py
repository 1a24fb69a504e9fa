"""Which names and numbers under a directory of maps are maps and versions; what else lies there is left alone."""

import itertools
import os
import re
from pathlib import Path

from robotd.core.errors import MapError
from robotd.maps.manifest import is_name

MAX_VERSION = 999_999_999
_VERSION = re.compile(r"[1-9][0-9]{0,8}")
_TEMPORARY = ".tmp-"


def directories(root: Path) -> tuple[str, ...]:
    """Return what could be maps, in order: directories whose name may name one. Raises OSError."""
    if not root.is_dir():
        return ()
    with os.scandir(root) as entries:
        return tuple(sorted(entry.name for entry in entries if is_name(entry.name) and _is_directory(entry)))


def versions(place: Path) -> tuple[int, ...]:
    """Return the versions of the map in ``place``, in order: directories with a number's name. Raises OSError."""
    if not place.is_dir():
        return ()
    with os.scandir(place) as entries:
        return tuple(
            sorted(int(entry.name) for entry in entries if _VERSION.fullmatch(entry.name) and _is_directory(entry))
        )


def _is_directory(entry: "os.DirEntry[str]") -> bool:
    try:
        return entry.is_dir()
    except OSError:  # a link that cannot be followed: one bad entry is no reason to know of no other
        return False


def next_version(place: Path) -> int:
    """Return the number of the next version: above every one there is, and not in the place of something else.

    Raises:
        MapError: the numbers have run out, as they do when somebody makes a directory of that name.
        OSError: the disk refused.
    """
    highest = max(versions(place), default=0)
    # lexists: a link that leads nowhere has the name all the same.
    free = (number for number in range(highest + 1, MAX_VERSION + 1) if not os.path.lexists(place / str(number)))
    number = next(free, None)
    if number is None:
        last = place / str(highest)
        raise MapError(
            f"cannot save map {place.name}: no version comes after {last}: move that away, or save by another name"
        )
    return number


def temporary_place(root: Path, name: str, version: int) -> Path:
    """Return where to write a version before it is one: a place where nothing is, even if a leftover will not go."""
    stem = f"{_TEMPORARY}{name}-{version}"
    places = (root / (f"{stem}-{number}" if number else stem) for number in itertools.count())
    return next(place for place in places if not os.path.lexists(place))


def leftovers(root: Path) -> tuple[Path, ...]:
    """Return what writers that ended halfway left behind; a file of such a name is nothing of theirs."""
    return tuple(path for path in root.glob(f"{_TEMPORARY}*") if path.is_dir() and not path.is_symlink())


def check_new_name(name: str, present: tuple[str, ...]) -> None:
    """Refuse a new name that some file systems would take for another, or cut.

    Raises:
        MapError: it differs from one that is present in capitals alone, or ends with a dot.
    """
    if name in present:
        return
    twin = next((other for other in present if other.lower() == name.lower()), None)
    if twin is not None:
        raise MapError(f"map {name} would differ from map {twin} in capitals alone: take another name, or {twin}")
    if name.endswith("."):
        raise MapError(f"{name!r} cannot name a new map: some file systems drop a dot at the end")
