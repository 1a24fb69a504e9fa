"""In which line of a TOML text each key stands; tomllib does not say."""

import re
import tomllib
from collections.abc import Iterator
from typing import Any

KeyPath = tuple[str, ...]

_TOKEN = re.compile(
    r'''"""(?:\\.|[^\\])*?"{3,5}|\'\'\'.*?\'{3,5}'''  # multi-line strings
    r"""|"(?:\\.|[^"\\\n])*"|'[^'\n]*\'"""  # strings
    r"""|\#[^\n]*|\n|[\[\]{}=]|[^\[\]{}=\#"'\n]+""",
    re.DOTALL,
)
_STEP = {"[": 1, "{": 1, "]": -1, "}": -1}


def key_lines(text: str) -> dict[KeyPath, int]:
    """Return the line, from 1, of every table header and key of a text that tomllib accepts.

    Keys inside an inline table or an array are not listed: they stand where their parent stands.
    O(n) in the length of the text.
    """
    lines: dict[KeyPath, int] = {}
    table: KeyPath = ()
    for number, statement in _statements(text):
        if statement.startswith("["):
            table = _path(statement.strip("[] \t"))
            lines.setdefault(table, number)
            continue
        path = table + _path(statement)
        for length in range(len(table) + 1, len(path) + 1):
            # A dotted key makes the tables before its last part; each stands where it was named first.
            lines.setdefault(path[:length], number)
    return lines


def line_of(lines: dict[KeyPath, int], path: KeyPath) -> int | None:
    """Return the line of a key, or of the nearest table around it that the text has."""
    while path:
        if path in lines:
            return lines[path]
        path = path[:-1]
    return None


def _statements(text: str) -> Iterator[tuple[int, str]]:
    """Yield ``(line, header or key)`` for each statement: a value goes on until a newline outside all brackets."""
    number, depth, start, head, in_value = 1, 0, 1, "", False
    for token in _TOKEN.findall(text.replace("\r\n", "\n") + "\n"):
        if token == "\n" and depth == 0:
            if head.strip():
                yield start, head.strip()
            head, in_value, start = "", False, number + 1
        elif token == "=" and depth == 0:
            in_value = True
        elif not in_value and not token.startswith("#"):
            head += token
        if in_value:
            depth += _STEP.get(token, 0)
        number += token.count("\n")


def _path(key: str) -> KeyPath:
    """Return the parts of a possibly dotted and quoted key."""
    parts: list[str] = []
    node: Any = tomllib.loads(f"{key} = 0")
    while isinstance(node, dict):
        [(name, node)] = node.items()
        parts.append(name)
    return tuple(parts)
