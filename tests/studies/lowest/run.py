"""``make lowest``: the tests with the lowest version of every dependency that ``pyproject.toml`` allows."""

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from tests.studies.lowest.bounds import EXTRAS, TOOLS, lowest

ROOT = Path(__file__).parents[3]
BUILD = ROOT / "build" / "lowest"
TESTS = (
    "tests/unit/core",
    "tests/unit/contract",
    "tests/unit/toml",
    "tests/unit/config",
    "tests/unit/client",
    "tests/unit/children",
    "tests/unit/logs",
    "tests/unit/grid",
    "tests/unit/localization",
    "tests/unit/planning",
    "tests/unit/exact",
    "tests/unit/hardware",
    "tests/unit/maps",
    "tests/unit/recording",
    "tests/unit/interop",
    "tests/unit/server",
    "tests/unit/gateway",
    "tests/unit/cli/test_pictures.py",
    "tests/unit/cli/test_tables.py",
    "tests/unit/cli/test_terminal.py",
    "tests/integration/test_missions.py",
    "tests/integration/test_replay_of_refusals.py",
)
"""What touches each dependency; processes of the installed program are left out, for it is not installed there."""


def main(tests: Sequence[str]) -> int:
    """Install, say what was installed, run the tests; return their exit code."""
    pinned = lowest((ROOT / "pyproject.toml").read_text())
    print(f"lowest: {', '.join(pinned)} ({', '.join(('robotd', *EXTRAS))})", flush=True)
    python = BUILD / "bin" / "python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", str(BUILD)], check=True)
    install = [str(python), "-m", "pip", "--disable-pip-version-check", "install", "-q", "--only-binary", ":all:"]
    subprocess.run([*install, *pinned, *TOOLS], check=True)
    # Run where the source is: what was compiled in place serves every version of Python and NumPy. Processes that tests
    # start look elsewhere, and find it by this.
    (site,) = (BUILD / "lib").glob("python3.*/site-packages")
    (site / "robotd.pth").write_text(f"{ROOT}\n", encoding="utf-8")
    # An old version may use what newer ones around it call deprecated: whether it works is asked, not whether it will.
    old = ("-W", "ignore::DeprecationWarning", "-W", "ignore::PendingDeprecationWarning")
    words = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "-o", "timeout=600", *old, *(tests or TESTS)]
    return subprocess.run([str(python), *words], cwd=ROOT, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
