"""A tree of settings as TOML that reads back to the same tree."""

import dataclasses
import enum
import json
from collections.abc import Iterator
from typing import Any


def write_table(settings: Any, name: str = "") -> str:
    """Return a dataclass as TOML: its plain keys, then a table for each dataclass inside; None is left out."""
    return "\n".join(_lines(settings, name)) + "\n"


def _lines(settings: Any, name: str) -> Iterator[str]:
    values = {item.name: getattr(settings, item.name) for item in dataclasses.fields(settings)}
    tables = {key: value for key, value in values.items() if dataclasses.is_dataclass(value)}
    keys = {key: value for key, value in values.items() if key not in tables and value is not None}
    if name and (keys or not tables):
        yield f"[{name}]"
    yield from (f"{key} = {write_value(value)}" for key, value in keys.items())
    for index, (key, value) in enumerate(tables.items()):
        if keys or index:
            yield ""
        yield from _lines(value, f"{name}.{key}" if name else key)


def write_value(value: object) -> str:
    """Return one value as TOML.

    >>> write_value((1.0, 0.5))
    '[1.0, 0.5]'
    """
    match value:
        case enum.Enum():
            return write_value(value.value)
        case bool():  # before int: to Python it is one
            return "true" if value else "false"
        case int() | float():
            return repr(value)
        case str():
            # A string of JSON is one of TOML, but for DEL, which TOML wants escaped.
            return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
        case tuple():
            return f"[{', '.join(map(write_value, value))}]"
        case _:
            raise TypeError(f"{type(value).__name__} has no place in a configuration")
