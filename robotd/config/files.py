"""Configurations as files and texts."""

import codecs
from functools import partial
from pathlib import Path
from typing import Any

from robotd.config.environment import runtime_dir
from robotd.config.locations import locate
from robotd.config.problems import Problems
from robotd.config.toml_text import read_text
from robotd.config.tree import Config
from robotd.config.writer import write_table
from robotd.core.endpoints import Endpoints
from robotd.core.errors import ConfigError, TransportError

_UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE, codecs.BOM_UTF32_BE)  # UTF-32-LE begins as UTF-16-LE does
_WIDEST_LETTER = 4


def load(path: Path) -> Config:
    """Return the configuration of a file.

    In its directories and paths ``~`` and variables are replaced; directories that are not absolute begin where the
    file is.

    Raises:
        ConfigError: all that is wrong with it, in ``problems``.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ConfigError(f"cannot be read: {error.strerror}", file=str(path)) from error
    return read_text(Config, _decoded(data, str(path)), str(path), partial(_prepare, directory=path.absolute().parent))


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


def _decoded(data: bytes, file: str) -> str:
    """Return the text of a file; a byte order mark before it is no part of it."""
    if data.startswith(_UTF_16) or b"\0" in data[:_WIDEST_LETTER]:
        raise ConfigError("not TOML: UTF-16 or UTF-32; save it as UTF-8", file=file, line=1)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = error.object.count(b"\n", 0, error.start) + 1
        raise ConfigError("not TOML: not UTF-8", file=file, line=line) from error
