"""Values changed in the text of a configuration, whose comments and order stay."""

import tomllib
from collections.abc import Mapping

from robotd.core.errors import ConfigError
from robotd.toml.lines import key_lines
from robotd.toml.writer import write_value

Values = Mapping[str, Mapping[str, object]]
"""By section and key."""


def with_values(text: str, values: Values, note: str = "") -> str:
    """Return a configuration's text with values changed; what a line said before stays above it, as a comment.

    A key that is not there comes at the head of its section, a section that is not there at the end.

    Args:
        text: the TOML, which must be whole.
        values: what to set.
        note: said behind what was there before.

    Raises:
        ConfigError: the text is written so that a line cannot be set, as within an inline table.
    """
    wanted = tomllib.loads(text)
    for section, keys in values.items():
        wanted.setdefault(section, {}).update(
            {key: tomllib.loads(f"x = {write_value(v)}")["x"] for key, v in keys.items()}
        )
        for key, value in keys.items():
            text = _with_value(text, section, key, value, note)
    try:
        if tomllib.loads(text) == wanted:
            return text
    except tomllib.TOMLDecodeError:
        pass
    raise ConfigError("is written so that no line of it can be changed: set these by hand", key=", ".join(values))


def _with_value(text: str, section: str, key: str, value: object, note: str) -> str:
    lines, where = text.splitlines(), key_lines(text)
    said = f"{key} = {write_value(value)}"
    if (section, key) in where:
        at = where[section, key] - 1
        old = lines[at]
        indent = old[: len(old) - len(old.lstrip())]
        behind = f"  # {note}" if note else ""
        lines[at : at + 1] = [f"{indent}# {old.strip()}{behind}", f"{indent}{said}"]
    elif (section,) in where and lines[where[section,] - 1].lstrip().startswith("["):
        lines.insert(where[section,], said)
    else:
        lines += ["", f"[{section}]", said]
    return "\n".join(lines) + "\n"
