"""The head as the daemon has it: a process of its own, started again when it dies, fed the same again, and asked again.

One job is under way at a time; the others wait here. An answer that is none, comes twice, or is to an older job is a
sign of a head gone mad: it is killed, and another one is asked. Who is not interested in an answer any more (its
mission was stopped) does not wait for it: a job that goes on regardless is ended with its head.
"""

import asyncio
import itertools
import logging
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NoReturn, Protocol

import msgspec

from robotd import __version__
from robotd.children.channel import Channel
from robotd.children.child import Child, Death
from robotd.children.pings import Patience
from robotd.children.process import Process, Program, Running, spawn
from robotd.core.errors import ChildError, RemoteProtocolError, RobotdError
from robotd.core.text import printable_bytes
from robotd.head.job import A, Job
from robotd.head.jobs import Forget
from robotd.head.remembered import Memory
from robotd.head.settings import HeadSettings
from robotd.head.wire import NUMBER, JobFailed, pack_job, unpack_answer

DEATHS = 3
"""So often the same job may end its head; one time more it would, too."""
AWAY_S = 20.0
"""So long a head that is away is waited for, however often it was started meanwhile: on a busy machine that takes
seconds."""
JOB_S = 600.0
"""No job takes so long: the largest map, all headings and the conservative mode take minutes on a slow machine."""
UNWANTED_S = 0.25
"""What a job that nobody waits for any more is given to end by itself: most take less, and a new head takes longer."""
PATIENCE = Patience(silent_s=5.0, between_s=0.25, goodbye_s=0.1)
"""A step of array work that keeps the interpreter takes a second on the largest map, and more beside busy programs."""

log = logging.getLogger(__name__)


def program(log_level: str) -> Program:
    """Return what to start."""
    return Program(("-m", "robotd.head"), arguments=(log_level,))


class Host(Protocol):
    """Who is told how the head is."""

    def head_away(self, why: str | None) -> None:
        """Take note that a mission waits for the head, and why; None if it does not any more."""

    def head_lost(self, why: str) -> None:
        """End what waits for the head: it does not come back, or not with an answer."""


@dataclass(slots=True, eq=False)
class _Asked:
    job: Job[Any]
    data: bytes
    answer: "asyncio.Future[Any]" = field(default_factory=lambda: asyncio.get_running_loop().create_future())
    deaths: int = 0


