"""Virtual time jumps, keeps order, and never hides a stuck program."""

import asyncio
import time

import pytest

from robotd.core.clock import NS_PER_S, VirtualClockLoop, now_ns, run_virtual, wall_offset_ns


def test_an_hour_of_sleep_takes_no_time() -> None:
    async def sleep_an_hour() -> int:
        await asyncio.sleep(3600)
        return now_ns()

    began = time.monotonic()
    assert run_virtual(sleep_an_hour(), start_ns=5 * NS_PER_S) == pytest.approx(3605 * NS_PER_S, abs=1000)
    assert time.monotonic() - began < 5.0


async def test_timers_fire_in_order_at_their_times() -> None:
    fired: list[tuple[str, int]] = []

    async def note(name: str, after_s: float) -> None:
        await asyncio.sleep(after_s)
        fired.append((name, round(now_ns() / NS_PER_S * 10)))

    await asyncio.gather(note("late", 0.3), note("early", 0.1), note("middle", 0.2))
    assert fired == [("early", 1), ("middle", 2), ("late", 3)]


async def test_executor_work_is_done_at_once_and_takes_no_virtual_time() -> None:
    before = now_ns()
    assert await asyncio.get_running_loop().run_in_executor(None, lambda: 42) == 42
    assert now_ns() == before


async def test_executor_errors_reach_the_one_who_awaits() -> None:
    with pytest.raises(ZeroDivisionError):
        await asyncio.get_running_loop().run_in_executor(None, lambda: 1 / 0)


def test_a_program_that_waits_for_nothing_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robotd.core.clock._STUCK_AFTER_S", 0.01)
    loop = VirtualClockLoop()
    try:
        with pytest.raises(RuntimeError, match="virtual time is stuck"):
            loop.run_until_complete(loop.create_future())
    finally:
        loop.close()


def test_the_wall_offset_turns_monotonic_into_unix_time() -> None:
    assert time.monotonic_ns() + wall_offset_ns() == pytest.approx(time.time_ns(), abs=NS_PER_S)
