"""What gives way has no precedence any more, and nothing gains any."""

import os

import pytest

from robotd.core.precedence import give_way, no_realtime


@pytest.mark.parametrize("policy", [os.SCHED_FIFO, os.SCHED_RR])
def test_a_thread_that_was_started_in_real_time_shares_processors_again(policy: int) -> None:
    child = os.fork()
    if child == 0:
        code = 2
        try:
            os.sched_setscheduler(0, policy, os.sched_param(1))
            no_realtime()
            code = int(os.sched_getscheduler(0) != os.SCHED_OTHER)
        finally:
            os._exit(code)
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if code == 2:
        pytest.skip("no real time for this user")
    assert code == 0


@pytest.mark.parametrize(("nice", "then"), [(-15, [0]), (0, []), (5, [])])
def test_only_precedence_is_given_up(monkeypatch: pytest.MonkeyPatch, nice: int, then: list[int]) -> None:
    asked: list[int] = []
    monkeypatch.setattr("os.getpriority", lambda which, who: nice)
    monkeypatch.setattr("os.setpriority", lambda which, who, value: asked.append(value))
    give_way()
    assert asked == then
