"""A head that dies, hangs or lies is found out, started again, fed the same again, and asked again."""

import asyncio
import contextlib
import math
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from dataclasses import dataclass, field

import pytest

from robotd import __version__
from robotd.children.channel import Channel, Message, Part
from robotd.children.in_process import InProcess, Main
from robotd.children.inside import live
from robotd.children.process import Running
from robotd.core.errors import ChildError
from robotd.core.pose import IDENTITY
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.settings import GridSettings
from robotd.head.answering import answer_to
from robotd.head.desk import Desk
from robotd.head.far import AWAY_S, JOB_S, FarHead
from robotd.head.jobs import BeginMap, Insert, Inserted, MapRef, Narrow, Narrowed, Plan, Prepare, ShowMap
from robotd.head.settings import HeadSettings
from robotd.head.wire import NUMBER, JobFailed, NotHeld, pack_answer, pack_error, unpack_job

GRID = GridSettings(rows=60, cols=80)
SPEC = GRID.spec_covering(((0.0, 0.0),), 1.0)
READINGS = tuple(RangeReading(n, 0.1 * n, ReadingStatus.OK, 1.0 + 0.2 * math.sin(n)) for n in range(60))
SWEEP = Sweep(0, IDENTITY, READINGS)

Reply = Callable[[Channel, bytes, bytes], Awaitable[None]]
"""Does something in place of an answer: to a lane, the number of a job, and the right answer to it."""


@dataclass
class Told:
    """What the host heard."""

    away: list[str | None] = field(default_factory=list)
    lost: list[str] = field(default_factory=list)

    def head_away(self, why: str | None) -> None:
        if why != (self.away[-1] if self.away else None):
            self.away.append(why)

    def head_lost(self, why: str) -> None:
        self.lost.append(why)


@dataclass
class Heads:
    """Programs of heads, each of which misbehaves at one job of its life, or at none."""

    reply: Reply | None = None
    at: str = ""
    """Names of jobs, with commas between them."""
    of_lives: range = range(1)
    """In which of its lives."""
    lives: int = 0
    done: list[str] = field(default_factory=list)
    """The jobs of all lives, by name; a new life begins with a dash."""

    def start(self) -> Running:
        life = self.lives
        self.lives += 1
        self.done.append("-")
        return InProcess(self._program(life))

    def _program(self, number: int) -> Main:
        async def program(life: Channel, lanes: Sequence[Channel]) -> None:
            tasks = [asyncio.create_task(live(life, __version__)), asyncio.create_task(self._work(number, lanes[0]))]
            try:
                done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
                for task in done:
                    task.result()
            finally:
                for task in tasks:
                    task.cancel()
                await asyncio.wait(tasks)

        return program

    async def _work(self, life: int, lane: Channel) -> None:
        await lane.receive()
        lane.send(b"a test")
        desk = Desk(HeadSettings())
        while True:
            message = await lane.receive()
            name = unpack_job(message[NUMBER:]).name
            self.done.append(name)
            answer = answer_to(desk, message[NUMBER:])
            if self.reply is not None and name in self.at.split(",") and life in self.of_lives:
                await self.reply(lane, bytes(message[:NUMBER]), answer)
            else:
                lane.send(message[:NUMBER], answer)


@contextlib.asynccontextmanager
async def far(heads: Heads) -> AsyncIterator[tuple[FarHead, Told]]:
    head, told = FarHead(HeadSettings(), heads.start), Told()
    head.host = told
    running = asyncio.create_task(head.run())
    try:
        yield head, told
    finally:
        running.cancel()
        await asyncio.wait((running,))
        assert running.cancelled(), running.exception()


async def mapped_and_looked_round(head: FarHead) -> tuple[Inserted, list[Narrowed]]:
    """Two sweeps laid in, and a look round in three batches."""
    await head.ask(BeginMap(1, SPEC, GRID))
    await head.ask(Insert(MapRef(1), SWEEP, IDENTITY))
    inserted = await head.ask(Insert(MapRef(1, 1), SWEEP, IDENTITY))
    await head.ask(Prepare(2, MapRef(1, 2), "m", (0.0, 0.1), None))
    batches = (READINGS[:20], READINGS[20:40], READINGS[40:])
    narrowed = [await head.ask(Narrow(2, batch, 5, batch is batches[-1])) for batch in batches]
    head.forget(2)
    return inserted, narrowed


async def dies(lane: Channel, number: bytes, answer: bytes) -> None:
    raise SystemError("killed")


async def says_nothing(lane: Channel, number: bytes, answer: bytes) -> None:
    await asyncio.Event().wait()


async def garbage(lane: Channel, number: bytes, answer: bytes) -> None:
    lane.send(number, b"\xc1\x00 what is this")


async def nothing_at_all(lane: Channel, number: bytes, answer: bytes) -> None:
    lane.send(b"")


async def of_another_type(lane: Channel, number: bytes, answer: bytes) -> None:
    lane.send(number, pack_answer(["a", 1]))


