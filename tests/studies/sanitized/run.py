"""``make kernels-sanitized``: all tests that call a kernel, with every kernel under the sanitizers."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from tests.studies.sanitized import plugin
from tests.studies.sanitized.compiling import ROOT, build, runtime

ALL = ("tests/unit/grid", "tests/unit/localization", "tests/unit/planning", "tests/agreement")


def run_tests(module: Path, *words: str, cases: int | None = None) -> subprocess.CompletedProcess[str]:
    """Run tests in a process of their own, on the kernels of this module; ``cases`` of each property at most."""
    environment = {
        **os.environ,
        **({} if cases is None else {plugin.CASES: str(cases)}),
        plugin.FILE: str(module),
        "LD_PRELOAD": str(runtime()),
        "ASAN_OPTIONS": "detect_leaks=0",  # Python ends without giving everything back
        "PYTHONMALLOC": "malloc",  # else small arrays lie where the sanitizer does not look
    }
    command = [sys.executable, "-m", "pytest", "-q", "-s", "-p", plugin.__name__, "-p", "no:cacheprovider", *words]
    return subprocess.run(command, cwd=ROOT, env=environment, check=False, text=True, capture_output=True)


def main(words: Sequence[str]) -> int:
    """Build, run, and print what came of it."""
    if runtime() is None:
        print("there is no C compiler with sanitizers here", file=sys.stderr)
        return 1
    with tempfile.TemporaryDirectory(prefix="robotd-sanitized-") as directory:
        done = run_tests(build(Path(directory)), *(words or ALL))
    print(done.stdout[-4000:], done.stderr[-4000:], sep="\n")
    return done.returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
