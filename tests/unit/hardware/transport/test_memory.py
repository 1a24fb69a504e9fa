"""What only the memory line can do."""

import asyncio

import pytest

from robotd.core.errors import TransportError
from robotd.hardware.transport.memory import memory_pair


async def test_cutting_the_line_loses_what_is_under_way_and_wakes_both_ends() -> None:
    near, far = memory_pair("line")
    near.write(b"lost")
    reading = asyncio.create_task(near.read())
    await asyncio.sleep(0)
    far.cut()
    with pytest.raises(TransportError, match="line: the line was cut"):
        await reading
    with pytest.raises(TransportError):
        await far.read()


async def test_what_was_written_before_closing_can_still_be_read() -> None:
    near, far = memory_pair()
    near.write(b"last words")
    near.close()
    assert await far.read() == b"last words"
    with pytest.raises(TransportError, match="hung up"):
        await far.read()
