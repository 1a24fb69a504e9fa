"""Directories and paths in a configuration file: ``~`` and variables replaced, and where relative ones begin."""

import re
from pathlib import Path
from typing import Any

from robotd.config.environment import home_of, variable
from robotd.toml.lines import KeyPath
from robotd.toml.problems import Problems

DIRECTORIES: tuple[KeyPath, ...] = (("server", "runtime_dir"), ("maps", "dir"), ("recording", "dir"))
PORTS: tuple[KeyPath, ...] = (("drive", "port"), ("pantilt", "port"), ("rangefinder", "port"))

_VARIABLE = re.compile(r"\$(?:(?P<plain>[A-Za-z_][A-Za-z0-9_]*)|\{(?P<braced>[^}]*)\})")


def locate(table: dict[str, Any], problems: Problems, directory: Path) -> None:
    """Replace ``~``, ``$NAME`` and ``${NAME}`` in every path; let relative directories begin at ``directory``.

    A path that cannot be resolved is taken out of the table, and why is added to ``problems``.
    """
    for section, key in (*DIRECTORIES, *PORTS):
        written = table[section].get(key) if isinstance(table.get(section), dict) else None
        # What is no path is left to the reader, which says what was expected.
        if not isinstance(written, str) or not written or "\0" in written:
            continue
        try:
            path = expanded(written)
        except ValueError as error:
            problems.add((section, key), str(error))
            del table[section][key]
            continue
        table[section][key] = str(directory / path) if (section, key) in DIRECTORIES else path


def expanded(path: str) -> str:
    """Return a path with ``~``, ``~user``, ``$NAME`` and ``${NAME}`` replaced, as a shell does.

    A ``$`` that no name follows stays. What a variable holds is not looked through again.

    Raises:
        ValueError: there is no such variable, or it is empty, or nobody's home is meant.
    """
    if not path.startswith("~"):
        return _VARIABLE.sub(_value, path)
    user, slash, rest = path.partition("/")
    return home_of(user) + slash + _VARIABLE.sub(_value, rest)


def _value(match: re.Match[str]) -> str:
    name = match["plain"] or match["braced"] or ""
    value = variable(name)
    if not value:
        raise ValueError(f"the environment has no variable {name or '${}'}: set it, or write the path out")
    return value
