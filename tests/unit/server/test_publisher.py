"""What goes wrong on the way of an event to its readers concerns that event alone."""

import asyncio
import errno
import logging
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any

import pytest

from robotd.client.feed import Feed, Gap
from robotd.contract.events import MapChanged, StopPlaced, SweepDone, SweepProgress
from robotd.contract.request import Request
from robotd.contract.requests import GetStatus, MapShow
from robotd.contract.topics import Frame, Topic
from robotd.core.counted import Counted
from robotd.core.errors import LinkTimeout
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry
from robotd.core.reading import Sweep
from robotd.server.client_connection import PeerProcess
from robotd.server.publisher import Publisher
from robotd.server.zmtp import GREETING, Reader, ready
from robotd.server.zmtp import Message as Sent

ERRORS = [OSError(errno.ENOMEM, "Out of memory"), MemoryError(), RuntimeError("can't start new thread")]


class AConnection:
    """Takes all that is sent."""

    process = PeerProcess(1, 2)

    def __init__(self) -> None:
        self.sent: list[Frame] = []
        self._reader = Reader(longest_bytes=2**20, most_frames=1)
        assert len(list(self._reader.feed(GREETING + ready(b"XPUB")))) == 1

    def send(self, data: bytes) -> bool:
        for said in self._reader.feed(data):
            assert isinstance(said, Sent)
            self.sent.append(Frame.of(said.frames[0]))
        return True

    def events(self, topic: Topic) -> list[Any]:
        return [message.published for message in self.sent if message.topic == topic]

    @property
    def generations(self) -> list[int]:
        """Of maps; that none is in use, as who joins is told, is of none."""
        return [event.generation for event in self.events(Topic.MAP) if event.map_id is not None]


@asynccontextmanager
async def published(control: Any) -> AsyncIterator[tuple[asyncio.Task[None], AConnection, AConnection, Publisher]]:
    with control.events.subscribe(100) as events:
        publisher = Publisher(control, events, "session", Counted())
        state, maps = AConnection(), AConnection()
        for outlet, connection in ((publisher.state, state), (publisher.maps, maps)):
            outlet.joined(connection)  # type: ignore[arg-type]  # what it uses of it
            outlet.heard(connection, (b"\x01",))  # type: ignore[arg-type]  # as above
        task = asyncio.create_task(publisher.run())
        try:
            yield task, state, maps, publisher
        finally:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)


async def test_an_event_that_has_no_form_on_the_wire_is_dropped_and_logged(
    make_control: Any, make_map: Callable[..., MapChanged], caplog: pytest.LogCaptureFixture
) -> None:
    control = make_control()
    broken = make_map(1)
    object.__setattr__(broken, "spec", None)
    async with published(control) as (task, state, maps, _):
        control.events.publish(Odometry(2**70, IDENTITY, STANDSTILL))
        control.events.publish(broken)
        await asyncio.sleep(1)
        control.events.publish(Odometry(1, IDENTITY, STANDSTILL))
        control.events.publish(make_map(2))
        await asyncio.sleep(1)
        assert not task.done()
        assert [event.time_ns for event in state.events(Topic.ODOMETRY)] == [1]
        assert maps.generations == [2]
    assert "Odometry was not published" in caplog.text
    assert "MapChanged was not published" in caplog.text


@pytest.mark.parametrize("error", [*ERRORS, LinkTimeout("silent")], ids=repr)
@pytest.mark.parametrize("request_type", [GetStatus, MapShow])
async def test_a_request_of_its_own_that_fails_does_not_end_what_publishes(
    make_control: Any, make_map: Callable[..., MapChanged], request_type: type[Request[Any]], error: Exception
) -> None:
    control = make_control()
    control.map_in_use = make_map(1)
    answer = control.perform

    async def fail(request: Request[Any]) -> Any:
        if isinstance(request, request_type):
            raise error
        return await answer(request)

    control.perform = fail
    async with published(control) as (task, state, maps, publisher):
        await asyncio.sleep(1)
        control.events.publish(Odometry(1, IDENTITY, STANDSTILL))
        await asyncio.sleep(1)
        control.perform = answer
        publisher.maps.heard(maps, (b"\x01map\0",))  # type: ignore[arg-type]  # what it uses of it
        await asyncio.sleep(1)
        assert not task.done()
        assert state.events(Topic.ODOMETRY)
        assert maps.events(Topic.MAP)


