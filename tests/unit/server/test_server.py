"""The server on real sockets: late joiners, slow readers, garbage, neighbours."""

import asyncio
import contextlib
import logging
import os
import stat
import subprocess
import sys
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgpack
import numpy as np
import pytest
import zmq
import zmq.asyncio

from robotd.client import AsyncClient, AsyncSubscription
from robotd.client.feed import Gap
from robotd.contract.envelope import decode_reply, encode_request
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import MapChanged, MissionPhase, MissionProgress, Status
from robotd.contract.requests import GetStatus, Hello
from robotd.contract.topics import LogEntry, Topic
from robotd.core.clock import now_ns
from robotd.core.endpoints import Endpoints
from robotd.core.errors import ServerError, TransportError
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry
from robotd.server.server import Server
from robotd.server.settings import ServerSettings

pytestmark = pytest.mark.real_clock
Serving = Callable[..., AbstractAsyncContextManager[Any]]


@contextlib.asynccontextmanager
async def raw_socket(kind: int, endpoint: str) -> AsyncIterator[zmq.asyncio.Socket]:
    context = zmq.asyncio.Context()
    socket = context.socket(kind)
    socket.connect(endpoint)
    try:
        yield socket
    finally:
        context.destroy(linger=0)


async def ask(socket: zmq.asyncio.Socket, data: bytes) -> Any:
    await socket.send(data)
    return decode_reply(await asyncio.wait_for(socket.recv(), 2)).result


async def take(events: AsyncSubscription, count: int) -> list[Any]:
    found = [await events.next(2) for _ in range(count)]
    assert None not in found
    return found


async def quiet(events: AsyncSubscription, for_s: float = 0.1) -> bool:
    return await events.next(for_s) is None


async def test_who_joins_late_is_told_the_last_of_each_topic(
    serving: Serving, tmp_path: Path, make_estimate: Callable[..., PoseEstimate]
) -> None:
    async with serving() as control, AsyncClient(tmp_path) as client:
        for time_ns in (1, 2, 3):
            control.events.publish(make_estimate(PoseState.LOCALIZED, time_ns))
        await client.hello()
        with client.subscribe("pose", "status") as events:
            pose, status = sorted(await take(events, 2), key=lambda event: type(event).__name__)
            assert pose == make_estimate(PoseState.LOCALIZED, 3)
            assert isinstance(status, Status)
            control.events.publish(make_estimate(PoseState.LOST, 4))
            assert await take(events, 1) == [make_estimate(PoseState.LOST, 4)]


async def test_what_was_published_while_the_server_began_is_told_too(
    make_control: Callable[[], Any], tmp_path: Path, make_estimate: Callable[..., PoseEstimate]
) -> None:
    """The robot says at once that it does not know where it is: before the first reader can be there."""
    control = make_control()
    server = Server(ServerSettings(runtime_dir=str(tmp_path)), control)
    serving = asyncio.create_task(server.run())
    asyncio.get_running_loop().call_soon(control.events.publish, make_estimate(PoseState.LOST))
    async with AsyncClient(tmp_path) as client:
        with client.subscribe("pose") as events:
            assert await take(events, 1) == [make_estimate(PoseState.LOST)]
    serving.cancel()
    await asyncio.wait((serving,))


async def test_another_ones_joining_tells_nobody_twice(serving: Serving, tmp_path: Path) -> None:
    async with serving(), AsyncClient(tmp_path) as client:
        with client.subscribe("status") as first:
            await take(first, 1)
            with client.subscribe("status") as second:
                await take(second, 1)
                assert await quiet(first)


async def test_a_plain_prefix_subscription_gets_the_last_values_too(serving: Serving, tmp_path: Path) -> None:
    async with serving(), raw_socket(zmq.SUB, Endpoints(tmp_path).state) as socket:
        socket.subscribe(b"sta")
        frame = await asyncio.wait_for(socket.recv(), 2)
        topic, _, packed = frame.partition(b"\0")
        fields = msgpack.unpackb(packed)
        assert (topic, fields["event"], fields["battery_v"]) == (b"status", "status", 24.5)


async def test_a_conflating_reader_gets_the_newest(
    serving: Serving, tmp_path: Path, make_estimate: Callable[..., PoseEstimate]
) -> None:
    async with serving() as control, AsyncClient(tmp_path) as client:
        context = zmq.asyncio.Context()
        socket = context.socket(zmq.SUB)
        socket.setsockopt(zmq.CONFLATE, 1)
        socket.subscribe(b"pose\0")
        socket.connect(Endpoints(tmp_path).state)
        with client.subscribe("pose") as events:
            control.events.publish(make_estimate(PoseState.LOST, 0))
            await take(events, 1)
            for time_ns in range(1, 50):
                control.events.publish(make_estimate(PoseState.LOST, time_ns))
            await take(events, 49)
            await asyncio.sleep(0.05)
        fields = msgpack.unpackb((await asyncio.wait_for(socket.recv(), 2)).partition(b"\0")[2])
        assert fields["time_ns"] == 49
        context.destroy(linger=0)


