"""Work is done in order, off the loop."""

import asyncio
import threading

import pytest

from robotd.head.compute import ThreadCompute


@pytest.mark.real_clock
async def test_jobs_run_on_one_other_thread_in_the_order_in_which_they_were_asked() -> None:
    compute, done = ThreadCompute(), list[tuple[int, str]]()
    try:
        jobs = (compute.run("job", lambda n=n: done.append((n, threading.current_thread().name))) for n in range(20))
        await asyncio.gather(*jobs)
    finally:
        compute.close()
    assert [number for number, _ in done] == list(range(20))
    (thread,) = {name for _, name in done}
    assert thread != threading.current_thread().name


@pytest.mark.real_clock
async def test_an_error_reaches_the_one_who_asked_and_the_next_job_runs() -> None:
    compute = ThreadCompute()
    try:
        with pytest.raises(ZeroDivisionError):
            await compute.run("bad", lambda: 1 // 0)
        assert await compute.run("good", lambda: 42) == 42
    finally:
        compute.close()


@pytest.mark.real_clock
async def test_at_the_end_the_job_under_way_is_waited_for_and_those_behind_it_are_dropped() -> None:
    compute, begun, go, done = ThreadCompute(), asyncio.Event(), threading.Event(), list[str]()
    loop = asyncio.get_running_loop()

    def first() -> None:
        loop.call_soon_threadsafe(begun.set)
        go.wait(60.0)
        done.append("first")

    jobs = [asyncio.create_task(compute.run("a", first)), asyncio.create_task(compute.run("b", done.append, "second"))]
    await begun.wait()
    threading.Timer(0.02, go.set).start()
    compute.close()
    assert done == ["first"]
    await asyncio.wait(jobs, timeout=60.0)
    assert jobs[1].cancelled()


@pytest.mark.real_clock
async def test_what_is_computed_has_no_precedence_over_the_loop(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[int, int]] = []
    monkeypatch.setattr("os.getpriority", lambda which, who: -15)
    monkeypatch.setattr("os.setpriority", lambda which, who, nice: asked.append((who, nice)))
    compute = ThreadCompute()
    try:
        assert asked == []
        assert [(await compute.run("where", threading.get_native_id), 0)] == asked
    finally:
        compute.close()