async def to_an_older_one(lane: Channel, number: bytes, answer: bytes) -> None:
    lane.send((int.from_bytes(number, "little") - 1).to_bytes(NUMBER, "little"), answer)


async def twice(lane: Channel, number: bytes, answer: bytes) -> None:
    lane.send(number, answer)
    lane.send(number, answer)


async def has_lost_what_it_held(lane: Channel, number: bytes, answer: bytes) -> None:
    lane.send(number, pack_error(NotHeld("no map 1 of generation 0 is held")))


async def hung_up(lane: Channel, number: bytes, answer: bytes) -> None:
    lane.close()


MISDEEDS = (
    *(dies, says_nothing, garbage, nothing_at_all, of_another_type),
    *(to_an_older_one, twice, has_lost_what_it_held, hung_up),
)


@pytest.mark.parametrize("at", ["begin map", "insert", "prepare", "narrow"])
@pytest.mark.parametrize("reply", MISDEEDS)
async def test_whatever_a_head_does_wrong_another_goes_on_where_it_was_and_nothing_is_lost(
    reply: Reply, at: str
) -> None:
    async with far(Heads()) as (head, _):
        expected = await mapped_and_looked_round(head)
    heads = Heads(reply, at)
    async with far(heads) as (head, told):
        assert await mapped_and_looked_round(head) == expected
        assert heads.lives == 2
        assert told.lost == []
        # A second answer may come when nobody waits any more.
        assert (len(told.away), told.away[-1:]) == (2, [None]) or reply is twice


@dataclass
class Full:
    """A lane that has room for the settings alone."""

    lane: Channel
    sent: int = 0

    def send(self, *parts: Part) -> bool:
        self.sent += 1
        return self.sent == 1 and self.lane.send(*parts)

    async def receive(self) -> Message:
        return await self.lane.receive()

    async def room(self) -> None:
        await self.lane.room()

    def close(self) -> None:
        self.lane.close()


async def test_one_that_takes_no_more_jobs_is_killed_and_the_next_one_has_them() -> None:
    heads = Heads()

    def start() -> Running:
        running = heads.start()
        if heads.lives == 1:
            running.lanes = [Full(running.lanes[0])]  # type: ignore[misc]  # of a child that is a test
        return running

    head, told = FarHead(HeadSettings(), start), Told()
    head.host = told
    running = asyncio.create_task(head.run())
    await mapped_and_looked_round(head)
    assert told.away == ["it takes no more jobs", None]
    assert heads.lives == 2
    running.cancel()
    await asyncio.wait((running,))


async def test_a_new_head_is_fed_the_map_and_the_stop_again_and_estimates_nothing_twice() -> None:
    heads = Heads(dies, "narrow")
    async with far(heads) as (head, told):
        await mapped_and_looked_round(head)
    assert heads.done == [
        *("-", "begin map", "insert", "insert", "prepare", "narrow"),
        *("-", "begin map", "insert", "insert", "prepare", "narrow", "narrow", "narrow", "forget"),
    ]
    assert told.away[0] == "it ended with SystemError('killed')"


async def test_readings_of_which_all_was_said_are_only_taken_again() -> None:
    async def at_the_third(lane: Channel, number: bytes, answer: bytes) -> None:
        if heads.done.count("narrow") == 3:
            raise SystemError("killed")
        lane.send(number, answer)

    async with far(Heads()) as (head, _):
        expected = await mapped_and_looked_round(head)
    heads = Heads(at_the_third, "narrow")
    async with far(heads) as (head, _):
        assert await mapped_and_looked_round(head) == expected
    second_life = heads.done[heads.done.index("-", 1) :]
    assert second_life[4:] == ["prepare", "take readings", "take readings", "narrow", "forget"]


async def test_what_is_forgotten_is_not_fed_again() -> None:
    heads = Heads(dies, "plan")
    async with far(heads) as (head, _):
        await mapped_and_looked_round(head)
        head.forget(1)
        await head.ask(BeginMap(3, SPEC, GRID))
        await head.ask(Plan(MapRef(3), IDENTITY, (0.5, 0.5)))
    assert heads.done[-3:] == ["-", "begin map", "plan"]


async def test_an_insertion_that_was_given_up_is_not_fed_again() -> None:
    heads = Heads(dies, "plan")
    async with far(heads) as (head, _):
        await head.ask(BeginMap(1, SPEC, GRID))
        given_up = await head.ask(Insert(MapRef(1), Sweep(0, IDENTITY, READINGS[:9]), IDENTITY))
        inserted = await head.ask(Insert(MapRef(1), SWEEP, IDENTITY))
        await head.ask(Plan(MapRef(1, 1), IDENTITY, (0.5, 0.5)))
        assert (await head.ask(ShowMap(MapRef(1, 1)))).digest == inserted.digest != given_up.digest
    assert heads.done[-4:] == ["begin map", "insert", "plan", "show map"]


