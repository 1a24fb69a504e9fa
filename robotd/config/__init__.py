"""The configuration: TOML in, a frozen typed tree out, and every mistake named with its line."""

from robotd.config.environment import default_path
from robotd.config.files import effective_text, load, loads
from robotd.config.tree import Config

__all__ = ["Config", "default_path", "effective_text", "load", "loads"]
