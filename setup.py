"""Compile the C where there is a compiler: kernels, firmware; everything else is in pyproject.toml."""

import sys
from typing import Any

from setuptools import setup
from setuptools.command.build_ext import build_ext


class BuildIfPossible(build_ext):
    """A machine without a compiler gets the NumPy twins, and boards in Python only; it is told so."""

    def build_extension(self, ext: Any) -> None:
        """Compile, or say in one line why not."""
        try:
            super().build_extension(ext)
        except Exception as error:  # whatever a missing or broken compiler raises, robotd works without
            print(f"robotd: {ext.name} is not compiled, its twin in Python will be used: {error}", file=sys.stderr)


setup(
    cffi_modules=["robotd/grid/kernels/c/build.py:builder", "robotd/sim/firmware/build.py:builder"],
    cmdclass={"build_ext": BuildIfPossible},
    options={"bdist_wheel": {"py_limited_api": "cp311"}},
)
