"""Configurations as files and texts."""

from dataclasses import replace
from pathlib import Path

from robotd.config.lines import key_lines, line_of
from robotd.config.text import read_text
from robotd.config.tree import Config
from robotd.config.writer import write_table
from robotd.core.errors import ConfigError, TransportError
from robotd.server.endpoints import Endpoints


def load(path: Path) -> Config:
    """Return the configuration of a file; directories in it that are not absolute begin where the file is.

    Raises:
        ConfigError: all that is wrong with it, in ``problems``.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise ConfigError(f"cannot be read: {error.strerror}", file=str(path)) from error
    except UnicodeDecodeError as error:
        line = error.object.count(b"\n", 0, error.start) + 1
        raise ConfigError("not TOML: not UTF-8", file=str(path), line=line) from error
    config = _anchored(loads(text, file=str(path)), path.absolute().parent)
    try:
        Endpoints(Path(config.server.runtime_dir))
    except TransportError as error:
        at = line_of(key_lines(text), ("server", "runtime_dir"))
        raise ConfigError(str(error), file=str(path), line=at, key="server.runtime_dir") from error
    return config


def loads(text: str, file: str = "configuration") -> Config:
    """Return the configuration of a text, which complaints call ``file``; directories stay as they are written.

    Raises:
        ConfigError: all that is wrong with it, in ``problems``.
    """
    return read_text(Config, text, file)


def effective_text(config: Config) -> str:
    """Return a configuration as TOML, with every key: it loads to the same configuration, wherever it lies."""
    return write_table(config)


def _anchored(config: Config, directory: Path) -> Config:
    return replace(
        config,
        server=replace(config.server, runtime_dir=str(directory / config.server.runtime_dir)),
        maps=replace(config.maps, dir=str(directory / config.maps.dir)),
        recording=replace(config.recording, dir=str(directory / config.recording.dir)),
    )