async def test_a_slow_reader_loses_messages_and_is_told_so(
    serving: Serving, tmp_path: Path, make_estimate: Callable[..., PoseEstimate]
) -> None:
    async with serving(state_queue=5) as control, AsyncClient(tmp_path) as client:
        with client.subscribe("log") as events:
            events._socket.setsockopt(zmq.RCVHWM, 5)
            events._socket.disconnect(Endpoints(tmp_path).state)
            events._socket.connect(Endpoints(tmp_path).state)
            logging.getLogger("robotd").warning("first")
            found = [await events.next(2)]
            while not isinstance(found[-1], LogEntry):
                logging.getLogger("robotd").warning("first")
                found.append(await events.next(2))
            for _ in range(20):
                for _ in range(150):
                    logging.getLogger("robotd").warning("x" * 2000)
                await client.hello()
            logging.getLogger("robotd").warning("last")
            received: list[Any] = []
            while (event := await events.next(0.3)) is not None:
                received.append(event)
            logging.getLogger("robotd").warning("after")
            while (event := await events.next(0.3)) is not None:
                received.append(event)
        gaps = [event for event in received if isinstance(event, Gap)]
        lines = [event for event in received if isinstance(event, LogEntry)]
        assert gaps
        assert len(lines) + sum(gap.missed or 0 for gap in gaps) == 3002
        assert lines[-1].message == "after"
        assert control.calls == []


async def test_a_reader_who_chokes_on_maps_misses_no_status(
    serving: Serving, tmp_path: Path, make_map: Callable[..., MapChanged]
) -> None:
    async with serving(map_queue=1) as control, AsyncClient(tmp_path) as client:
        big = GridSpec(0.05, 0.0, 0.0, (800, 800))
        control.map_in_use = make_map(0, spec=big)
        with client.subscribe("map") as maps, client.subscribe("mission") as missions:
            assert isinstance((await take(maps, 1))[0], MapChanged)
            for generation in range(1, 31):
                control.events.publish(replace(control.map_in_use, generation=generation))
                control.events.publish(MissionProgress(1, generation, "map", MissionPhase.DRIVING, 0, 1))
                await client.hello()
            progress = await take(missions, 30)
            assert [event.mission_id for event in progress] == list(range(1, 31))


async def test_map_readers_get_the_whole_map_then_its_changes(
    serving: Serving, tmp_path: Path, make_map: Callable[..., MapChanged]
) -> None:
    async with serving() as control, AsyncClient(tmp_path) as client:
        control.map_in_use = make_map(4)
        with client.subscribe("map") as maps:
            (whole,) = await take(maps, 1)
            np.testing.assert_array_equal(whole.values, control.map_in_use.values)
            assert (whole.generation, whole.spec) == (4, control.map_in_use.spec)
            cells, values = np.array([3, 2399], dtype=np.intp), np.array([9, 255], dtype=np.uint8)
            control.events.publish(replace(whole, generation=5, whole=False, cells=cells, values=values))
            (changed,) = await take(maps, 1)
            assert (changed.cells.tolist(), changed.values.tolist()) == ([3, 2399], [9, 255])
            assert (changed.whole, changed.generation) == (False, 5)


async def test_without_a_map_its_readers_are_told_so(serving: Serving, tmp_path: Path) -> None:
    async with serving(), AsyncClient(tmp_path) as client:
        with client.subscribe("map") as maps:
            (change,) = await take(maps, 1)
            assert change.map_id is None
            assert await quiet(maps)
        with pytest.raises(ServerError, match="not_found"):
            await client.map_show()


