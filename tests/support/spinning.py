"""Programs that keep processors busy, for as long as the one who started them lives."""

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator

_PROGRAM = """
import os, sys
while os.getppid() == int(sys.argv[1]):
    for _ in range(100_000):
        pass
"""
"""It looks who its parent is: a run that is killed, by whatever signal, leaves nothing behind."""


@contextlib.contextmanager
def spinning(count: int) -> Iterator[tuple[int, ...]]:
    """Run this many of them at normal priority, and yield their numbers.

    Each has a session of its own. Most kernels share processors out among sessions first (autogroup), and the daemon
    and the simulated boards of a demonstration have a session each: programs that shared one would together get no more
    than the daemon alone, however many they are.
    """
    command = [sys.executable, "-c", _PROGRAM, str(os.getpid())]
    with contextlib.ExitStack() as stack:
        programs = []
        for _ in range(count):
            program = subprocess.Popen(command, start_new_session=True)
            stack.callback(program.wait)
            stack.callback(program.kill)
            os.setpriority(os.PRIO_PROCESS, program.pid, 0)
            programs.append(program.pid)
        yield tuple(programs)
