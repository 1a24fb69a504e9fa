"""A conversation without sequence numbers: what may settle a request, and what ends one."""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass, field
from typing import NoReturn

import pytest

from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import DeviceError, LinkTimeout, TransportError
from robotd.hardware.link.dialogue import Dialogue, DialogueCounters, Heard
from robotd.hardware.link.tapped import TappedLine
from robotd.hardware.transport.memory import MemoryEnd, memory_pair
from tests.support.taps import NoTap

QUIET_S = 0.05
STOP = b"stop\n"


class Lines:
    """The simplest dialect: a message is a line."""

    def __init__(self) -> None:
        self.counters = {"lines": 0}
        self._line = bytearray()

    def feed(self, data: bytes) -> list[str]:
        if b"\xff" in data:
            raise ZeroDivisionError("a mistake in the wire")
        *whole, rest = (bytes(self._line) + data).split(b"\n")
        self._line = bytearray(rest)
        self.counters["lines"] += len(whole)
        return [line.decode() for line in whole]

    def reset(self) -> None:
        self._line.clear()


@dataclass
class Talk:
    dialogue: Dialogue[str]
    far: MemoryEnd
    counters: DialogueCounters
    reports: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    async def ask(self, text: str, *, tries: int = 1, despite_stops: bool = False, timeout_s: float = 0.2) -> str:
        """Ask for anything that begins as the request does."""
        heard = await self.dialogue.ask(
            text.encode() + b"\n",
            lambda line: line[0] == text[0],
            timeout_s=timeout_s,
            tries=tries,
            despite_stops=despite_stops,
        )
        return heard.message


Answer = Callable[[str], list[tuple[float, str]]]
"""Given a request, what the device says, and after how many seconds."""


def echo(request: str) -> list[tuple[float, str]]:
    return [(0.01, request)]


@contextlib.asynccontextmanager
async def talk(answer: Answer = echo, *, wire: Lines | None = None) -> AsyncIterator[Talk]:
    near, far = memory_pair()
    counters = DialogueCounters()
    dialogue: Dialogue[str] = Dialogue(
        "thing",
        TappedLine("thing", near, NoTap()),
        wire or Lines(),
        counters=counters,
        on_report=lambda heard: it.reports.append(heard.message),
        quiet_s=QUIET_S,
    )
    it = Talk(dialogue, far, counters)
    device = asyncio.create_task(_device(it, answer))
    try:
        async with dialogue:
            yield it
    finally:
        device.cancel()
        await asyncio.wait({device})
        near.close()


async def _device(it: Talk, answer: Answer) -> None:
    lines = Lines()
    loop = asyncio.get_running_loop()
    while True:
        for request in lines.feed(await it.far.read()):
            it.requests.append(request)
            for seconds, said in answer(request):
                loop.call_later(seconds, _say, it.far, said)


def _say(far: MemoryEnd, text: str) -> None:
    with contextlib.suppress(TransportError):
        far.write(text.encode() + b"\n")


async def test_a_request_is_settled_by_its_answer_and_all_else_is_a_report() -> None:
    async with talk(lambda request: [(0.01, "noise"), (0.02, request), (0.03, "later")]) as t:
        assert await t.ask("a") == "a"
        await asyncio.sleep(0.1)
        assert t.reports == ["noise", "later"]


async def test_answers_that_a_line_brings_from_before_are_not_taken_for_those_of_the_first_request() -> None:
    async with talk() as t:
        _say(t.far, "a from before")
        assert await t.ask("a") == "a"
        assert t.reports == ["a from before"]


async def test_requests_are_under_way_one_at_a_time_in_the_order_asked() -> None:
    async with talk(lambda request: [(0.1, request)]) as t:
        asked = [asyncio.create_task(t.ask(text)) for text in ("a1", "b1", "a2")]
        await asyncio.sleep(0.12)
        assert t.requests == ["a1"]
        assert await asyncio.gather(*asked) == ["a1", "b1", "a2"]
        assert t.requests == ["a1", "b1", "a2"]


async def test_an_answer_that_comes_late_is_never_taken_for_that_of_the_next_request() -> None:
    delays = iter((0.23, 0.01))
    async with talk(lambda request: [(next(delays), request)]) as t:
        with pytest.raises(LinkTimeout, match=r"thing: no answer to b'a1\\n' in 0.2 s"):
            await t.ask("a1")
        assert await t.ask("a2") == "a2"
        assert t.reports == ["a1"]
        assert t.counters.timeouts == 1


async def test_a_late_answer_to_the_first_try_is_not_the_answer_to_the_second() -> None:
    answers = iter(([(0.23, "a old")], [(0.01, "a new")]))
    async with talk(lambda _: next(answers)) as t:
        assert await t.ask("a", tries=2) == "a new"
        assert t.reports == ["a old"]
        assert t.counters.retries == 1


async def test_no_answer_to_any_try_is_a_timeout_in_bounded_time() -> None:
    async with talk(lambda _: []) as t:
        began_ns = now_ns()
        with pytest.raises(LinkTimeout):
            await t.ask("a", tries=3)
        assert t.requests == ["a", "a", "a"]
        assert now_ns() - began_ns < (3 * (0.2 + QUIET_S) + 0.01) * NS_PER_S


