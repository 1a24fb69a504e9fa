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
from collections.abc import Generator, Iterator
from pathlib import Path
from types import TracebackType
from typing import Self, TypeVar

import zmq

from robotd.client.endpoints import Endpoints, runtime_dir_of_user
from robotd.client.exchange import Exchanges
from robotd.client.feed import Feed, Gap, as_topics
from robotd.client.mission_run import MISSION_TOPICS, MissionEvent, MissionRun, final_estimate
from robotd.client.sockets import connect_dealer, connect_subscriber
from robotd.contract import requests as api
from robotd.contract.area import Area
from robotd.contract.estimate import PoseEstimate
from robotd.contract.events import MapChanged, Status
from robotd.contract.map_wire import unpack_map
from robotd.contract.missions import DriveMission, Legs, LocalizeMission, MapMission, Mission, PriorHeading
from robotd.contract.requests import Command, MapEntryInfo
from robotd.contract.topics import Published, Topic
from robotd.core.errors import RequestTimeout, RobotdError, ServerError
from robotd.core.pose import IDENTITY, Pose2

R = TypeVar("R")

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
        """Unsubscribe."""
        self._socket.close(0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()


class Client:
    """Asks a daemon on this machine, and listens to it.

    Every request raises :class:`ServerError` when the daemon refuses and :class:`RequestTimeout` when it does not
    answer. Use one client per thread.
    """

    def __init__(
        self, runtime_dir: str | Path | None = None, *, retry_s: float = 0.5, deadline_s: float | None = None
    ) -> None:
        """Connect; the daemon need not run yet.

        Args:
            runtime_dir: where its sockets are; ``ROBOTD_RUNTIME_DIR`` or ``/run/robotd`` if None.
            retry_s: a request is repeated after this long without an answer.
            deadline_s: give up after this long; None leaves each command its own time.

        Raises:
            TransportError: the directory's path is too long for a Unix socket.
        """
        self._endpoints = Endpoints(Path(runtime_dir or runtime_dir_of_user()))
        self._exchanges = Exchanges(str(self._endpoints), retry_s=retry_s, deadline_s=deadline_s)
        self._context = zmq.Context()
        self._patience_s = api.GetStatus.deadline_s if deadline_s is None else deadline_s
        self._commands = self._context.socket(zmq.DEALER)
        connect_dealer(self._commands, self._endpoints, retry_s=retry_s)

    def close(self) -> None:
        """Disconnect, subscriptions too."""
        self._context.destroy(linger=0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def hello(self) -> api.HelloResult:
        """Return who answers."""
        return self.call(api.Hello())

    def status(self) -> Status:
        """Return the whole robot in one look."""
        return self.call(api.GetStatus())

    def config(self) -> str:
        """Return the effective configuration, as TOML."""
        return self.call(api.GetConfig()).text

    def arm(self) -> None:
        """Allow motion."""
        self.call(api.Arm())

    def disarm(self) -> None:
        """Stop and forbid motion."""
        self.call(api.Disarm())

    def stop(self, reason: str = "stopped by a client") -> None:
        """Stop now, for any reason: ``str`` of an exception will do, cut to the letters that are kept."""
        self.call(api.Stop.because(reason))

    def clear(self) -> None:
        """Acknowledge latched faults."""
        self.call(api.Clear())

    def start(self, mission: Mission, lease_s: float | None = None) -> api.MissionStarted:
        """Start a mission; it is stopped unless :meth:`renew` comes before the lease runs out, again and again."""
        return self.call(api.start_command(mission, lease_s))

    def renew(self, mission_id: int) -> api.Renewed:
        """Keep a mission's lease alive, and learn how far it has come."""
        return self.call(api.Renew(mission_id))

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

    def make_map(
        self,
        name: str,
        stops_m: tuple[tuple[float, float], ...] = (),
        start: Pose2 = IDENTITY,
        legs: Legs = Legs.PLANNED,
    ) -> list[MissionEvent]:
        """Make a new map and return what happened; ``MissionError`` if it was not done."""
        return list(self.run_mission(MapMission(name, stops_m, start, legs)))

    def localize(
        self,
        heading_rad: float | None = None,
        *,
        tie: bool = True,
        heading: PriorHeading = PriorHeading.ODOMETRY,
        within: Area | None = None,
    ) -> PoseEstimate:
        """Sweep here and return where it is; ``MissionError`` if it was not done. Without ``tie`` it only looks."""
        mission = LocalizeMission(heading_rad, tie, heading, within)
        return final_estimate(list(self.run_mission(mission)))

    def drive_to(self, x_m: float, y_m: float, legs: Legs = Legs.PLANNED) -> list[MissionEvent]:
        """Drive to a place on the map and return what happened; ``MissionError`` if it was not reached."""
        return list(self.run_mission(DriveMission(x_m, y_m, legs)))

    def map_save(self, name: str | None = None) -> MapEntryInfo:
        """Store the map in use, under its own name or another."""
        return self.call(api.MapSave(name))

    def map_load(self, name: str, version: int | None = None, robot_in_map: Pose2 | None = None) -> MapEntryInfo:
        """Take a stored map into use, and say where the robot is on it if that is known."""
        pose = None if robot_in_map is None else api.PoseArgument.of(robot_in_map)
        return self.call(api.MapLoad(name, version, pose))

    def map_discard(self) -> None:
        """Give up what nobody saved of the map in use."""
        self.call(api.MapDiscard())

    def map_list(self) -> tuple[MapEntryInfo, ...]:
        """Return the stored maps."""
        return self.call(api.ListMaps()).maps

    def map_show(self, name: str | None = None, version: int | None = None) -> MapChanged:
        """Return the whole map in use, or a stored one."""
        return unpack_map(self.call(api.MapShow(name, version)))

    def record_start(self, path: str | None = None) -> str | None:
        """Start recording, to a new file below the daemon's ``recording.dir``, and return where."""
        return self.call(api.RecordStart(path)).path

    def record_stop(self) -> str | None:
        """Close the recording and return where it is, or None if there was none."""
        return self.call(api.RecordStop()).path

    def subscribe(self, *topics: str) -> Subscription:
        """Return the events of these topics, of all if none is named, from the last one of each on."""
        wanted = as_topics(topics)
        socket = self._context.socket(zmq.SUB)
        connect_subscriber(socket, self._endpoints, wanted)
        return Subscription(socket)

    def call(self, command: Command[R]) -> R:
        """Return what a command answers."""
        exchange = self._exchanges.begin(command, _now_s())
        try:
            while not exchange.is_answered:
                if data := exchange.due(_now_s()):
                    with contextlib.suppress(zmq.Again):  # not connected: the next repeat may be
                        self._commands.send(data)
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
        with self.subscribe(*topics, Topic.STATUS) as events:
            deadline_s = _now_s() + self._patience_s
            while not isinstance(event := events.next(deadline_s - _now_s()), Status):
                if event is None:
                    raise RequestTimeout(f"no status from {self._endpoints}")
            yield events

    def _start_or_stop(self, mission: Mission, lease_s: float | None) -> api.MissionStarted:
        try:
            return self.start(mission, lease_s)
        except Exception:
            raise
        except BaseException:  # interrupted: the mission may be under way though nobody heard its number
            self._abandon()
            raise

    def _abandon(self) -> None:
        """Stop the robot; if even that is not answered, the lease runs out."""
        with contextlib.suppress(RobotdError):
            self.stop(f"client {os.getpid()} left its mission")


def _ms(seconds: float) -> int:
    return int(seconds * 1000) + 1
