"""How a wheel of robotd is built: by setuptools, beside which stands what the program itself needs.

The manual and the completions come from the program's own parsers, so to build them is to run it. An editable
installation has none, and needs none of that.
"""

import tomllib
from pathlib import Path
from typing import Any

from setuptools.build_meta import *  # noqa: F403  # every hook but one is that of setuptools
from setuptools.build_meta import get_requires_for_build_wheel as _required_by_setuptools


def get_requires_for_build_wheel(config_settings: Any = None) -> list[str]:
    """Return what must be installed where a wheel is built."""
    project = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]
    return [*_required_by_setuptools(config_settings), *project["dependencies"], "shtab>=1.7"]
