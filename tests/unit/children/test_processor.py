"""Whether a process had the processors, as the kernel tells it of real ones."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable

from robotd.children.processor import Share, share_of


def until(holds: Callable[[], bool]) -> None:
    until_s = time.monotonic() + 30.0
    while not holds():
        assert time.monotonic() < until_s


def test_one_that_spins_wants_it_and_gets_it_and_one_that_is_stopped_does_not() -> None:
    with subprocess.Popen([sys.executable, "-c", "while True: pass"]) as spinning:
        try:
            until(lambda: share_of(spinning.pid).ran_s > 0.1)
            assert share_of(spinning.pid).wants_it
            spinning.send_signal(signal.SIGSTOP)
            until(lambda: not share_of(spinning.pid).wants_it)
            before = share_of(spinning.pid)
            assert share_of(spinning.pid).could_act_s(before, 3.0) == 3.0, "it could do something, if it were not ill"
        finally:
            spinning.kill()


def test_one_that_has_to_wait_for_its_turns_was_not_free_to_act() -> None:
    both = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2)]
    try:
        for one in both:
            os.sched_setaffinity(one.pid, {min(os.sched_getaffinity(0))})
        until(lambda: all(share_of(one.pid).waited_s > 0.1 for one in both))
    finally:
        for one in both:
            one.kill()
            one.wait()


def test_what_is_not_there_was_never_late() -> None:
    assert share_of(2**22 + 1) == Share()
    assert Share().could_act_s(Share(), 0.4) == 0.4
    assert Share(1.0, 0.3).could_act_s(Share(0.9, 0.1), 0.4) == 0.4 - (0.3 - 0.1)
    assert Share(1.0, 0.3, wants_it=True).could_act_s(Share(0.9, 0.1), 0.4) == 1.0 - 0.9