@pytest.mark.parametrize("error", ERRORS, ids=repr)
async def test_a_map_that_cannot_be_packed_now_does_not_end_what_publishes(
    make_control: Any,
    make_map: Callable[..., MapChanged],
    monkeypatch: pytest.MonkeyPatch,
    error: Exception,
    caplog: pytest.LogCaptureFixture,
) -> None:
    async def fail(*_: object) -> bytes:
        raise error

    control = make_control()
    async with published(control) as (task, _, maps, _):
        await asyncio.sleep(1)
        with monkeypatch.context() as broken:
            broken.setattr(asyncio, "to_thread", fail)
            control.events.publish(make_map(1))
            await asyncio.sleep(1)
        control.events.publish(make_map(2))
        await asyncio.sleep(1)
        assert not task.done()
        assert maps.generations == [2]
    assert [record.levelno for record in caplog.records] == [logging.ERROR]


async def test_who_joins_hears_the_last_of_each_event_and_a_reader_misses_nothing(make_control: Any) -> None:
    control = make_control()
    sweep = Sweep(3, IDENTITY, ())
    async with published(control) as (_, _, _, publisher):
        for event in (
            SweepDone(1, sweep),
            SweepProgress(2, 4, 10, 300, 10, 0, 0),
            SweepProgress(3, 4, 20, 300, 20, 0, 0),
            Odometry(4, IDENTITY, STANDSTILL),
        ):
            control.events.publish(event)
        await asyncio.sleep(1)
        late = AConnection()
        publisher.state.joined(late)  # type: ignore[arg-type]  # what it uses of it
        publisher.state.heard(late, (b"\x01sweep\0",))  # type: ignore[arg-type]  # as above
        publisher.state.heard(late, (b"\x01status\0",))  # type: ignore[arg-type]  # as above
        await asyncio.sleep(1)
        control.events.publish(SweepProgress(5, 4, 30, 300, 30, 0, 0))
        await asyncio.sleep(1)
    assert [frame.event for frame in late.sent] == ["sweep_progress", "sweep_done", "status", "sweep_progress"]
    assert late.sent[0].seq > late.sent[1].seq
    feed = Feed()
    heard = [item for frame in late.sent for item in feed.accept(frame.data)]
    assert [item.time_ns for item in heard if isinstance(item, SweepDone | SweepProgress)] == [3, 1, 5]
    assert not any(isinstance(item, Gap) for item in heard)


async def test_what_is_told_of_stops_goes_where_maps_go_in_one_order(
    make_control: Any, make_map: Callable[..., MapChanged]
) -> None:
    control = make_control()
    placed = StopPlaced(7, "m", 3, "placed", IDENTITY, 0.0, 0.0, 1.0, 0.0)
    async with published(control) as (_, state, maps, _):
        await asyncio.sleep(1)
        for event in (make_map(2), placed, make_map(3)):
            control.events.publish(event)
            await asyncio.sleep(1)
    assert state.events(Topic.MAP) == []
    assert [frame.event for frame in maps.sent[-3:]] == ["map_changed", "stop_placed", "map_changed"]
    assert [frame.seq for frame in maps.sent] == list(range(len(maps.sent)))


async def test_who_joins_while_no_map_is_in_use_is_told_so(make_control: Any) -> None:
    async with published(make_control()) as (_, _, maps, _):
        await asyncio.sleep(1)
    (change,) = maps.events(Topic.MAP)
    assert (change.map_id, change.whole) == (None, True)


async def test_what_is_costly_is_asked_for_while_somebody_reads_it(make_control: Any) -> None:
    control = make_control()
    async with published(control) as (_, state, _, publisher):
        # Who reads everything reads that, too.
        for said in (None, b"\x00", b"\x01rank\0", None, b"\x00rank\0"):
            if said is not None:
                publisher.state.heard(state, (said,))  # type: ignore[arg-type]  # what it uses of it
            control.events.publish(control.status)
            await asyncio.sleep(1)
    assert control.watched == [{Topic.RANK}, set(), {Topic.RANK}, set()]
