"""A client for programs with an event loop.

::

    async with AsyncClient() as robot:
        await robot.arm()
        print(await robot.localize())
"""

import asyncio
import contextlib
import os
from collections import deque
from collections.abc import AsyncGenerator, AsyncIterator, Callable
from pathlib import Path
from types import TracebackType
from typing import Self, TypeVar

import zmq
import zmq.asyncio

from robotd.client.exchange import Exchanges
from robotd.client.feed import Feed, Gap, as_topics
from robotd.client.methods import Awaiting, Methods
from robotd.client.mission_run import MISSION_TOPICS, MissionEvent, MissionRun
from robotd.client.sockets import connect_dealer, connect_subscriber
from robotd.contract.answers import MissionStarted
from robotd.contract.events import Status
from robotd.contract.missions import Mission
from robotd.contract.request import Request
from robotd.contract.requests import GetStatus
from robotd.contract.topics import Frame, Published, Topic
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.endpoints import Endpoints, runtime_dir_of_user
from robotd.core.errors import RequestTimeout, RobotdError, ServerError

R = TypeVar("R")
V = TypeVar("V")

_LOOK_S = 0.05
"""How often a mission looks after its lease while nothing happens."""


class AsyncSubscription:
    """Events of some topics; iterate over it, for ever, or ask for the :meth:`next` one."""

    def __init__(self, socket: zmq.asyncio.Socket) -> None:
        self._socket = socket
        self._feed = Feed()
        self._items: deque[Published | Gap] = deque()

    async def next(self, timeout_s: float | None = None) -> Published | Gap | None:
        """Return the next event, or None if there is none in time."""
        deadline_s = None if timeout_s is None else _now_s() + timeout_s
        while not self._items:
            left_s = None if deadline_s is None else max(0.0, deadline_s - _now_s())
            # Rounded up: waits of 0 ms would spin through the last millisecond.
            if not await self._socket.poll(None if left_s is None else int(left_s * 1000) + 1):
                return None
            self._items.extend(self._feed.accept(await self._socket.recv()))
        return self._items.popleft()

    async def __aiter__(self) -> AsyncIterator[Published | Gap]:
        """Yield events as they come."""
        while (event := await self.next()) is not None:
            yield event

    def close(self) -> None:
        """Unsubscribe and close the socket; what waits unread is dropped."""
        self._socket.close(0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()


class AsyncClient(Methods, Awaiting):
    """Asks a daemon on this machine, and listens to it; one client serves any number of tasks.

    Use it in an ``async with`` block. Every request raises :class:`ServerError` when the daemon refuses and
    :class:`RequestTimeout` when it does not answer.
    """

    def __init__(
        self,
        runtime_dir: str | Path | None = None,
        *,
        name: str = "",
        retry_s: float = 0.5,
        deadline_s: float | None = None,
    ) -> None:
        """Prepare to connect; see :class:`robotd.client.Client`."""
        self._endpoints = Endpoints(Path(runtime_dir or runtime_dir_of_user()))
        self._exchanges = Exchanges(str(self._endpoints), name, retry_s=retry_s, deadline_s=deadline_s)
        self._retry_s = retry_s
        self._patience_s = GetStatus.deadline_s if deadline_s is None else deadline_s
        self._waiting: dict[int, asyncio.Future[None]] = {}

    async def __aenter__(self) -> Self:
        """Connect; the daemon need not run yet."""
        self._context = zmq.asyncio.Context()
        self._commands = self._context.socket(zmq.DEALER)
        connect_dealer(self._commands, self._endpoints, retry_s=self._retry_s)
        # One reader for all tasks that ask: two that read one socket would take each other's answers.
        self._reader = asyncio.create_task(self._read_replies(), name="robotd client")
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None
    ) -> None:
        """Disconnect, subscriptions too."""
        self._reader.cancel()
        await asyncio.wait((self._reader,))
        self._context.destroy(linger=0)

    async def run_mission(self, mission: Mission, lease_s: float | None = None) -> AsyncGenerator[MissionEvent, None]:
        """Start a mission, keep it alive, and yield what happens until it is done.

        The lease is renewed by a task of its own for as long as the generator lives. Leaving it early stops the
        robot; an asynchronous generator notices that at once only inside ``contextlib.aclosing``.

        Raises:
            MissionError: it was stopped, or it failed.
        """
        async with self._follow(MISSION_TOPICS) as events:
            run = MissionRun(await self._start_or_stop(mission, lease_s), _now_s())
            # A task of its own: who takes the events may stop to think for longer than a lease lasts.
            lease = asyncio.create_task(self._keep_lease(run), name=f"lease of mission {run.mission_id}")
            try:
                while not run.is_over:
                    event = await events.next(_LOOK_S)
                    concerned = run.overdue(_now_s()) if event is None else run.accept(event)
                    if concerned is not None:
                        yield concerned
                    elif lease.done():
                        lease.result()  # raises why it could be kept no longer
            finally:
                lease.cancel()
                await asyncio.gather(lease, return_exceptions=True)
                if not run.is_over:
                    await self._abandon()
        run.check()

    async def frames(self, *topics: str) -> AsyncGenerator[Frame | Gap, None]:
        """Yield the messages of these topics, of all if none is named, as they are: to hand on, not to look into.

        Each comes once, and a :class:`Gap` stands where some were missed. Put it into ``contextlib.aclosing``.
        """
        feed = Feed()
        with self._subscriber(topics) as socket:
            while True:
                for item in feed.sort(await socket.recv()):
                    yield item

    def subscribe(self, *topics: str) -> AsyncSubscription:
        """Return the events of these topics, of all if none is named, from the last one of each on."""
        return AsyncSubscription(self._subscriber(topics))

    def _subscriber(self, topics: tuple[str, ...]) -> zmq.asyncio.Socket:
        wanted = as_topics(topics)
        socket = self._context.socket(zmq.SUB)
        connect_subscriber(socket, self._endpoints, wanted)
        return socket

    async def ask(self, request: Request[R], value: Callable[[R], V]) -> V:
        """Send a request and return what is wanted of its answer."""
        return value(await self.call(request))

    async def carry_out(self, mission: Mission, value: Callable[[list[MissionEvent]], V]) -> V:
        """Run a mission to its end and return what is wanted of what happened; ``MissionError`` if it was not done."""
        return value([event async for event in self.run_mission(mission)])

    async def call(self, request: Request[R], client: str | None = None) -> R:
        """Send a request and return its answer; ``client`` names who wants it, if that is not this program itself."""
        exchange = self._exchanges.begin(request, _now_s(), client)
        answered = self._waiting[exchange.id] = asyncio.get_running_loop().create_future()
        try:
            while not exchange.is_answered:
                if data := exchange.due(_now_s()):
                    try:
                        await self._commands.send(data)
                        exchange.reached()
                    except zmq.Again:  # not connected: the next repeat may be
                        exchange.unreached(_now_s())
                await asyncio.wait((answered,), timeout=exchange.wait_s(_now_s()))
                if answered.done():
                    answered.result()
            return exchange.result()
        finally:
            self._exchanges.end(exchange)
            del self._waiting[exchange.id]

    async def _read_replies(self) -> None:
        while True:
            frame = await self._commands.recv()
            try:
                exchange = self._exchanges.accept(frame)
            except RobotdError as error:  # nobody can say whose answer this was
                for waiting in self._waiting.values():
                    _settle(waiting, error)
            else:
                if exchange is not None:
                    _settle(self._waiting[exchange.id], None)

    async def _keep_lease(self, run: MissionRun) -> None:
        while not run.is_ending:
            await asyncio.sleep(run.wait_s(_now_s()))
            if not run.is_due(_now_s()):
                continue
            try:
                run.renewed(await self.renew(run.mission_id), _now_s())
            except ServerError as error:
                raise run.refused(error) from error

    @contextlib.asynccontextmanager
    async def _follow(self, topics: tuple[Topic, ...]) -> AsyncIterator[AsyncSubscription]:
        """Subscribe, and go on only when it is certain that nothing published from now on is missed."""
        await self.hello()  # nobody home is found out sooner than a slow daemon
        with self.subscribe(*topics, Topic.STATUS) as events:
            deadline_s = _now_s() + self._patience_s
            # The daemon greets with the status last: when it is here, the subscriptions before it are in force.
            while not isinstance(event := await events.next(deadline_s - _now_s()), Status):
                if event is None:
                    raise RequestTimeout(f"no status from {self._endpoints}")
            yield events

    async def _start_or_stop(self, mission: Mission, lease_s: float | None) -> MissionStarted:
        try:
            return await self.start(mission, lease_s)
        except Exception:  # it was refused, or nobody answered: then the lease ends what may have begun
            raise
        except BaseException:  # interrupted: the mission may be under way though nobody heard its number
            await self._abandon()
            raise

    async def _abandon(self) -> None:
        """Stop the robot; if even that is not answered, the lease runs out."""
        with contextlib.suppress(RobotdError):
            await self.stop(f"client {os.getpid()} left its mission")


def _settle(waiting: asyncio.Future[None], error: RobotdError | None) -> None:
    if waiting.done():
        return
    if error is None:
        waiting.set_result(None)
    else:
        waiting.set_exception(error)


def _now_s() -> float:
    return now_ns() / NS_PER_S
