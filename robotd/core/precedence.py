"""Who goes first where processors are short: what stops the robot may have precedence; the rest gives it up.

Niceness and policy are of a thread on Linux, and what a thread starts begins with its own.
"""

import os
import threading
from contextlib import suppress

_REALTIME = (os.SCHED_FIFO, os.SCHED_RR)


def give_way() -> None:
    """Let this thread, and those that it starts, have no precedence over other programs."""
    no_realtime()
    # Of the thread, not of the process: the loop beside it keeps what it was given.
    thread = threading.get_native_id()
    # Only precedence is given up: a daemon that was started nicer than others stays so.
    if os.getpriority(os.PRIO_PROCESS, thread) < 0:
        with suppress(OSError):  # where that is forbidden it stays as it is
            os.setpriority(os.PRIO_PROCESS, thread, 0)


def no_realtime() -> None:
    """Let this thread, and those that it starts, share processors with others, however it was started."""
    if os.sched_getscheduler(0) in _REALTIME:
        with suppress(OSError):  # as above
            os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
