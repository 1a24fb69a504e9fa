"""The methods of both clients, as one table: what each takes makes a request, what it returns is taken from the answer.

A method is sugar: ``client.arm()`` is ``client.call(Arm())``. A request without a line here can be sent all the same.
"""

from collections.abc import Awaitable, Callable, Coroutine
from functools import wraps
from typing import Any, Generic, ParamSpec, Self, TypeVar, overload

from robotd.client.mission_run import MissionEvent, final_estimate, last_sweep, ranges_measured
from robotd.contract.missions import (
    DriveStraight,
    DriveTo,
    Localize,
    Look,
    MapStart,
    Measure,
    Mission,
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
    GetStatus,
    Hello,
    ListMaps,
    MapDiscard,
    MapLoad,
    MapSave,
    MapShow,
    PlanTo,
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

    def carry_out(self, mission: Mission, value: Callable[[list[MissionEvent]], V]) -> V:
        """Run a mission to its end and return what is wanted of what happened."""
        raise NotImplementedError


class Awaiting:
    """A client whose calls are awaited."""

    async def ask(self, request: Request[A], value: Callable[[A], V]) -> V:
        """Send a request and return what is wanted of its answer."""
        raise NotImplementedError

    async def carry_out(self, mission: Mission, value: Callable[[list[MissionEvent]], V]) -> V:
        """Run a mission to its end and return what is wanted of what happened."""
        raise NotImplementedError


class Asks(Generic[P, A, V]):
    """A method that sends one request."""

    def __init__(self, make: Callable[P, Request[A]], value: Callable[[A], V]) -> None:
        self._make = make
        self._value = value
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
            return client.ask(self._make(*arguments, **named), self._value)

        return method


class CarriesOut(Generic[P, V]):
    """A method that runs a mission to its end."""

    def __init__(self, make: Callable[P, Mission], value: Callable[[list[MissionEvent]], V]) -> None:
        self._make = make
        self._value = value
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
            return client.carry_out(self._make(*arguments, **named), self._value)

        return method


def _all(answer: A) -> A:
    return answer


def _nothing(_: object) -> None:
    return None


class Methods:
    """Whatever a client can be asked in one call."""

    hello = Asks(Hello, _all)
    status = Asks(GetStatus, _all)
    config = Asks(GetConfig, lambda answer: answer.text)
    arm = Asks(Arm, _nothing)
    disarm = Asks(Disarm, _nothing)
    stop = Asks(Stop.because, _nothing)
    clear = Asks(Clear, _nothing)
    start = Asks(with_lease, _all)
    renew = Asks(Renew, _all)
    make_map = CarriesOut(MapStart.of, _all)
    localize = CarriesOut(Localize, final_estimate)
    drive_to = CarriesOut(DriveTo, _all)
    drive = CarriesOut(DriveStraight, _all)
    turn = CarriesOut(Turn, _all)
    look = CarriesOut(Look, _all)
    measure = CarriesOut(Measure, ranges_measured)
    scan = CarriesOut(Scan, last_sweep)
    map_save = Asks(MapSave, _all)
    map_load = Asks(MapLoad.of, _all)
    map_discard = Asks(MapDiscard, _nothing)
    map_list = Asks(ListMaps, lambda answer: answer.maps)
    map_show = Asks(MapShow, _all)
    plan_to = Asks(PlanTo, _all)
    record_start = Asks(RecordStart, lambda answer: answer.path)
    record_stop = Asks(RecordStop, lambda answer: answer.path)
