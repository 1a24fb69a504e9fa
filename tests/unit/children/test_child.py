"""A child that is a task, on the virtual clock: whatever it does wrong is found, told, and the next one started."""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable, Sequence
from dataclasses import dataclass, field

import pytest

from robotd.children.channel import Channel
from robotd.children.child import Child, Death
from robotd.children.in_process import InProcess, Main
from robotd.children.inside import live
from robotd.children.pings import READY
from robotd.children.process import Running
from robotd.children.processor import Share
from robotd.core.attention import attention
from robotd.core.errors import ChildError

NOW = "1.0"


@dataclass
class Seen:
    child: Child
    deaths: list[Death] = field(default_factory=list)
    starts_s: list[float] = field(default_factory=list)


@contextlib.asynccontextmanager
async def supervised(*mains: Main | None, share: Callable[[], Share] = Share) -> AsyncIterator[Seen]:
    """Each life is another program, the last one for ever; None cannot be started. ``share`` is what it has had."""

    def start() -> Running:
        main = mains[min(len(seen.starts_s), len(mains) - 1)]
        seen.starts_s.append(asyncio.get_running_loop().time())
        if main is None:
            raise ChildError("it cannot be started: no memory")
        life = InProcess(main)
        life.share = share  # type: ignore[method-assign]  # a task has all of the processor that it wants
        return life

    async def serve(lanes: Sequence[Channel]) -> None:
        await asyncio.Event().wait()

    # Not the bound method: the list is made with what holds it.
    seen = Seen(Child("helper", NOW, start=start, serve=serve, died=lambda death: seen.deaths.append(death)))  # noqa: PLW0108  # as above
    running = asyncio.create_task(seen.child.run())
    try:
        yield seen
    finally:
        running.cancel()
        await asyncio.wait((running,))
        assert running.cancelled(), running.exception()


async def well(life: Channel, lanes: Sequence[Channel]) -> None:
    await live(life, NOW)


async def mute(life: Channel, lanes: Sequence[Channel]) -> None:
    await asyncio.Event().wait()


async def crashes(life: Channel, lanes: Sequence[Channel]) -> None:
    raise ValueError("a mistake of ours")


async def old(life: Channel, lanes: Sequence[Channel]) -> None:
    await live(life, "0.9")


async def garbage(life: Channel, lanes: Sequence[Channel]) -> None:
    life.send(b"\xff\x00")
    await asyncio.Event().wait()


async def hangs(life: Channel, lanes: Sequence[Channel]) -> None:
    life.send(READY, NOW.encode())
    await life.receive()
    await asyncio.Event().wait()


async def answers_garbage(life: Channel, lanes: Sequence[Channel]) -> None:
    life.send(READY, NOW.encode())
    life.send(b"yes, yes" + await life.receive())
    await asyncio.Event().wait()


async def answers_twice(life: Channel, lanes: Sequence[Channel]) -> None:
    life.send(READY, NOW.encode())
    ping = await life.receive()
    life.send(ping)
    life.send(ping)
    await asyncio.Event().wait()


async def answers_an_older_one(life: Channel, lanes: Sequence[Channel]) -> None:
    life.send(READY, NOW.encode())
    first = await life.receive()
    life.send(first)
    await life.receive()
    life.send(first)
    await asyncio.Event().wait()


async def answers_late(life: Channel, lanes: Sequence[Channel]) -> None:
    life.send(READY, NOW.encode())
    ping = await life.receive()
    await asyncio.sleep(0.6)
    life.send(ping)
    await asyncio.Event().wait()


@pytest.mark.parametrize(
    ("main", "cause", "was_ready", "within_s"),
    [
        (None, "it cannot be started: no memory", False, 0.0),
        (crashes, "it ended with ValueError('a mistake of ours')", False, 0.1),
        (mute, "it was not ready within 10 s", False, 10.1),
        (garbage, r"it began with '\\xff\\x00', expected that it is ready", False, 0.1),
        (old, "it is version '0.9', this is 1.0", False, 0.1),
        (hangs, "it was silent for 0.3 s", True, 0.5),
        (answers_garbage, r"it answered ping 1 with 'yes, yes\\x01", True, 0.1),
        (answers_twice, "it answered ping 2 with", True, 0.4),
        (answers_an_older_one, "it answered ping 2 with", True, 0.4),
        (answers_late, "it was silent for 0.3 s", True, 0.5),
    ],
)
async def test_what_is_wrong_with_a_child_is_found_and_told_and_another_started(
    main: Main | None, cause: str, was_ready: bool, within_s: float
) -> None:
    async with supervised(main, well) as seen:
        await asyncio.sleep(within_s + 0.2)
        (death,) = seen.deaths
        assert cause in death.cause
        assert (death.was_ready, death.again_in_s) == (was_ready, 0.1)
        assert len(seen.starts_s) == 2
        assert seen.child.is_ready.is_set()
        await asyncio.sleep(1000.0)
        assert len(seen.deaths) == 1, "one that is well is left alone"


