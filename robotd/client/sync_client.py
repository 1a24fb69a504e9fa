"""A client for programs without an event loop.

::

    with Client() as robot:
        robot.arm()
        print(robot.localize())
"""

import contextlib
import os
import time
from collections import deque
from collections.abc import Callable, Generator, Iterator
from pathlib import Path
from types import TracebackType
from typing import Self, TypeVar

import zmq

from robotd.client.exchange import Exchanges
from robotd.client.feed import Feed, Gap, as_topics
from robotd.client.methods import Blocking, Methods
from robotd.client.mission_run import MISSION_TOPICS, MissionEvent, MissionRun
from robotd.client.sockets import connect_dealer, connect_subscriber
from robotd.contract.answers import MissionStarted
from robotd.contract.events import Status
from robotd.contract.missions import Mission
from robotd.contract.request import Request
from robotd.contract.requests import GetStatus
from robotd.contract.topics import Published, Topic
from robotd.core.endpoints import Endpoints, runtime_dir_of_user
from robotd.core.errors import RequestTimeout, RobotdError, ServerError

R = TypeVar("R")
V = TypeVar("V")

_now_s = time.monotonic  # there is no loop here whose clock could be asked


class Subscription:
    """Events of some topics; iterate over it, for ever, or ask for the :meth:`next` one."""

    def __init__(self, socket: "zmq.Socket[bytes]") -> None:
        self._socket = socket
        self._feed = Feed()
        self._items: deque[Published | Gap] = deque()

    def next(self, timeout_s: float | None = None) -> Published | Gap | None:
        """Return the next event, or None if there is none in time."""
        deadline_s = None if timeout_s is None else _now_s() + timeout_s
        while not self._items:
            left_s = None if deadline_s is None else max(0.0, deadline_s - _now_s())
            if not self._socket.poll(None if left_s is None else _ms(left_s)):
                return None
            self._items.extend(self._feed.accept(self._socket.recv()))
        return self._items.popleft()

    def __iter__(self) -> Iterator[Published | Gap]:
        """Yield events as they come."""
        while (event := self.next()) is not None:
            yield event

    def close(self) -> None:
        """Unsubscribe and close the socket; what waits unread is dropped."""
        self._socket.close(0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()


class Client(Methods, Blocking):
    """Asks a daemon on this machine, and listens to it.

    Every request raises :class:`ServerError` when the daemon refuses and :class:`RequestTimeout` when it does not
    answer. Use one client per thread.
    """

    def __init__(
        self,
        runtime_dir: str | Path | None = None,
        *,
        name: str = "",
        retry_s: float = 0.5,
        deadline_s: float | None = None,
    ) -> None:
        """Connect; the daemon need not run yet.

        Args:
            runtime_dir: where its sockets are; ``ROBOTD_RUNTIME_DIR`` or ``/run/robotd`` if None.
            name: what the daemon shall call this client; what it sees of its process if empty.
            retry_s: a request is repeated after this long without an answer.
            deadline_s: give up after this long; None leaves each command its own time.

        Raises:
            TransportError: the directory's path is too long for a Unix socket.
        """
        self._endpoints = Endpoints(Path(runtime_dir or runtime_dir_of_user()))
        self._exchanges = Exchanges(str(self._endpoints), name, retry_s=retry_s, deadline_s=deadline_s)
        self._context = zmq.Context()
        self._patience_s = GetStatus.deadline_s if deadline_s is None else deadline_s
        self._commands = self._context.socket(zmq.DEALER)
        connect_dealer(self._commands, self._endpoints, retry_s=retry_s)

    def close(self) -> None:
        """Disconnect, subscriptions too."""
        self._context.destroy(linger=0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def run_mission(self, mission: Mission, lease_s: float | None = None) -> Generator[MissionEvent, None, None]:
        """Start a mission, keep it alive, and yield what happens until it is done.

        The lease is renewed while the next event is awaited, so a caller that dawdles longer than the lease over
        one event loses the mission. Leaving early, by ``break``, an exception or Ctrl-C, stops the robot.

        Raises:
            MissionError: it was stopped, or it failed.
        """
        with self._follow(MISSION_TOPICS) as events:
            run = MissionRun(self._start_or_stop(mission, lease_s), _now_s())
            try:
                yield from self._follow_run(run, events)
            finally:
                if not run.is_over:
                    self._abandon()
        run.check()

    def subscribe(self, *topics: str) -> Subscription:
        """Return the events of these topics, of all if none is named, from the last one of each on."""
        wanted = as_topics(topics)
        socket = self._context.socket(zmq.SUB)
        connect_subscriber(socket, self._endpoints, wanted)
        return Subscription(socket)

    def ask(self, request: Request[R], value: Callable[[R], V]) -> V:
        """Send a request and return what is wanted of its answer."""
        return value(self.call(request))

    def carry_out(self, mission: Mission, value: Callable[[list[MissionEvent]], V]) -> V:
        """Run a mission to its end and return what is wanted of what happened; ``MissionError`` if it was not done."""
        return value(list(self.run_mission(mission)))

    def call(self, request: Request[R], client: str | None = None) -> R:
        """Send a request and return its answer; ``client`` names who wants it, if that is not this program itself."""
        exchange = self._exchanges.begin(request, _now_s(), client)
        try:
            while not exchange.is_answered:
                if data := exchange.due(_now_s()):
                    try:
                        self._commands.send(data)
                        exchange.reached()
                    except zmq.Again:  # not connected: the next repeat may be
                        exchange.unreached(_now_s())
                if self._commands.poll(_ms(exchange.wait_s(_now_s()))):
                    self._exchanges.accept(self._commands.recv())
            return exchange.result()
        finally:
            self._exchanges.end(exchange)

    def _follow_run(self, run: MissionRun, events: Subscription) -> Iterator[MissionEvent]:
        while not run.is_over:
            if run.is_due(_now_s()):
                try:
                    run.renewed(self.renew(run.mission_id), _now_s())
                except ServerError as error:
                    raise run.refused(error) from error
            event = events.next(run.wait_s(_now_s()))
            concerned = run.overdue(_now_s()) if event is None else run.accept(event)
            if concerned is not None:
                yield concerned

    @contextlib.contextmanager
    def _follow(self, topics: tuple[Topic, ...]) -> Iterator[Subscription]:
        """Subscribe, and go on only when it is certain that nothing published from now on is missed."""
        self.hello()  # nobody home is found out sooner than a slow daemon
        with self.subscribe(*topics, Topic.STATUS) as events:
            deadline_s = _now_s() + self._patience_s
            # The daemon greets with the status last: when it is here, the subscriptions before it are in force.
            while not isinstance(event := events.next(deadline_s - _now_s()), Status):
                if event is None:
                    raise RequestTimeout(f"no status from {self._endpoints}")
            yield events

    def _start_or_stop(self, mission: Mission, lease_s: float | None) -> MissionStarted:
        try:
            return self.start(mission, lease_s)
        except Exception:  # it was refused, or nobody answered: then the lease ends what may have begun
            raise
        except BaseException:  # interrupted: the mission may be under way though nobody heard its number
            self._abandon()
            raise

    def _abandon(self) -> None:
        """Stop the robot; if even that is not answered, the lease runs out."""
        with contextlib.suppress(RobotdError):
            self.stop(f"client {os.getpid()} left its mission")


def _ms(seconds: float) -> int:
    # Rounded up: waits of 0 ms would spin through the last millisecond.
    return int(seconds * 1000) + 1
