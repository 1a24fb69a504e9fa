"""Configurations as files and texts."""

import shlex
from functools import partial
from pathlib import Path
from typing import Any

from robotd.config.environment import runtime_dir
from robotd.config.locations import locate
from robotd.config.tree import Config
from robotd.core.endpoints import Endpoints
from robotd.core.errors import ConfigError, TransportError
from robotd.toml.problems import Problems
from robotd.toml.settings_reader import read_file, read_text
from robotd.toml.writer import write_table


def load(path: Path) -> Config:
    """Return the configuration of a file.

    In its directories and paths ``~`` and variables are replaced; directories that are not absolute begin where the
    file is.

    Raises:
        ConfigError: all that is wrong with it, in ``problems``.
    """
    if not path.exists():
        made = shlex.join(("robotctl", "config", "init", str(path)))
        raise ConfigError(f"there is no such file; make one, with: {made}", file=str(path))
    return read_file(Config, path, partial(_prepare, directory=path.absolute().parent))


def loads(text: str, file: str = "configuration") -> Config:
    """Return the configuration of a text, which complaints call ``file``; directories stay as they are written.

    Raises:
        ConfigError: all that is wrong with it, in ``problems``.
    """
    return read_text(Config, text, file)


def effective_text(config: Config) -> str:
    """Return a configuration as TOML, with every key: it loads to the same configuration, wherever it lies."""
    return write_table(config)


def _prepare(table: dict[str, Any], problems: Problems, directory: Path) -> None:
    locate(table, problems, directory)
    section = table.get("server", {})
    # After `locate`, for what must fit into a socket's address is the path in full.
    written = section.get("runtime_dir", runtime_dir()) if isinstance(section, dict) else ""
    try:
        Endpoints(Path(written if isinstance(written, str) else ""))
    except TransportError as error:
        problems.add(("server", "runtime_dir"), str(error))
