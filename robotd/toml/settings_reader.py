"""From a TOML file, or its text, to settings of any kind, or to all that is wrong with it."""

import codecs
import contextlib
import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from robotd.core.errors import ConfigError, ConfigErrors
from robotd.toml.lines import key_lines
from robotd.toml.problems import Problems
from robotd.toml.table_reader import Bad, read_table

T = TypeVar("T")
_BYTE_ORDER_MARK = "\ufeff"
_UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE, codecs.BOM_UTF32_BE)  # UTF-32-LE begins as UTF-16-LE does
_WIDEST_LETTER = 4

_PLACE = re.compile(r" \((?:at line (?P<line>\d+), column \d+|at end of document)\)$")


Prepare = Callable[[dict[str, Any], Problems], None]


def read_file(kind: type[T], path: Path, prepare: Prepare | None = None) -> T:
    """Return the dataclass ``kind`` as a TOML file describes it; as :func:`read_text`.

    Raises:
        ConfigError: all that is wrong with it, in ``problems``; or it cannot be read.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ConfigError(f"cannot be read: {error.strerror}", file=str(path)) from error
    return read_text(kind, _decoded(data, str(path)), str(path), prepare)


def read_text(kind: type[T], text: str, file: str, prepare: Prepare | None = None) -> T:
    """Return the dataclass ``kind`` as a TOML text describes it.

    Args:
        kind: what it shall be.
        text: the TOML.
        file: what the text is called in complaints.
        prepare: changes the values as they were parsed, before they are judged, and adds what is wrong with them.

    Raises:
        ConfigErrors: all that is wrong with it, one problem each with file, line and key.
        ConfigError: it is not TOML; only the first mistake can be named.
    """
    try:
        table = tomllib.loads(text.removeprefix(_BYTE_ORDER_MARK))
    except tomllib.TOMLDecodeError as error:
        raise _not_toml(str(error), text, file) from None
    except RecursionError:
        raise ConfigError("not TOML: brackets within brackets without end", file=file) from None
    problems = Problems(file, key_lines(text.removeprefix(_BYTE_ORDER_MARK)))
    if prepare is not None:
        prepare(table, problems)
    with contextlib.suppress(Bad):
        made = read_table(kind, table, (), problems)
        if not problems.found:
            return made
    raise ConfigErrors(problems.sorted())


def _not_toml(message: str, text: str, file: str) -> ConfigError:
    place = _PLACE.search(message)
    line = int(place["line"]) if place and place["line"] else max(1, len(text.splitlines()))
    what = _PLACE.sub("", message)
    return ConfigError(f"not TOML: {what[:1].lower()}{what[1:]}", file=file, line=line)


def _decoded(data: bytes, file: str) -> str:
    """Return the text of a file; a byte order mark before it is no part of it."""
    if data.startswith(_UTF_16) or b"\0" in data[:_WIDEST_LETTER]:
        raise ConfigError("not TOML: UTF-16 or UTF-32; save it as UTF-8", file=file, line=1)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = error.object.count(b"\n", 0, error.start) + 1
        raise ConfigError("not TOML: not UTF-8", file=file, line=line) from error
