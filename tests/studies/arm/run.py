"""``make arm``: the wheel for aarch64, built by Debian's cross compiler, and the tests of kernels and engine on it.

No such machine is needed: its processor is played by qemu, its Python is Debian's, and both stay below ``build/arm``.
Nothing is installed; what must be there is named if it is not.
"""

import argparse
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from tests.studies.arm.machine import CPU, Machine

ROOT = Path(__file__).parents[3]
BUILD = ROOT / "build" / "arm"
ENGINE = ("tests/unit/grid", "tests/unit/localization", "tests/unit/planning", "tests/agreement")
_NEEDED = {
    "aarch64-linux-gnu-gcc": "gcc-aarch64-linux-gnu",
    "aarch64-linux-gnu-objdump": "binutils-aarch64-linux-gnu",
    "qemu-aarch64-static": "qemu-user-static",
    "apt-get": "apt",
    "dpkg-deb": "dpkg",
}
"""Programs, and the packages of Debian that have them."""
_VECTOR = re.compile(r"\t(\w+)\t.*\bv\d+\.(?:16b|8h|4s|2d)\b")
"""A line of a listing whose instruction works on a vector register of 16 bytes."""


def vector_instructions(library: Path) -> dict[str, int]:
    """Return how often the compiled library has each instruction on vectors, the most frequent first."""
    listing = subprocess.run(
        ["aarch64-linux-gnu-objdump", "-d", str(library)], check=True, capture_output=True, text=True
    ).stdout
    counts: dict[str, int] = {}
    for name in _VECTOR.findall(listing):
        counts[name] = counts.get(name, 0) + 1
    return dict(sorted(counts.items(), key=lambda one: -one[1]))


def main(words: Sequence[str]) -> int:
    """Build, say what was built, run the tests on it; return their exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tests", nargs="*", help=f"which tests (default: {' '.join(ENGINE)})")
    arguments = parser.parse_args(words)
    missing = sorted({package for program, package in _NEEDED.items() if shutil.which(program) is None})
    if missing:
        print(f"not here: apt-get install {' '.join(missing)}", file=sys.stderr)
        return 1
    machine = Machine(BUILD)
    machine.prepare()
    wheel = machine.wheel(ROOT)
    print(f"wheel: {wheel.name}", flush=True)
    machine.install(wheel)
    if not (machine.site / "robotd/systemd/robotd.service").exists():
        print("the wheel brings no units", file=sys.stderr)
        return 1
    native = machine.site / "robotd/grid/kernels/_native.abi3.so"
    found = vector_instructions(native)
    most = ", ".join(f"{name} {count}" for name, count in list(found.items())[:8])
    print(f"kernels: {sum(found.values())} instructions on vectors of 16 bytes (NEON): {most}", flush=True)
    said = machine.run("-c", "import platform, robotd.grid.kernels as k; print(platform.machine(), k.in_use().about)")
    print(f"on {CPU}, played by qemu: {said.strip()}", flush=True)
    if "C kernels" not in said:
        return 1
    return machine.test(ROOT, tuple(arguments.tests) or ENGINE)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
