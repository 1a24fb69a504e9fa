"""A plugin of pytest: the kernels are those of the file that ``ROBOTD_SANITIZED`` names, for what is imported later.

``ROBOTD_SANITIZED_CASES`` says how many cases of each property there are at most: a sanitizer looks at every one.
"""

import importlib.util
import os
import sys

import pytest
from hypothesis import settings

FILE = "ROBOTD_SANITIZED"
CASES = "ROBOTD_SANITIZED_CASES"
_KERNELS = "robotd.grid.kernels._native"
_SETTINGS = "_hypothesis_internal_use_settings"
"""Where a property keeps its settings, which are final once they are given; there is no public way."""


def use(file: str) -> None:
    """Let the module of the kernels be this file."""
    spec = importlib.util.spec_from_file_location(_KERNELS, file)
    assert spec is not None
    assert spec.loader is not None
    sys.modules[_KERNELS] = module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)


def pytest_itemcollected(item: pytest.Item) -> None:
    """Leave a property as many cases as are wanted."""
    test = getattr(item, "obj", None)
    if CASES in os.environ and isinstance(its := getattr(test, _SETTINGS, None), settings):
        setattr(test, _SETTINGS, settings(its, max_examples=min(its.max_examples, int(os.environ[CASES]))))


if FILE in os.environ:
    use(os.environ[FILE])