async def test_a_device_that_is_served_is_asked_for_as_long_as_a_line_may_be_silent() -> None:
    answers = iter(([], [], [], [], [], [(0.01, "a at last")]))
    async with talk(lambda _: next(answers)) as t:
        serving = asyncio.create_task(t.dialogue.until_lost())
        await asyncio.sleep(0)
        assert await t.ask("a", tries=3) == "a at last"
        assert t.counters.retries == 5
        assert t.counters.timeouts == 0
        await _ended(serving)


async def test_what_must_not_happen_twice_is_asked_once_and_a_device_that_is_gone_is_found_out() -> None:
    async with talk(lambda _: []) as t:
        serving = asyncio.create_task(t.dialogue.until_lost())
        await asyncio.sleep(0)
        with pytest.raises(LinkTimeout):
            await t.ask("once")
        began_ns = now_ns()
        with pytest.raises(LinkTimeout):
            await t.ask("a", tries=3)
        assert 1.0 * NS_PER_S <= now_ns() - began_ns < 2.0 * NS_PER_S
        assert t.requests[0] == "once"
        assert set(t.requests[1:]) == {"a"}
        await _ended(serving)


async def _ended(task: "asyncio.Task[NoReturn]") -> None:
    task.cancel()
    await asyncio.wait({task})


async def test_an_answer_whose_asker_was_cancelled_is_not_taken_for_that_of_the_next_request() -> None:
    async with talk(lambda request: [(0.04, request)]) as t:
        asking = asyncio.create_task(t.ask("a1"))
        await asyncio.sleep(QUIET_S + 0.02)
        asking.cancel()
        assert await t.ask("a2") == "a2"
        assert t.reports == ["a1"]


async def test_nor_if_the_next_asker_is_cancelled_too_while_it_waits_for_the_line_to_be_quiet() -> None:
    async with talk(lambda request: [(0.06, request)]) as t:
        for text in ("a1", "a2"):
            asking = asyncio.create_task(t.ask(text))
            await asyncio.sleep(QUIET_S + 0.01 if text == "a1" else 0.01)
            asking.cancel()
            await asyncio.wait({asking})
        assert await t.ask("a3") == "a3"
        assert t.requests == ["a1", "a3"]
        assert t.reports == ["a1"]


async def test_a_stop_goes_out_at_once_and_ends_the_order_under_way() -> None:
    async with talk(lambda request: [(0.06, request)] if request != "stop" else []) as t:
        moving = asyncio.create_task(t.ask("a1"))
        await asyncio.sleep(QUIET_S + 0.01)
        t.dialogue.stop_now(STOP)
        with pytest.raises(DeviceError, match="thing: stopped: before it answered"):
            await moving
        await asyncio.sleep(0)
        assert t.requests == ["a1", "stop"]
        assert await t.ask("a2") == "a2"
        assert t.reports == ["a1"], "the answer to what was stopped is nobody's"


async def test_an_order_that_waits_for_its_turn_when_a_stop_comes_is_never_sent() -> None:
    async with talk(lambda request: [(0.1, request)]) as t:
        asked = [asyncio.create_task(t.ask(text)) for text in ("a1", "a2")]
        await asyncio.sleep(QUIET_S + 0.01)
        t.dialogue.stop_now(STOP)
        outcomes = await asyncio.gather(*asked, return_exceptions=True)
        assert [type(outcome) for outcome in outcomes] == [DeviceError, DeviceError]
        assert t.requests == ["a1", "stop"]


async def test_an_order_is_not_sent_if_a_stop_comes_while_it_waits_for_the_line_to_be_quiet() -> None:
    async with talk() as t:
        order = asyncio.create_task(t.ask("a1"))
        await asyncio.sleep(QUIET_S / 2)
        t.dialogue.stop_now(STOP)
        with pytest.raises(DeviceError, match="stopped"):
            await order
        assert t.requests == ["stop"]


async def test_a_second_try_is_not_sent_after_a_stop() -> None:
    async with talk(lambda _: []) as t:
        order = asyncio.create_task(t.ask("a1", tries=3))
        await asyncio.sleep(QUIET_S + 0.2 + QUIET_S / 2)
        assert t.requests == ["a1"]
        t.dialogue.stop_now(STOP)
        with pytest.raises(DeviceError, match="stopped"):
            await order
        assert t.requests == ["a1", "stop"]


async def test_a_question_that_stops_do_not_concern_is_answered_across_one() -> None:
    async with talk(lambda request: [(0.1, request)] if request != "stop" else []) as t:
        asked = [asyncio.create_task(t.ask(text, despite_stops=True)) for text in ("q1", "q2")]
        await asyncio.sleep(QUIET_S + 0.01)
        t.dialogue.stop_now(STOP)
        assert await asyncio.gather(*asked) == ["q1", "q2"]


