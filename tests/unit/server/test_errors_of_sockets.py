"""Each call of the tasks that publish may fail, in every way a socket has, and they live on."""

import asyncio
import errno
import os
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any

import pytest
import zmq

from robotd.contract.events import MapChanged
from robotd.contract.request import Request
from robotd.contract.requests import GetStatus, MapShow
from robotd.contract.topics import Topic, decode_frame
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry
from robotd.server.outlet import Outlet
from robotd.server.publisher import Publisher

NUMBERS = [errno.EAGAIN, errno.EMFILE, errno.ENOTSUP, errno.EHOSTUNREACH, errno.EINTR, errno.ENOMEM]
ERRORS = [
    *map(zmq.ZMQError, NUMBERS),
    *(OSError(number, os.strerror(number)) for number in (errno.EMFILE, errno.ENOSPC, errno.EACCES)),
    RuntimeError("a bug in the daemon"),
]


class Flaky:
    """An XPUB socket whose every call fails the first time."""

    closed = False

    def __init__(self, error: Exception) -> None:
        self.sent: list[bytes] = []
        self.joins: asyncio.Queue[bytes] = asyncio.Queue()
        self.failures = {"send": 1, "recv": 1, "recv at once": 1}
        self._error = error

    async def send(self, frame: bytes) -> None:
        self._fail("send")
        self.sent.append(frame)

    async def recv(self, flags: int = 0) -> bytes:
        self._fail("recv at once" if flags else "recv")
        if flags and self.joins.empty():
            raise zmq.Again
        return await self.joins.get()

    def _fail(self, call: str) -> None:
        if self.failures[call]:
            self.failures[call] -= 1
            raise self._error

    def events(self, topic: Topic) -> list[Any]:
        return [message.event for message in map(decode_frame, self.sent) if message.topic == topic]


@asynccontextmanager
async def published(control: Any, state: Flaky, maps: Flaky) -> AsyncIterator[asyncio.Task[None]]:
    with control.events.subscribe(100) as events:
        outlets = [Outlet(socket, "session") for socket in (state, maps)]  # type: ignore[arg-type]  # what they use of it
        task = asyncio.create_task(Publisher(control, events, *outlets).run())
        try:
            yield task
        finally:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)


@pytest.mark.parametrize("error", ERRORS, ids=repr)
async def test_no_error_of_a_socket_ends_what_publishes(
    make_control: Any, make_map: Callable[..., MapChanged], error: Exception
) -> None:
    control, state, maps = make_control(), Flaky(error), Flaky(error)
    control.map_in_use = make_map(1)
    async with published(control, state, maps) as task:
        for socket in (state, maps):
            socket.joins.put_nowait(b"\x01")
        for time_ns in (1, 10**9):
            control.events.publish(Odometry(time_ns, IDENTITY, STANDSTILL))
            await asyncio.sleep(1)
        for socket in (state, maps):
            socket.joins.put_nowait(b"\x01")
        await asyncio.sleep(1)
        assert not task.done()
    assert state.events(Topic.ODOMETRY)
    assert maps.events(Topic.MAP)
    assert not any(state.failures.values())


async def test_an_event_that_has_no_form_on_the_wire_is_dropped_and_logged(
    make_control: Any, make_map: Callable[..., MapChanged], caplog: pytest.LogCaptureFixture
) -> None:
    control, state, maps = make_control(), Flaky(ERRORS[0]), Flaky(ERRORS[0])
    state.failures = maps.failures = dict.fromkeys(state.failures, 0)
    broken = make_map(1)
    object.__setattr__(broken, "spec", None)
    async with published(control, state, maps) as task:
        control.events.publish(Odometry(2**70, IDENTITY, STANDSTILL))
        control.events.publish(broken)
        await asyncio.sleep(1)
        control.events.publish(Odometry(1, IDENTITY, STANDSTILL))
        control.events.publish(make_map(2))
        await asyncio.sleep(1)
        assert not task.done()
    assert [event.time_ns for event in state.events(Topic.ODOMETRY)] == [1]
    assert [event.generation for event in maps.events(Topic.MAP)] == [2]
    assert "Odometry was not published" in caplog.text
    assert "MapChanged was not published" in caplog.text


@pytest.mark.parametrize("error", ERRORS, ids=repr)
@pytest.mark.parametrize("request_type", [GetStatus, MapShow])
async def test_a_request_of_its_own_that_fails_does_not_end_what_publishes(
    make_control: Any,
    make_map: Callable[..., MapChanged],
    caplog: pytest.LogCaptureFixture,
    request_type: type[Request[Any]],
    error: Exception,
) -> None:
    control, state, maps = make_control(), Flaky(error), Flaky(error)
    state.failures = maps.failures = dict.fromkeys(state.failures, 0)
    control.map_in_use = make_map(1)
    answer = control.perform

    async def fail(request: Request[Any]) -> Any:
        if isinstance(request, request_type):
            raise error
        return await answer(request)

    control.perform = fail
    async with published(control, state, maps) as task:
        maps.joins.put_nowait(b"\x01")
        await asyncio.sleep(1)
        control.events.publish(Odometry(1, IDENTITY, STANDSTILL))
        await asyncio.sleep(1)
        control.perform = answer
        maps.joins.put_nowait(b"\x01")
        await asyncio.sleep(1)
        assert not task.done()
    assert state.events(Topic.ODOMETRY)
    assert maps.events(Topic.MAP)
    assert len([line for line in caplog.messages if "was not published" in line]) == 1


async def test_a_socket_that_was_closed_ends_what_uses_it() -> None:
    socket = Flaky(zmq.ZMQError(errno.ENOTSOCK))
    socket.closed = True
    with pytest.raises(zmq.ZMQError):
        await Outlet(socket, "session").joined()  # type: ignore[arg-type]  # what it uses of it
