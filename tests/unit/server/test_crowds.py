"""Clients that take too much: cut off, counted and said; the others are served."""

import asyncio
import contextlib
import os
import socket
import subprocess
import sys
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager
from pathlib import Path
from typing import Any

import pytest

from robotd.client import AsyncClient
from robotd.contract.envelope import encode_request
from robotd.contract.requests import GetStatus, MapShow, Stop
from robotd.core.grid_spec import GridSpec
from robotd.server.client_connection import Connection, Manners, process_of
from robotd.server.door import MOST, MOST_OF_A_PROCESS, Door
from robotd.server.outlet import MOST_SUBSCRIPTIONS
from robotd.server.zmtp import GREETING, message, ready
from tests.unit.server.conftest import FakeControl

pytestmark = pytest.mark.real_clock
Serving = Callable[..., AbstractAsyncContextManager[FakeControl]]


@contextlib.asynccontextmanager
async def raw(path: Path, kind: bytes = b"") -> AsyncIterator[tuple[asyncio.StreamReader, asyncio.StreamWriter]]:
    reader, writer = await asyncio.open_unix_connection(path)
    if kind:
        writer.write(GREETING + ready(kind))
    try:
        yield reader, writer
    finally:
        writer.close()
        with contextlib.suppress(OSError):
            await writer.wait_closed()


async def is_cut_off(reader: asyncio.StreamReader, writer: asyncio.StreamWriter, data: bytes) -> None:
    with contextlib.suppress(OSError):
        writer.write(data)
        await writer.drain()
    async with asyncio.timeout(60.0):
        with contextlib.suppress(OSError):
            while await reader.read(65536):
                """What it was sent before."""


async def others_are_served(runtime_dir: Path) -> None:
    async with AsyncClient(runtime_dir, deadline_s=30.0) as client:
        assert (await client.status()).reason == "fake"


@pytest.mark.parametrize(
    ("name", "kind", "data", "complaint"),
    [
        ("state.sock", b"SUB", b"".join(message(b"\x01topic %d" % n) for n in range(120_000)), "64 subscriptions"),
        ("maps.sock", b"SUB", message(b"\x01" + b"x" * 75_000_000), "a message of 75000001 bytes"),
        ("state.sock", b"SUB", message(b"hello"), "no subscription"),
        ("commands.sock", b"DEALER", b"\x01\x01x" * 2_000_000, "more than 16 frames"),
        ("commands.sock", b"DEALER", b"\x02" + (2**40).to_bytes(8, "big"), "a message of 1099511627776 bytes"),
        ("commands.sock", b"SUB", b"", "a socket of type b'SUB'"),
        ("commands.sock", b"", b"GET / HTTP/1.1\r\n\r\n", "does not speak ZeroMQ"),
    ],
)
async def test_who_sends_too_much_or_nonsense_is_cut_off_and_others_are_served(
    serving: Serving,
    tmp_path: Path,
    caplog: pytest.LogCaptureFixture,
    name: str,
    kind: bytes,
    data: bytes,
    complaint: str,
) -> None:
    async with serving():
        async with raw(tmp_path / name, kind) as (reader, writer):
            await is_cut_off(reader, writer, data)
        await others_are_served(tmp_path)
    assert complaint in caplog.text
    assert f"a client (uid {os.getuid()}, pid {os.getpid()}) was cut off" in caplog.text


async def test_a_stop_in_too_many_frames_is_obeyed_before_its_client_is_cut_off(
    serving: Serving, tmp_path: Path
) -> None:
    async with serving() as control:
        control.armed = True
        stop = encode_request(1, Stop("enough"))
        async with raw(tmp_path / "commands.sock", b"DEALER") as (reader, writer):
            await is_cut_off(reader, writer, b"\x01" + bytes((len(stop),)) + stop + b"\x01\x01x" * 100)
        await others_are_served(tmp_path)
        assert not control.armed


async def test_a_program_that_stops_the_robot_and_ends_is_obeyed(serving: Serving, tmp_path: Path) -> None:
    async with serving() as control:
        control.armed = True
        asks = b"".join(
            message(encode_request(number, GetStatus())) for number in range(2000)
        )  # more than is read at once
        async with raw(tmp_path / "commands.sock", b"DEALER") as (_, writer):
            writer.write(asks + message(encode_request(9999, Stop("enough"))))
        await others_are_served(tmp_path)
        async with asyncio.timeout(60.0):
            await control.halted.wait()


