"""Compile the C where there is a compiler, let the program write its manual; everything else is in pyproject.toml."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from setuptools import setup
from setuptools.command.build_ext import build_ext

from distutils.command.install_data import install_data  # isort: skip  # setuptools brings it


class BuildIfPossible(build_ext):
    """A machine without a compiler gets the NumPy twins, and boards in Python only; where there is one, C must compile.

    What an earlier build left where this one puts its own goes first: old code must not pass for new.
    """

    def build_extensions(self) -> None:
        """Compile, or say in one line why not."""
        if self.inplace or self.editable_mode:
            self._forget()
        missing = self._missing()
        if missing is None:
            super().build_extensions()
            return
        self.extensions.clear()
        print(f"robotd: nothing is compiled, the twins in Python will be used: {missing}", file=sys.stderr)

    def _forget(self) -> None:
        for ext in self.extensions:
            package, _, name = ext.name.rpartition(".")
            for old in Path(*package.split(".")).glob(f"{name}.*so"):
                old.unlink()

    def _missing(self) -> str | None:
        """Return what keeps the simplest of extensions from being compiled; None if nothing does."""
        with tempfile.TemporaryDirectory() as directory:
            source = Path(directory, "probe.c")
            source.write_text("#include <Python.h>\nint probe(void) { return 0; }\n", encoding="ascii")
            try:
                self.compiler.compile([str(source)], output_dir=directory)
            except Exception as error:  # whatever a missing or broken compiler raises
                return str(error)
        return None


class WithManual(install_data):
    """Beside the package a wheel has manuals and completions, which the program tells of itself.

    Where what it needs is not installed a wheel has none; in a clone they would be old on the next day.
    """

    def run(self) -> None:
        """Make them, or say in a line why not."""
        super().run()
        if self.get_finalized_command("build_py").editable_mode:
            return
        paths = os.pathsep.join(filter(None, (str(Path.cwd()), os.environ.get("PYTHONPATH"))))
        made = subprocess.run(
            [sys.executable, "-B", "systemd/wheel/shared.py", str(Path(self.install_dir, "share"))],
            env={**os.environ, "PYTHONPATH": paths, "COLUMNS": "72"},
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
        if made.returncode:
            said = made.stderr.strip().splitlines()[-1:]
            print(f"robotd: no manuals and no completions are made: {''.join(said)}", file=sys.stderr)


setup(
    cffi_modules=["robotd/grid/kernels/build.py:builder", "robotd/sim/firmware/firmware_build.py:builder"],
    cmdclass={"build_ext": BuildIfPossible, "install_data": WithManual},
    data_files=[("share", [])],  # what install_data makes is not there yet
    options={"bdist_wheel": {"py_limited_api": "cp311"}},
)