async def test_a_child_that_never_starts_is_tried_again_ever_less_often_but_for_good() -> None:
    async with supervised(None) as seen:
        await asyncio.sleep(30.0)
        waits = [death.again_in_s for death in seen.deaths]
        assert waits[:8] == [0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 5.0, 5.0]


async def test_one_that_lasted_is_followed_at_once() -> None:
    async def lasts(life: Channel, lanes: Sequence[Channel]) -> None:
        living = asyncio.create_task(live(life, NOW))
        await asyncio.sleep(2.0)
        living.cancel()

    async with supervised(None, None, lasts, None) as seen:
        await asyncio.sleep(4.0)
        assert [death.again_in_s for death in seen.deaths][:5] == [0.1, 0.2, 0.0, 0.1, 0.2]


async def test_what_it_computes_can_be_given_up_and_the_next_one_starts_at_once() -> None:
    async with supervised(hangs, well) as seen:
        await asyncio.sleep(0.1)
        seen.child.kill("what it computes is not wanted any more")
        await asyncio.sleep(0.1)
        assert [(death.cause, death.again_in_s) for death in seen.deaths] == [
            ("what it computes is not wanted any more", 0.0)
        ]
        assert seen.child.is_ready.is_set()


async def test_the_time_for_which_we_stood_still_is_not_its_silence() -> None:
    async def slow(life: Channel, lanes: Sequence[Channel]) -> None:
        life.send(READY, NOW.encode())
        while True:
            ping = await life.receive()
            await asyncio.sleep(0.6)
            life.send(ping)

    async with supervised(slow) as seen:
        await asyncio.sleep(0.2)
        attention().miss(0.4)
        await asyncio.sleep(0.45)
        assert seen.deaths == []
        await asyncio.sleep(0.5)
        assert len(seen.deaths) == 1


async def test_the_time_for_which_it_was_given_no_processor_is_not_its_silence() -> None:
    """It waits for its turn; then it had turns, and waited for others; then it sleeps, and answers nothing."""
    shares = iter([Share(), Share(0.0, 0.0, wants_it=True), Share(0.05, 0.5), Share(0.05, 0.5), Share(0.05, 0.5)])
    async with supervised(hangs, share=lambda: next(shares)) as seen:
        await asyncio.sleep(0.3 + 0.3 + 0.2 - 0.01)
        assert seen.deaths == []
        await asyncio.sleep(0.1)
        assert [death.cause for death in seen.deaths] == ["it was silent for 0.3 s"]


async def test_one_that_is_given_few_turns_may_start_slowly() -> None:
    async def starts_slowly(life: Channel, lanes: Sequence[Channel]) -> None:
        await asyncio.sleep(60.0)
        await live(life, NOW)

    loop = asyncio.get_running_loop()
    began_s = loop.time()
    async with supervised(
        starts_slowly, share=lambda: Share(0.1 * (loop.time() - began_s), 0.0, wants_it=True)
    ) as seen:
        await seen.child.is_ready.wait()
        assert seen.deaths == []


async def test_one_that_computes_without_end_is_killed_when_it_had_its_time() -> None:
    loop = asyncio.get_running_loop()
    began_s = loop.time()
    async with supervised(hangs, share=lambda: Share((loop.time() - began_s) / 2, 0.0, wants_it=True)) as seen:
        await asyncio.sleep(0.55)
        assert seen.deaths == []
        await asyncio.sleep(0.1)
        assert [death.cause for death in seen.deaths] == ["it was silent for 0.3 s"]


async def test_its_last_words_are_heard_before_its_death_is_told() -> None:
    heard: list[bytes] = []

    async def dies(life: Channel, lanes: Sequence[Channel]) -> None:
        life.send(READY, NOW.encode())
        lanes[0].send(b"stop")

    async def serve(lanes: Sequence[Channel]) -> None:
        while True:
            heard.append(bytes(await lanes[0].receive()))

    def died(death: Death) -> None:
        assert heard == [b"stop"]
        over.set()

    over = asyncio.Event()
    running = asyncio.create_task(Child("helper", NOW, start=lambda: InProcess(dies), serve=serve, died=died).run())
    await over.wait()
    running.cancel()
    await asyncio.wait((running,))


async def test_an_error_of_who_serves_it_is_no_death_of_a_child_but_ends_us() -> None:
    async def serve(lanes: Sequence[Channel]) -> None:
        raise ValueError("a mistake of ours")

    with pytest.raises(ValueError, match="a mistake of ours"):
        await Child("helper", NOW, start=lambda: InProcess(well), serve=serve, died=lambda death: None).run()
