"""A silence is as long as we listened."""

import asyncio

import pytest

from robotd.core.attention import attention
from robotd.core.silence import Silence, within


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
    async with within(1.0, begins=first_word_s is None) as silence:
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