async def test_a_new_head_that_comes_to_another_map_is_not_believed() -> None:
    async def dies_and_then_lies(lane: Channel, number: bytes, answer: bytes) -> None:
        if heads.lives == 1 and heads.done[-1] == "plan":
            raise SystemError("killed")
        if heads.lives == 2:
            answer = answer.replace(inserted.digest.encode(), inserted.digest[::-1].encode())
        lane.send(number, answer)

    heads = Heads(dies_and_then_lies, "insert,plan", range(9))
    async with far(heads) as (head, told):
        await head.ask(BeginMap(1, SPEC, GRID))
        inserted = await head.ask(Insert(MapRef(1), SWEEP, IDENTITY))
        await head.ask(Plan(MapRef(1, 1), IDENTITY, (0.5, 0.5)))
        assert told.away[-2:] == ["it came to another map than the one before it", None]
    assert heads.done[-4:] == ["-", "begin map", "insert", "plan"]
    assert heads.lives == 3


async def test_a_job_that_ends_its_head_again_and_again_is_given_up_and_the_next_is_done() -> None:
    heads = Heads(dies, "plan", range(9))
    async with far(heads) as (head, told):
        await head.ask(BeginMap(1, SPEC, GRID))
        asking = asyncio.create_task(head.ask(Plan(MapRef(1), IDENTITY, (0.5, 0.5))))
        await asyncio.sleep(2.0)
        assert told.lost == ["the head ended 3 times at 'plan', last: it ended with SystemError('killed')"]
        asking.cancel()  # as the host does, with the mission
        await asyncio.wait((asking,))
        assert (await head.ask(ShowMap(MapRef(1)))).spec == SPEC


async def test_what_no_mission_waits_for_is_refused_by_an_error() -> None:
    async with far(Heads(dies, "show map", range(9))) as (head, told):
        await head.ask(BeginMap(1, SPEC, GRID))
        with pytest.raises(ChildError, match="3 times at 'show map'"):
            await head.ask(ShowMap(MapRef(1)))
        assert (told.lost, told.away) == ([], [])


async def test_a_job_may_not_take_for_ever() -> None:
    async with far(Heads(says_nothing, "show map")) as (head, _):
        await head.ask(BeginMap(1, SPEC, GRID))
        before_s = asyncio.get_running_loop().time()
        await head.ask(ShowMap(MapRef(1)))
        assert asyncio.get_running_loop().time() - before_s == pytest.approx(JOB_S, abs=1.0)


async def test_a_head_that_cannot_be_started_is_waited_for_for_a_while_and_tried_for_good() -> None:
    heads, starts = Heads(), 0

    def start() -> Running:
        nonlocal starts
        starts += 1
        if starts < 12:
            raise ChildError("it cannot be started: no memory")
        return heads.start()

    head, told = FarHead(HeadSettings(), start), Told()
    head.host = told
    running = asyncio.create_task(head.run())
    with pytest.raises(ChildError, match="has been away for 20 s: it cannot be started: no memory"):
        await head.ask(ShowMap(MapRef(1)))
    assert asyncio.get_running_loop().time() >= AWAY_S
    assert len(told.lost) == 1
    with pytest.raises(ChildError, match="away"):  # and at once, for as long as it is away
        await head.ask(ShowMap(MapRef(1)))
    asking = asyncio.create_task(head.ask(BeginMap(1, SPEC, GRID)))
    await asyncio.sleep(0.01)
    assert len(told.lost) == 2
    asking.cancel()
    await asyncio.sleep(60.0)
    assert (await head.ask(BeginMap(2, SPEC, GRID))).spec == SPEC
    running.cancel()
    await asyncio.wait((running,))


async def test_a_job_that_nobody_waits_for_any_more_is_ended_with_its_head() -> None:
    heads = Heads(says_nothing, "plan")
    async with far(heads) as (head, _):
        await head.ask(BeginMap(1, SPEC, GRID))
        before_s = asyncio.get_running_loop().time()
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(1.0):
                await head.ask(Plan(MapRef(1), IDENTITY, (0.5, 0.5)))
        await head.ask(ShowMap(MapRef(1)))
        assert asyncio.get_running_loop().time() - before_s < 1.6
    assert heads.done == ["-", "begin map", "plan", "-", "begin map", "show map"]


async def test_one_that_nobody_waits_for_is_not_begun() -> None:
    heads = Heads()
    async with far(heads) as (head, _):
        asking = [asyncio.create_task(head.ask(BeginMap(number, SPEC, GRID))) for number in (1, 2)]
        await asyncio.sleep(0.0)
        asking[1].cancel()
        await asyncio.wait(asking)
    assert heads.done == ["-", "begin map"]


async def test_a_mistake_of_ours_is_told_and_the_head_lives_on() -> None:
    heads = Heads()
    async with far(heads) as (head, _):
        await head.ask(BeginMap(1, SPEC, GRID))
        await head.ask(Prepare(2, MapRef(1), "", (0.0,), None))
        with pytest.raises(JobFailed, match="ValueError"):
            await head.ask(Narrow(2, (RangeReading(1, 0.1, ReadingStatus.WEAK, None),), 5, False))
        await head.ask(ShowMap(MapRef(1)))
    assert heads.lives == 1
