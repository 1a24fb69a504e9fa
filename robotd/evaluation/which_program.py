"""Which program this is: what results are known by, and what a worker must be of, too."""

import subprocess
from contextlib import suppress
from functools import cache
from pathlib import Path

from robotd import __version__


@cache
def program() -> str:
    """Return which commit this is, as far as a clone tells; else the version."""
    git = ["git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty", "--abbrev=12"]
    with suppress(OSError, subprocess.SubprocessError):
        return subprocess.run(git, capture_output=True, check=True, text=True, timeout=5.0).stdout.strip()
    return __version__
