"""What is large and was freed is not kept."""

import platform
import subprocess
import sys

import pytest

PROGRAM = """
import sys
from pathlib import Path
from robotd.core.freed_memory import give_back_what_is_large

def resident_mib():
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 2**20

if sys.argv[1] == "give back":
    give_back_what_is_large()
before_mib = resident_mib()
for _ in range(3):
    large = b"x" * 2**23
    del large
print(resident_mib() - before_mib)
"""


def kept_mib(how: str) -> float:
    done = subprocess.run([sys.executable, "-c", PROGRAM, how], capture_output=True, text=True, check=True)
    return float(done.stdout)


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="others give it back, or have no such word")
def test_eight_mebibytes_that_were_freed_go_back_and_would_not_by_themselves() -> None:
    assert kept_mib("give back") < 2.0
    assert kept_mib("as it is") > 6.0