async def test_odometry_is_published_at_a_bearable_rate(serving: Serving, tmp_path: Path) -> None:
    async with serving() as control, AsyncClient(tmp_path) as client:
        with client.subscribe("odometry", "status") as events:
            await take(events, 1)
            for number in range(200):
                control.events.publish(Odometry(number * 5_000_000, IDENTITY, STANDSTILL))
            assert [event.time_ns // 1_000_000 for event in await take(events, 20)] == list(range(0, 1000, 50))
            assert await quiet(events)


GARBAGE = [b"", b"\xff" * 100, b"\x91" * 60000, b"\xdd\xff\xff\xff\xff", os.urandom(500)]


async def test_garbage_is_answered_and_the_daemon_goes_on(serving: Serving, tmp_path: Path) -> None:
    async with serving(), raw_socket(zmq.DEALER, Endpoints(tmp_path).commands) as socket:
        for data in GARBAGE:
            error = await ask(socket, data)
            assert isinstance(error, ServerError)
            assert error.code == "malformed"
        nan = msgpack.packb({"v": 1, "id": 1, "cmd": "localize", "args": {"heading_rad": float("nan")}})
        assert (await ask(socket, nan)).code == "bad_argument"
        assert (await ask(socket, b"x" * 70_000)).code == "too_large"
        await socket.send_multipart([b"a", b"b", b"c"])
        assert isinstance(decode_reply(await asyncio.wait_for(socket.recv(), 2)).result, ServerError)
        assert "robotd" in await ask(socket, encode_request(2, Hello()))


async def test_a_flood_beyond_all_limits_is_cut_off_and_others_are_served(serving: Serving, tmp_path: Path) -> None:
    async with serving(), raw_socket(zmq.DEALER, Endpoints(tmp_path).commands) as socket:
        assert "robotd" in await ask(socket, encode_request(1, Hello()))
        await socket.send(b"x" * 1_000_000)
        async with AsyncClient(tmp_path) as client:
            assert (await client.hello()).versions == (1,)


async def test_bytes_that_are_no_zeromq_harm_nobody(serving: Serving, tmp_path: Path) -> None:
    async with serving(), AsyncClient(tmp_path) as client:
        for path in Endpoints(tmp_path).paths:
            for data in (b"GET / HTTP/1.1\r\n\r\n", b"\0" * 100, os.urandom(1000)):
                _, writer = await asyncio.open_unix_connection(str(path))
                writer.write(data)
                with contextlib.suppress(ConnectionError):
                    await writer.drain()
                writer.close()
                with contextlib.suppress(ConnectionError):
                    await writer.wait_closed()
        assert (await client.hello()).versions == (1,)


async def test_a_plain_req_socket_is_served(serving: Serving, tmp_path: Path) -> None:
    async with serving(), raw_socket(zmq.REQ, Endpoints(tmp_path).commands) as socket:
        for number in (1, 2):
            assert (await ask(socket, encode_request(number, GetStatus())))["mode"] == "disarmed"


def names_in(directory: Path) -> list[str]:
    return sorted(path.name for path in directory.iterdir())


def mode_of(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def unreached_control() -> Any:
    """Return a control that is never reached."""
    return object()


async def test_the_sockets_of_a_killed_server_are_replaced(serving: Serving, tmp_path: Path) -> None:
    script = (
        "import os, socket, sys\n"
        "for name in ('commands', 'state', 'maps'):\n"
        "    socket.socket(socket.AF_UNIX).bind(f'{sys.argv[1]}/{name}.sock')\n"
        "os.kill(os.getpid(), 9)\n"
    )
    await asyncio.to_thread(subprocess.run, [sys.executable, "-c", script, str(tmp_path)], check=False)
    assert names_in(tmp_path) == ["commands.sock", "maps.sock", "state.sock"]
    async with serving(), AsyncClient(tmp_path) as client:
        assert (await client.hello()).versions == (1,)
    assert names_in(tmp_path) == []


async def test_sockets_are_for_the_group_only(serving: Serving, tmp_path: Path) -> None:
    async with serving():
        modes = [mode_of(path) for path in Endpoints(tmp_path).paths]
    assert modes == [0o770] * 3


def test_a_path_too_long_for_a_socket_is_refused_at_once(tmp_path: Path) -> None:
    with pytest.raises(TransportError, match="107"):
        Server(ServerSettings(runtime_dir=str(tmp_path / ("x" * 100))), unreached_control())


async def test_what_stands_in_a_sockets_place_is_named(make_control: Any, tmp_path: Path) -> None:
    (tmp_path / "state.sock").mkdir()
    server = Server(ServerSettings(runtime_dir=str(tmp_path)), make_control())
    with pytest.raises(TransportError, match=r"state.sock: cannot be removed: Is a directory"):
        await server.run()


async def test_a_restart_shows_as_a_gap_and_clients_stay(serving: Serving, tmp_path: Path) -> None:
    async with AsyncClient(tmp_path, retry_s=0.05) as client:
        with client.subscribe("status") as events:
            async with serving():
                first = await client.hello()
                await take(events, 1)
            async with serving():
                second = await client.hello()
                assert await take(events, 1) == [Gap("status", None)]
                assert isinstance((await take(events, 1))[0], Status)
    assert first.session != second.session


async def test_the_log_has_a_topic(serving: Serving, tmp_path: Path) -> None:
    async with serving(), AsyncClient(tmp_path) as client:
        with client.subscribe("log", "status") as events:
            await take(events, 1)
            logging.getLogger("robotd.mission").warning("a bumper was hit")
            (line,) = await take(events, 1)
    assert (line.level, line.logger, line.message) == ("WARNING", "robotd.mission", "a bumper was hit")


async def test_hello_ties_the_clocks(serving: Serving, tmp_path: Path) -> None:
    async with serving(lease_s=0.7), AsyncClient(tmp_path) as client:
        before_ns = now_ns()
        hello = await client.hello()
        assert before_ns <= hello.time_ns <= now_ns()
        assert hello.lease_s == 0.7


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("runtime_dir", ""),
        ("lease_s", 0.01),
        ("lease_s", float("nan")),
        ("routine_hz", 0.0),
        ("max_request_bytes", 10),
        ("max_pending_requests", 0),
        ("remembered_replies", 0),
        ("state_queue", 0),
        ("map_queue", 0),
    ],
)
def test_impossible_settings_are_refused_by_name(key: str, value: Any) -> None:
    with pytest.raises(ValueError, match=key):
        ServerSettings(**{key: value})


def test_topics_are_the_ones_promised() -> None:
    assert [*Topic] == ["pose", "odometry", "sweep", "map", "mission", "rank", "status", "log"]
