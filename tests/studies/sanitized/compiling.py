"""The kernels compiled once more, under the sanitizers: whatever C does not define ends the program that does it."""

import functools
import importlib.util
import os
import shutil
import subprocess
import sysconfig
import tempfile
from pathlib import Path

from cffi import FFI

ROOT = Path(__file__).parents[3]
HERE = ROOT / "robotd" / "grid" / "kernels"
MODULE = "_native.abi3.so"
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer")


def compiler() -> str | None:
    """Return the compiler; None if there is none."""
    return shutil.which(os.environ.get("CC", "cc"))


@functools.cache
def runtime() -> Path | None:
    """Return the library that a program under the sanitizers must load first; None where they cannot be had."""
    if compiler() is None:
        return None
    told = subprocess.run(
        [str(compiler()), "-print-file-name=libasan.so"], check=False, capture_output=True, text=True
    ).stdout.strip()
    with tempfile.TemporaryDirectory() as directory:
        source = Path(directory) / "nothing.c"
        source.write_text("#include <Python.h>\nint nothing(void) { return 0; }\n")
        tried = subprocess.run(
            [*_words(), str(source), "-o", f"{directory}/nothing.so"], check=False, capture_output=True
        )
    return Path(told) if tried.returncode == 0 and Path(told).is_absolute() else None


def build(directory: Path) -> Path:
    """Compile all kernels into one module and return its file.

    Raises:
        RuntimeError: the compiler does not like them; the message is what it said.
    """
    bridge, module = directory / "bridge.c", directory / MODULE
    builder, sources = _builder()
    builder.emit_c_code(str(bridge))
    done = subprocess.run(
        [*_words(), str(bridge), *map(str, sources), "-o", str(module)], check=False, capture_output=True, text=True
    )
    if done.returncode:
        raise RuntimeError(done.stderr)
    return module


def _words() -> tuple[str, ...]:
    include = sysconfig.get_paths()["include"]
    return (
        *(str(compiler()), "-shared", "-fPIC", "-pthread", "-std=gnu99", "-O1", "-g", "-ffp-contract=off"),
        *("-Wno-psabi", *SANITIZERS, f"-I{HERE}", f"-I{include}"),
    )


def _builder() -> tuple[FFI, tuple[Path, ...]]:
    """Return what the program's own kernels are made by, and its sources."""
    spec = importlib.util.spec_from_file_location("kernels_build", HERE / "build.py")
    assert spec is not None
    assert spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found.builder, tuple(HERE / source for source in found.SOURCES)
