"""The methods of both clients, as one table: what each takes makes a request, what it returns is taken from the answer.

A method is sugar: ``client.arm()`` is ``client.call(Arm())``. A request without a line here can be sent all the same.
"""

from collections.abc import Awaitable, Callable, Coroutine, Iterable
from functools import wraps
from typing import Any, Generic, ParamSpec, Self, TypeVar, cast, overload

from robotd.client.mission_run import MissionEvent, final_estimate, last_sweep, ranges_measured
from robotd.contract.map_import import MapImport
from robotd.contract.missions import (
    DriveStraight,
    DriveTo,
    Explore,
    Localize,
    Look,
    MapContinue,
    MapStart,
    Measure,
    Mission,
    Resolve,
    Scan,
    Turn,
    with_lease,
)
from robotd.contract.request import Request
from robotd.contract.requests import (
    Arm,
    Clear,
    Disarm,
    GetConfig,
    GetMetrics,
    GetStatus,
    Hello,
    ListMaps,
    ListRecordings,
    MapDelete,
    MapDiscard,
    MapLoad,
    MapRename,
    MapSave,
    MapShow,
    PlanTo,
    RecordDelete,
    RecordStart,
    RecordStop,
    Renew,
    Stop,
)

P = ParamSpec("P")
A = TypeVar("A")
V = TypeVar("V")


class Blocking:
    """A client whose calls return when they are answered."""

    def ask(self, request: Request[A], value: Callable[[A], V]) -> V:
        """Send a request and return what is wanted of its answer."""
        raise NotImplementedError

    def ask_in_turn(self, requests: Iterable[Request[A]], value: Callable[[A], V]) -> V:
        """Send one request after the other and return what is wanted of the last one's answer."""
        *_, answer = (self.ask(request, _all) for request in requests)
        return value(answer)

    def carry_out(self, mission: Mission, value: Callable[[list[MissionEvent]], V]) -> V:
        """Run a mission to its end and return what is wanted of what happened."""
        raise NotImplementedError


class Awaiting:
    """A client whose calls are awaited."""

    async def ask(self, request: Request[A], value: Callable[[A], V]) -> V:
        """Send a request and return what is wanted of its answer."""
        raise NotImplementedError

    async def ask_in_turn(self, requests: Iterable[Request[A]], value: Callable[[A], V]) -> V:
        """Send one request after the other and return what is wanted of the last one's answer."""
        answers = [await self.ask(request, _all) for request in requests]
        return value(answers[-1])

    async def carry_out(self, mission: Mission, value: Callable[[list[MissionEvent]], V]) -> V:
        """Run a mission to its end and return what is wanted of what happened."""
        raise NotImplementedError


class Method(Generic[P, V]):
    """A method of both clients: its arguments make what is sent, and the client says how its caller waits."""

    def __init__(self, make: Callable[P, Any], send: Callable[[Blocking | Awaiting, Any], Any]) -> None:
        self._make = make
        self._send = send
        # That of the request: it is told once, where it is declared.
        self.__doc__ = make.__doc__

    @overload
    def __get__(self, client: None, owner: type) -> Self: ...
    @overload
    def __get__(self, client: Blocking, owner: type) -> Callable[P, V]: ...
    @overload
    def __get__(self, client: Awaiting, owner: type) -> Callable[P, Coroutine[Any, Any, V]]: ...
    def __get__(self, client: Blocking | Awaiting | None, owner: type) -> Any:
        """Return the method of this client."""
        if client is None:
            return self

        @wraps(self._make)
        def method(*arguments: P.args, **named: P.kwargs) -> V | Awaitable[V]:
            return cast("V | Awaitable[V]", self._send(client, self._make(*arguments, **named)))

        return method


def asks(make: Callable[P, Request[A]], value: Callable[[A], V]) -> Method[P, V]:
    """Return the method that sends one request."""
    return Method(make, lambda client, request: client.ask(request, value))


def asks_in_turn(make: Callable[P, Iterable[Request[A]]], value: Callable[[A], V]) -> Method[P, V]:
    """Return the method that sends several requests, of which the last one's answer counts."""
    return Method(make, lambda client, requests: client.ask_in_turn(requests, value))


def carries_out(make: Callable[P, Mission], value: Callable[[list[MissionEvent]], V]) -> Method[P, V]:
    """Return the method that runs a mission to its end."""
    return Method(make, lambda client, mission: client.carry_out(mission, value))


def _all(answer: A) -> A:
    return answer


def _nothing(_: object) -> None:
    return None


class Methods:
    """Whatever a client can be asked in one call."""

    hello = asks(Hello, _all)
    status = asks(GetStatus, _all)
    config = asks(GetConfig, lambda answer: answer.text)
    metrics = asks(GetMetrics, _all)
    arm = asks(Arm, _nothing)
    disarm = asks(Disarm, _nothing)
    stop = asks(Stop.because, _nothing)
    clear = asks(Clear, _nothing)
    start = asks(with_lease, _all)
    renew = asks(Renew, _all)
    make_map = carries_out(MapStart.of, _all)
    continue_map = carries_out(MapContinue.of, _all)
    explore = carries_out(Explore.of, _all)
    localize = carries_out(Localize, final_estimate)
    resolve = carries_out(Resolve, final_estimate)
    drive_to = carries_out(DriveTo, _all)
    drive = carries_out(DriveStraight, _all)
    turn = carries_out(Turn, _all)
    look = carries_out(Look, _all)
    measure = carries_out(Measure, ranges_measured)
    scan = carries_out(Scan, last_sweep)
    map_save = asks(MapSave, _all)
    map_load = asks(MapLoad.of, _all)
    map_discard = asks(MapDiscard, _nothing)
    map_list = asks(ListMaps, lambda answer: answer.maps)
    map_show = asks(MapShow, _all)
    map_delete = asks(MapDelete, _nothing)
    map_rename = asks(MapRename, _nothing)
    map_import = asks_in_turn(MapImport.parts, lambda answer: answer.map)
    plan_to = asks(PlanTo, _all)
    record_start = asks(RecordStart, lambda answer: answer.path)
    record_stop = asks(RecordStop, lambda answer: answer.path)
    record_list = asks(ListRecordings, _all)
    record_delete = asks(RecordDelete, _nothing)
