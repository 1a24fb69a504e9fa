"""A silence is as long as we listened."""

import asyncio

import pytest

from robotd.core.attention import attention
from robotd.core.silence import Silence, idle, within


async def test_it_is_told_once_unless_renewed_or_ended() -> None:
    told: list[float] = []
    loop = asyncio.get_running_loop()
    began_s = loop.time()
    silence = Silence(1.0, lambda: told.append(loop.time() - began_s))
    await asyncio.sleep(0.9)
    silence.renew()
    await asyncio.sleep(0.9)
    assert told == []
    await asyncio.sleep(10.0)
    assert told == [pytest.approx(1.9)]
    Silence(1.0, lambda: told.append(0.0)).end()
    await asyncio.sleep(10.0)
    assert len(told) == 1


async def test_what_we_missed_does_not_count() -> None:
    told: list[float] = []
    loop = asyncio.get_running_loop()
    began_s = loop.time()
    Silence(1.0, lambda: told.append(loop.time() - began_s))
    await asyncio.sleep(0.5)
    attention().miss(0.4)
    await asyncio.sleep(0.8)
    assert told == []
    await asyncio.sleep(0.2)
    assert told == [pytest.approx(1.4)]


async def test_a_stall_is_looked_for_before_anybody_is_blamed() -> None:
    stalls = [0.3]

    def look() -> None:
        if stalls:
            attention().miss(stalls.pop())

    attention().watch(look)
    loop = asyncio.get_running_loop()
    began_s = loop.time()
    with pytest.raises(TimeoutError):
        await _wait_in_vain()
    assert loop.time() - began_s == pytest.approx(1.3)
    attention().watch(None)


async def test_a_silence_may_begin_with_the_first_word() -> None:
    loop = asyncio.get_running_loop()
    began_s = loop.time()
    with pytest.raises(TimeoutError):
        await _wait_in_vain(first_word_s=5.0)
    assert loop.time() - began_s == pytest.approx(6.0)


async def _wait_in_vain(first_word_s: float | None = None) -> None:
    async with within(1.0, of="a test", begins=first_word_s is None) as silence:
        if first_word_s is not None:
            await asyncio.sleep(first_word_s)
            silence.renew()
        await asyncio.sleep(100.0)


async def test_a_timer_that_fires_late_counts_from_when_it_was_due() -> None:
    loop, fell = asyncio.get_running_loop(), list[float]()
    began_s = loop.time()
    silence = Silence(1.0, lambda: fell.append(loop.time() - began_s))
    attention().miss(0.25)
    silence._timer.cancel()  # type: ignore[union-attr]  # a replay fires it at the next recorded moment
    loop.call_at(began_s + 1.125, silence._due)
    await asyncio.sleep(2.0)
    assert fell == [pytest.approx(1.25)]


async def test_who_fell_silent_is_told_before_it_has_an_effect() -> None:
    told: list[str] = []
    attention().fell = told.append
    Silence(1.0, lambda: told.append("effect"), of="drive line")
    Silence(2.0, lambda: told.append("its own affair"))
    await asyncio.sleep(3.0)
    assert told == ["drive line", "effect", "its own affair"]


async def test_a_silence_that_is_led_falls_when_it_is_let_and_the_one_due_first_does() -> None:
    attention().are_led = True
    fell: list[str] = []
    late = Silence(2.0, lambda: fell.append("late"), of="drive answer")
    Silence(1.0, lambda: fell.append("soon"), of="drive answer")
    Silence(1.0, lambda: fell.append("another's"), of="pantilt answer")
    Silence(0.5, lambda: fell.append("ended"), of="drive answer").end()
    await asyncio.sleep(10.0)
    assert fell == []
    attention().let_fall("drive answer")
    assert fell == ["soon"]
    late.renew()
    attention().let_fall("drive answer")
    attention().let_fall("drive answer")
    attention().let_fall("nobody")
    assert fell == ["soon", "late"]


async def test_time_may_count_for_which_we_did_not_listen() -> None:
    fell: list[float] = []
    loop = asyncio.get_running_loop()
    began_s = loop.time()
    Silence(1.0, lambda: fell.append(loop.time() - began_s), of="set-point", counts_stalls=True)
    attention().miss(5.0)
    await asyncio.sleep(10.0)
    assert fell == [pytest.approx(1.0)]


async def test_an_idle_time_passes() -> None:
    began_s = asyncio.get_running_loop().time()
    await idle(1.5, of="drive talk")
    assert asyncio.get_running_loop().time() - began_s == pytest.approx(1.5)
