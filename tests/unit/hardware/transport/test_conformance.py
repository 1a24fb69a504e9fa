"""What every transport promises, over every transport."""

import asyncio
import itertools
import socket
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager, closing

import pytest

from robotd.core.errors import TransportError
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.transport.memory import memory_pair
from robotd.hardware.transport.outbox import OUTBOX_LIMIT_BYTES
from robotd.hardware.transport.pty import open_pty
from robotd.hardware.transport.serial_port import open_serial
from robotd.hardware.transport.tcp import open_tcp, tcp_transport
from robotd.hardware.transport.transport import Transport

Pair = tuple[Transport, Transport]


async def _memory() -> Pair:
    return memory_pair()


async def _serial() -> Pair:
    far = open_pty()
    return await open_serial(far.path, LineFormat(115200)), far


async def _pty() -> Pair:
    near, far = await _serial()
    return far, near


async def _tcp() -> Pair:
    with closing(socket.create_server(("127.0.0.1", 0))) as server:
        near = await open_tcp("127.0.0.1", server.getsockname()[1])
        accepted, _ = server.accept()
        return near, tcp_transport("accepted", accepted)


REAL = pytest.mark.real_clock
KINDS = [
    pytest.param(_memory, id="memory"),
    pytest.param(_serial, id="serial", marks=REAL),
    pytest.param(_tcp, id="tcp", marks=REAL),
]
Opener = Callable[[], Awaitable[Pair]]
every_transport = pytest.mark.parametrize("pair_of", [*KINDS, pytest.param(_pty, id="pty", marks=REAL)])
every_line_that_hangs_up = pytest.mark.parametrize("pair_of", KINDS)


def opened(pair_of: Opener) -> AbstractAsyncContextManager[Pair]:
    @asynccontextmanager
    async def both() -> AsyncIterator[Pair]:
        near, far = await pair_of()
        try:
            yield near, far
        finally:
            near.close()
            far.close()

    return both()


async def read_exactly(end: Transport, count: int) -> bytes:
    data = b""
    while len(data) < count:
        data += await end.read()
    return data


def fill(end: Transport) -> int:
    """Write until it refuses; return how many bytes it took."""
    piece = bytes(1000)
    for count in itertools.count():
        try:
            end.write(piece)
        except TransportError:
            return count * len(piece)
    raise AssertionError


@every_transport
async def test_all_byte_values_pass_both_ways_unchanged(pair_of: Opener) -> None:
    everything = bytes(range(256))
    async with opened(pair_of) as (near, far):
        near.write(everything)
        assert await read_exactly(far, 256) == everything
        far.write(everything[::-1])
        assert await read_exactly(near, 256) == everything[::-1]


@every_transport
async def test_a_big_write_arrives_whole_and_in_order(pair_of: Opener) -> None:
    sent = b"".join(index.to_bytes(4, "little") for index in range(12_000))
    async with opened(pair_of) as (near, far):
        near.write(sent)
        assert await read_exactly(far, len(sent)) == sent


@every_transport
async def test_a_full_buffer_refuses_and_keeps_what_it_took(pair_of: Opener) -> None:
    async with opened(pair_of) as (near, far):
        taken = fill(near)
        assert taken >= OUTBOX_LIMIT_BYTES - 1000
        with pytest.raises(TransportError, match="stuck"):
            near.write(bytes(1000))
        assert len(await read_exactly(far, taken)) == taken


@every_transport
async def test_urgent_bytes_are_the_last_word_even_when_the_buffer_is_full(pair_of: Opener) -> None:
    async with opened(pair_of) as (near, far):
        taken = fill(near)
        near.write_urgent(b"first")
        near.write_urgent(b"second")
        received = bytearray()
        while not received.endswith(b"firstsecond"):
            received += await far.read()
        assert len(received) <= taken + 11 - (OUTBOX_LIMIT_BYTES - 1000)
        near.write(b"after")
        assert await read_exactly(far, 5) == b"after"


@every_transport
async def test_closing_wakes_the_reader_and_twice_is_fine(pair_of: Opener) -> None:
    async with opened(pair_of) as (near, _):
        reading = asyncio.create_task(near.read())
        await asyncio.sleep(0)
        near.close()
        near.close()
        with pytest.raises(TransportError, match="closed"):
            await reading


@every_transport
async def test_a_closed_end_refuses_everything(pair_of: Opener) -> None:
    async with opened(pair_of) as (near, _):
        near.close()
        with pytest.raises(TransportError):
            near.write(b"x")
        with pytest.raises(TransportError):
            near.write_urgent(b"x")
        with pytest.raises(TransportError):
            await near.read()


@every_line_that_hangs_up
async def test_when_the_peer_is_gone_reading_and_writing_say_so(pair_of: Opener) -> None:
    async with opened(pair_of) as (near, far):
        reading = asyncio.create_task(near.read())
        await asyncio.sleep(0)
        far.close()
        with pytest.raises(TransportError):
            await reading
        with pytest.raises(TransportError):
            near.write(b"x")


@every_transport
async def test_a_cancelled_read_loses_nothing(pair_of: Opener) -> None:
    async with opened(pair_of) as (near, far):
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.01):
                await near.read()
        far.write(b"kept")
        assert await read_exactly(near, 4) == b"kept"