class FarHead:
    """A :class:`robotd.head.head.Head` in another process."""

    def __init__(
        self,
        settings: HeadSettings,
        start: Callable[[], Running],
        patience: Patience = PATIENCE,
        *,
        away_s: float = AWAY_S,
        job_s: float = JOB_S,
    ) -> None:
        """Prepare; nothing is started yet.

        Args:
            settings: what its jobs are done by.
            start: starts one, see :func:`program`.
            patience: how long to wait for its signs of life.
            away_s: how long one that is away is waited for.
            job_s: how long a job may take.
        """
        self.host: Host | None = None
        self.pid: int | None = None
        """Of the process that was started last."""
        self._settings = msgspec.msgpack.encode(settings)
        self._away_s = away_s
        self._job_s = job_s
        self._numbers = itertools.count(1)
        self._jobs = itertools.count(1)
        self._memory = Memory()
        self._asked: deque[_Asked] = deque()
        self._news = asyncio.Event()
        self._under_way: _Asked | None = None
        self._why_away: str | None = None
        """Why there is none; None as long as there is one."""
        self._away: asyncio.TimerHandle | None = None
        self._is_lost = False
        self._child = Child("head", __version__, start=start, serve=self._serve, died=self._died, patience=patience)

    @classmethod
    def spawned(cls, settings: HeadSettings, log_level: str) -> "FarHead":
        """Return one that will be started as a process."""

        def start() -> Process:
            process = spawn(program(log_level))
            head.pid = process.pid
            return process

        head = cls(settings, start)
        return head

    @property
    def waiting(self) -> int:
        """How many jobs are under way, or wait for their turn."""
        return len(self._asked)

    def number(self) -> int:
        """Return the next number."""
        return next(self._numbers)

    def forget(self, number: int) -> None:
        """Let go of it in its turn, after what was asked of it."""
        self._wait(Forget(number))

    async def ask(self, job: Job[A]) -> A:
        """Return the answer of a job, see :class:`robotd.head.head.Head`.

        What a mission waits for is not refused: if there is no answer to come, the host is told, and ends the mission.

        Raises:
            ChildError: there is no head, or it cannot answer this.
        """
        asked = self._wait(job)
        self._tell()
        if self._is_lost:
            # Not from here: who ends a mission must not be the mission, which would wait for itself.
            asyncio.get_running_loop().call_soon(self._refuse, asked, self._why_lost)
        try:
            answer: A = await asked.answer
        finally:
            self._no_longer_wanted(asked)
        return answer

    async def run(self) -> NoReturn:
        """Have a head until cancelled, which ends it, too."""
        try:
            await self._child.run()
        finally:
            if self._away is not None:
                self._away.cancel()

    def _wait(self, job: Job[Any]) -> _Asked:
        # Packed when it is asked, not when it is sent: what it was made of may change while it waits.
        asked = _Asked(job, pack_job(job))
        self._asked.append(asked)
        self._news.set()
        return asked

    async def _serve(self, lanes: Sequence[Channel]) -> None:
        (lane,) = lanes
        # With each start again, over the lane: the child reads no configuration of its own.
        lane.send(self._settings)
        about = await lane.receive()
        # Before anything new: a job may be about a map that only the one before held.
        for step in self._memory:
            step.check(await self._answered(lane, step.data))
        self._back(printable_bytes(bytes(about)))
        while True:
            # One at a time, though the lane would take more: who answers out of turn can only be seen if one
            # answer is due.
            while not self._asked:
                self._news.clear()
                await self._news.wait()
            await self._do(lane, self._asked[0])

    async def _do(self, lane: Channel, asked: _Asked) -> None:
        self._under_way = asked
        # Left in the queue while it is computed: if this head dies the next one is asked the same.
        data = await self._answered(lane, asked.data)
        try:
            answer: Any = unpack_answer(type(asked.job), data)
        except RemoteProtocolError as error:
            raise ChildError(str(error)) from error
        except (RobotdError, JobFailed) as error:
            self._done_with(asked)
            if not asked.answer.done():
                asked.answer.set_exception(error)
            return
        # Before the answer is handed on: what is asked next may be about what this one made.
        self._note(asked, answer)
        self._done_with(asked)
        if not asked.answer.done():
            asked.answer.set_result(answer)

    def _note(self, asked: _Asked, answer: object) -> None:
        """Remember what is held now."""
        made = asked.job.makes
        if isinstance(asked.job, Forget):
            self._memory.forget(asked.job.number)
        # Only what somebody heard of is remembered: numbers that no mission knows would be fed to every head to
        # come.
        elif not asked.answer.done():
            self._memory.note(asked.job, answer)
        elif made is not None and made.number not in self._memory:
            self.forget(made.number)  # nobody heard of it

    async def _answered(self, lane: Channel, data: bytes) -> memoryview:
        """Send a job, and return its answer; ChildError if it is none, or of another job."""
        number = next(self._jobs).to_bytes(NUMBER, "little")
        if not lane.send(number, data):
            raise ChildError("it takes no more jobs")
        try:
            # The loop's own clock and not a silence that a replay knows: in a replay no head is away.
            async with asyncio.timeout(self._job_s):
                answer = await lane.receive()
        except TimeoutError:
            raise ChildError(f"a job took more than {self._job_s:g} s") from None
        # An answer that is one behind would be believed, and each after it.
        if answer[:NUMBER] != number:
            raise ChildError("it answered another job than it was asked, or one twice")
        return memoryview(answer)[NUMBER:]  # not a copy: it may hold a map

    def _done_with(self, asked: _Asked) -> None:
        self._under_way = None
        self._asked.remove(asked)
        self._tell()

    def _no_longer_wanted(self, asked: _Asked) -> None:
        if asked is self._under_way:
            # Not at once: it may be nearly done, and a new head must be fed all that this one holds.
            asyncio.get_running_loop().call_later(UNWANTED_S, self._end_unwanted, asked)
        # Not begun yet: it is simply not asked.
        elif asked in self._asked:
            self._asked.remove(asked)
        self._tell()

    def _end_unwanted(self, asked: _Asked) -> None:
        if asked is self._under_way:
            self._child.kill(f"nobody waits for what it computes ({asked.job.name}) any more")

    def _died(self, death: Death) -> None:
        asked, self._under_way = self._under_way, None
        # Nobody waits for it any more: it need not be asked again.
        if asked is not None and asked.answer.done():
            self._asked.remove(asked)
        elif asked is not None:
            asked.deaths += 1
            if asked.deaths >= DEATHS:
                self._refuse(asked, f"the head ended {DEATHS} times at {asked.job.name!r}, last: {death.cause}")
        self._why_away = death.cause
        # Counted from the first death on: one that dies before it is back has been away all the time.
        if self._away is None:
            self._away = asyncio.get_running_loop().call_later(self._away_s, self._lose)
        self._tell()

    def _lose(self) -> None:
        """Give up those who wait; the next head is tried all the same."""
        self._is_lost = True
        if self.host is not None:
            self.host.head_lost(self._why_lost)
        for asked in tuple(self._asked):
            if asked.job.is_noted:
                self._asked.remove(asked)
            else:
                self._refuse(asked, self._why_lost)

    @property
    def _why_lost(self) -> str:
        return f"the head, which does all array work, has been away for {self._away_s:g} s: {self._why_away}"

    def _refuse(self, asked: _Asked, why: str) -> None:
        """Let one who waits know that there is no answer to come."""
        if isinstance(asked.job, Forget) or asked not in self._asked:
            return
        if not asked.job.is_noted:
            if not asked.answer.done():
                asked.answer.set_exception(ChildError(why))
            return
        # An error would not do: a replay, in which no head dies, would not come to it. Who waits is ended.
        self._asked.remove(asked)
        if self.host is not None:
            self.host.head_lost(why)

    def _back(self, about: str) -> None:
        if self._away is not None:
            self._away.cancel()
        self._away, self._why_away, self._is_lost = None, None, False
        log.info("the head is there: %s", about)
        self._tell()

    def _tell(self) -> None:
        if self.host is not None:
            waits = any(asked.job.is_noted and not asked.answer.done() for asked in self._asked)
            self.host.head_away(self._why_away if waits else None)
