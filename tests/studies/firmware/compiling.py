"""The system's C compiler, for which every warning is an error, with the sanitizers if it has them."""

import functools
import os
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from importlib import resources
from pathlib import Path

C = Path(str(resources.files("firmware_proto"))) / "c"
WARNINGS = (
    *("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Wstrict-prototypes"),
    *("-Wmissing-prototypes", "-Wundef", "-Wvla", "-Werror"),
)
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer")
CODEC = ("checksum.c", "frame.c", "messages.c")


def compiler() -> str | None:
    """Return the compiler; None if there is none."""
    return shutil.which(os.environ.get("CC", "cc"))


@functools.cache
def sanitizers() -> tuple[str, ...]:
    """Return the sanitizers' flags, or none where programs cannot be linked with them."""
    with tempfile.TemporaryDirectory() as directory:
        source = Path(directory) / "nothing.c"
        source.write_text("int main(void) { return 0; }\n")
        tried = subprocess.run(
            [str(compiler()), *SANITIZERS, str(source), "-o", f"{directory}/nothing"], check=False, capture_output=True
        )
    return SANITIZERS if tried.returncode == 0 else ()


def build(program: Path, sources: Sequence[Path], flags: Sequence[str] = ()) -> Path:
    """Compile and link a program.

    Raises:
        RuntimeError: the compiler does not like it; the message is what it said.
    """
    words = [str(compiler()), *WARNINGS, "-O1", "-g", *sanitizers(), *flags, f"-I{C}"]
    done = subprocess.run([*words, *map(str, sources), "-o", str(program)], check=False, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stderr)
    return program


def run(program: Path, data: bytes, *arguments: str) -> str:
    """Return what a program makes of its input.

    Raises:
        RuntimeError: it failed, or a sanitizer stopped it; the message is what it said.
    """
    # Nothing is ever allocated, and looking for leaks needs rights that not every machine gives.
    environment = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0"}
    done = subprocess.run([str(program), *arguments], input=data, check=False, capture_output=True, env=environment)
    if done.returncode:
        raise RuntimeError(done.stderr.decode(errors="replace"))
    return done.stdout.decode("ascii")