FLOOD_OF_CONNECTIONS = """
import socket, sys, time
ends = []
for _ in range(int(sys.argv[2])):
    end = socket.socket(socket.AF_UNIX)
    end.connect(sys.argv[1])
    ends.append(end)
print("connected", flush=True)
sys.stdin.read()
"""


@contextlib.asynccontextmanager
async def connections(path: Path, count: int) -> AsyncIterator[None]:
    """Another program that connects so often, and says nothing."""
    words = (sys.executable, "-c", FLOOD_OF_CONNECTIONS, str(path), str(count))
    program = await asyncio.to_thread(subprocess.Popen, words, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    with program:
        assert program.stdout is not None
        try:
            await asyncio.to_thread(program.stdout.readline)
            yield
        finally:
            program.kill()


def open_sockets() -> int:
    return sum("socket" in str(link.readlink()) for link in Path("/proc/self/fd").iterdir() if link.is_symlink())


async def test_a_thousand_connections_of_one_process_are_brought_down_to_its_share(
    serving: Serving, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    async with serving(), AsyncClient(tmp_path, deadline_s=30.0) as before:
        await before.hello()
        async with connections(tmp_path / "state.sock", 1050):
            await others_are_served(tmp_path)
            await before.hello()
            assert open_sockets() < MOST_OF_A_PROCESS + 50
    assert f"its process has more than {MOST_OF_A_PROCESS} connections" in caplog.text


async def test_a_full_house_turns_out_who_has_most(tmp_path: Path) -> None:
    class Nobody:
        def joined(self, connection: Connection) -> None: ...
        def heard(self, connection: Connection, frames: tuple[bytes, ...]) -> None: ...
        def overheard(self, connection: Connection, frames: tuple[bytes, ...]) -> None: ...
        def left(self, connection: Connection) -> None: ...

    door = Door(most=5)
    door.open(tmp_path / "it.sock", Manners(b"ROUTER", frozenset({b"DEALER"}), 100, 1, 1, 100), Nobody())
    async with connections(tmp_path / "it.sock", 20), raw(tmp_path / "it.sock") as (reader, _):
        assert (await reader.readexactly(64))[:1] == b"\xff", "one that has none yet is let in"
        assert door.shown_out == 16
    door.close()
    assert MOST < 1024 / 2


async def test_who_takes_nothing_misses_it_and_costs_bounded_memory(
    serving: Serving, tmp_path: Path, make_map: Any
) -> None:
    """A client that asks for large maps and never reads its answers."""
    async with serving() as control:
        control.map_in_use = make_map(1, spec=GridSpec(0.05, 0.0, 0.0, (1000, 1000)))
        async with raw(tmp_path / "commands.sock", b"DEALER") as (_, writer):
            for number in range(12):
                writer.write(message(encode_request(number, MapShow())))
            await others_are_served(tmp_path)


async def test_no_descriptor_for_another_client_is_no_end(
    serving: Serving, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def fail(_: socket.socket) -> Any:
        raise OSError(24, "Too many open files")

    async with serving():
        with monkeypatch.context() as broken:
            broken.setattr(socket.socket, "accept", fail)
            async with raw(tmp_path / "state.sock"):
                await asyncio.sleep(0.3)
        await others_are_served(tmp_path)
    assert "a client could not be let in: Too many open files" in caplog.text


async def test_who_says_nothing_is_cut_off_after_a_while(
    serving: Serving, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("robotd.server.client_connection._GREETS_WITHIN_S", 0.05)
    async with serving(), raw(tmp_path / "state.sock") as (reader, writer):
        await is_cut_off(reader, writer, GREETING[:20])


async def test_subscriptions_may_be_ended_and_made_again_for_ever(serving: Serving, tmp_path: Path) -> None:
    async with serving(), raw(tmp_path / "state.sock", b"SUB") as (reader, writer):
        for number in range(10 * MOST_SUBSCRIPTIONS):
            writer.write(message(b"\x01topic %d" % number) + message(b"\x00topic %d" % number))
        writer.write(message(b"\x01status\0"))
        async with asyncio.timeout(60.0):
            await reader.readuntil(b"status\0")


def test_the_kernel_says_who_is_at_the_other_end() -> None:
    near, far = socket.socketpair()
    with near, far:
        assert process_of(near).pid == os.getpid()
        assert process_of(near).uid == os.getuid()
