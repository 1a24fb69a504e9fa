"""Readers get everything in order, and none holds up another."""

import asyncio

from robotd.core.broadcast import Broadcast


async def test_every_reader_gets_every_item_in_order() -> None:
    broadcast: Broadcast[int] = Broadcast()
    with broadcast.subscribe() as one, broadcast.subscribe() as two:
        for item in range(5):
            broadcast.publish(item)
        assert [await one.get() for _ in range(5)] == list(range(5))
        assert [await two.get() for _ in range(5)] == list(range(5))
    assert broadcast.latest == 4


async def test_a_slow_reader_loses_the_oldest() -> None:
    broadcast: Broadcast[int] = Broadcast()
    with broadcast.subscribe(depth=3) as slow:
        for item in range(10):
            broadcast.publish(item)
        assert [await slow.get() for _ in range(3)] == [7, 8, 9]


async def test_a_reader_waits_until_there_is_something() -> None:
    broadcast: Broadcast[str] = Broadcast()
    with broadcast.subscribe() as reader:
        asyncio.get_running_loop().call_later(1.0, broadcast.publish, "at last")
        async for item in reader:
            assert item == "at last"
            break


def test_a_closed_subscription_gets_nothing_more() -> None:
    broadcast: Broadcast[int] = Broadcast()
    with broadcast.subscribe() as reader:
        pass
    broadcast.publish(1)
    assert not reader._items