async def test_what_answers_a_stop_is_not_taken_for_the_answer_to_a_question_that_waited() -> None:
    async with talk(lambda request: [(0.02, "q from the stop" if request == "stop" else request)]) as t:
        asking = asyncio.create_task(t.ask("q1", despite_stops=True))
        await asyncio.sleep(QUIET_S * 0.9)
        t.dialogue.stop_now(STOP)
        assert await asking == "q1"
        assert t.reports == ["q from the stop"]


async def test_a_lost_line_ends_what_is_under_way_and_what_waits_at_once() -> None:
    async with talk(lambda _: []) as t:
        asked = [asyncio.create_task(t.ask(text, tries=9)) for text in ("a1", "a2")]
        waiting = asyncio.create_task(t.dialogue.until_lost())
        await asyncio.sleep(QUIET_S + 0.01)
        began_ns = now_ns()
        t.far.cut()
        outcomes = await asyncio.gather(*asked, waiting, return_exceptions=True)
        assert [str(outcome) for outcome in outcomes] == ["memory: the line was cut"] * 3
        assert {type(outcome) for outcome in outcomes} == {TransportError}
        assert now_ns() == began_ns
        with pytest.raises(TransportError, match="cut"):
            t.dialogue.post(b"x\n")
        t.dialogue.stop_now(STOP)  # never raises


async def test_silence_is_noticed_whatever_noise_there_is_and_each_message_begins_it_anew() -> None:
    async with talk(lambda _: []) as t:
        waiting = asyncio.create_task(t.dialogue.until_lost(silence_s=1.0))
        for _ in range(3):
            await asyncio.sleep(0.9)
            _say(t.far, "still here")
        assert not waiting.done()
        began_ns = now_ns()
        await asyncio.sleep(0.5)
        t.far.write(b"noise without an end")
        with pytest.raises(LinkTimeout, match="thing: silent for 1 s"):
            await waiting
        assert now_ns() - began_ns == pytest.approx(1.0 * NS_PER_S, rel=1e-6)
        with pytest.raises(TransportError, match="silent"):
            await t.ask("a")


async def test_a_device_that_is_never_quiet_is_asked_all_the_same_and_bounded_in_time() -> None:
    async with talk(lambda request: [(0.02, request)]) as t:
        streaming = asyncio.create_task(_stream(t.far))
        began_ns = now_ns()
        assert await t.ask("a1") == "a1"
        assert now_ns() - began_ns < 1.0 * NS_PER_S
        with pytest.raises(LinkTimeout):
            await t.ask("a2", timeout_s=0.01)
        began_ns = now_ns()
        assert await t.ask("b3") == "b3"
        assert now_ns() - began_ns < 1.0 * NS_PER_S
        streaming.cancel()
        await asyncio.wait({streaming})


async def _stream(far: MemoryEnd) -> None:
    while True:
        _say(far, "stream")
        await asyncio.sleep(0.01)


async def test_who_waits_when_the_conversation_ends_is_told_so() -> None:
    async with talk(lambda _: []) as t:
        asking = asyncio.create_task(t.ask("a"))
        await asyncio.sleep(QUIET_S + 0.01)
    with pytest.raises(TransportError, match="thing: the session is over"):
        await asking


async def test_a_mistake_in_the_wire_is_not_waited_for() -> None:
    async with talk(lambda _: []) as t:
        asking = asyncio.create_task(t.ask("a", timeout_s=100.0))
        await asyncio.sleep(QUIET_S + 0.01)
        t.far.write(b"\xff")
        with pytest.raises(TransportError, match="cannot go on reading"):
            await asking
        with pytest.raises(ZeroDivisionError):
            await t.dialogue.until_lost()


async def test_the_beginning_of_a_message_from_an_earlier_line_is_forgotten() -> None:
    wire = Lines()
    wire.feed(b"half of a")
    async with talk(wire=wire) as t:
        assert await t.ask("a") == "a"


async def test_a_message_carries_the_time_of_its_last_byte() -> None:
    async with talk(lambda _: []) as t:
        heard: asyncio.Task[Heard[str]] = asyncio.create_task(
            t.dialogue.ask(b"a\n", lambda line: line == "ab", timeout_s=1.0)
        )
        await asyncio.sleep(QUIET_S + 0.01)
        t.far.write(b"a")
        await asyncio.sleep(0.1)
        t.far.write(b"b\n")
        at_ns = now_ns()
        assert (await heard).time_ns == at_ns
        assert t.dialogue.heard_ns == at_ns


async def test_a_poll_is_due_when_nothing_was_answered_for_a_while_however_much_is_said() -> None:
    async with talk() as it:
        began_ns = now_ns()
        await asyncio.sleep(0.3)
        await it.ask("one")
        polls = asyncio.create_task(it.dialogue.until_idle(1.0))
        for _ in range(40):
            await asyncio.sleep(0.05)
            it.far.write(b"noise\n")
        assert polls.done()
        await it.dialogue.until_idle(1.0)  # it is overdue: at once
        assert (now_ns() - began_ns) / NS_PER_S < 2.5
        await it.ask("two")
        answered_ns = now_ns()
        await it.dialogue.until_idle(1.0)
        assert (now_ns() - answered_ns) / NS_PER_S == pytest.approx(1.0, abs=0.02)
