"""What every channel does: in memory, and over a socket between two ends of one process."""

import asyncio
import socket
from collections.abc import Callable, Iterator

import pytest

from robotd.children.channel import Channel
from robotd.children.memory_channel import memory_channel
from robotd.children.message_framing import header
from robotd.children.socket_channel import SocketChannel
from robotd.core.errors import ChildError

Make = Callable[[int], tuple[Channel, Channel]]


def over_sockets(room_bytes: int) -> tuple[Channel, Channel]:
    near, far = socket.socketpair()
    return SocketChannel(near, room_bytes=room_bytes), SocketChannel(far, room_bytes=room_bytes)


@pytest.fixture(params=[memory_channel, over_sockets], ids=["memory", "sockets"])
def make(request: pytest.FixtureRequest) -> Iterator[Make]:
    made: list[Channel] = []

    def pair(room_bytes: int = 2**20) -> tuple[Channel, Channel]:
        ends: tuple[Channel, Channel] = request.param(room_bytes)
        made.extend(ends)
        return ends

    yield pair
    assert all(not end.send(b"after the end") for end in made), "each test closes what it made"


@pytest.mark.real_clock
async def test_messages_arrive_whole_and_in_order_both_ways(make: Make) -> None:
    near, far = make(2**24)
    for message in (b"one", b"", b"x" * 2**22):
        assert near.send(message[:1], memoryview(message)[1:])
    assert far.send(b"back")
    assert [await far.receive() for _ in range(3)] == [b"one", b"", b"x" * 2**22]
    assert await near.receive() == b"back"
    near.close()
    far.close()


@pytest.mark.real_clock
async def test_a_full_channel_says_so_and_never_waits_and_has_room_again(make: Make) -> None:
    near, far = make(2**20)
    sent = 0
    while near.send(bytes(2**16)):
        sent += 1
        assert sent < 100, "the bound holds"
    assert sent >= 2**4
    waiting = asyncio.create_task(near.room())
    await asyncio.sleep(0)
    assert not waiting.done()
    for _ in range(sent):
        assert await far.receive() == bytes(2**16)
    await waiting
    assert near.send(b"again")
    assert await far.receive() == b"again"
    near.close()
    far.close()


@pytest.mark.real_clock
async def test_an_end_that_takes_nothing_does_not_grow(make: Make) -> None:
    near, far = make(2**20)
    for _ in range(5):
        while near.send(bytes(2**16)):
            """Fill it, as far as it goes."""
        await asyncio.sleep(0.01)
    # The room of one end, that of the other, a read that was under way, and what the kernel holds.
    assert far._inbox.bytes <= 2**20 + 2**18  # type: ignore[attr-defined]  # what is to be bounded
    near.close()
    far.close()


@pytest.mark.real_clock
async def test_what_was_sent_before_the_end_is_received_then_the_end_is_told(make: Make) -> None:
    near, far = make(2**20)
    near.send(b"last words")
    near.close()
    assert await far.receive() == b"last words"
    with pytest.raises(ChildError, match="the other end is gone"):
        await far.receive()
    far.close()
    with pytest.raises(ChildError):
        await near.receive()
    with pytest.raises(ChildError):
        await near.room()


@pytest.mark.real_clock
async def test_who_waits_when_it_is_closed_is_told(make: Make) -> None:
    near, far = make(2**20)
    receiving = asyncio.create_task(near.receive())
    await asyncio.sleep(0)
    near.close()
    with pytest.raises(ChildError, match="it was closed"):
        await receiving
    far.close()


@pytest.mark.real_clock
async def test_a_message_longer_than_any_may_be_ends_the_channel_and_costs_no_memory() -> None:
    liar, victim = socket.socketpair()
    channel = SocketChannel(victim, longest=1000)
    with liar:
        liar.sendall(header(2**32 - 1) + b"garbage")
        with pytest.raises(ChildError, match="a message of 4294967295 bytes, expected at most 1000"):
            await channel.receive()
    assert not channel.send(b"anything")
