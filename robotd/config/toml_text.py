"""From the text of a TOML file to settings of any kind, or to all that is wrong with it."""

import contextlib
import re
import tomllib
from collections.abc import Callable
from typing import Any, TypeVar

from robotd.config.lines import key_lines
from robotd.config.problems import Problems
from robotd.config.table_reader import Bad, read_table
from robotd.core.errors import ConfigError, ConfigErrors

T = TypeVar("T")
_BYTE_ORDER_MARK = "\ufeff"

_PLACE = re.compile(r" \((?:at line (?P<line>\d+), column \d+|at end of document)\)$")


Prepare = Callable[[dict[str, Any], Problems], None]


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
