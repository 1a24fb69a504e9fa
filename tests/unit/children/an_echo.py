"""A child for the tests: it gives back what it hears, and does what a word asks it to."""

import asyncio
import os
import sys
import time
from pathlib import Path

from robotd.children.channel import Channel
from robotd.children.inside import adopted, live


async def main() -> None:
    birth = adopted(sys.argv[1:])
    life, (lane,) = birth.channels()
    if birth.arguments == ("mute",):
        await asyncio.Event().wait()
    if birth.arguments == ("garbage",):
        life.send(b"\x00\xff what is this")
        await asyncio.Event().wait()
    living = asyncio.create_task(live(life, "0.0" if birth.arguments == ("old",) else "1.0"))
    echoing = asyncio.create_task(echo(lane))
    await asyncio.wait((living, echoing), return_when=asyncio.FIRST_COMPLETED)


async def echo(lane: Channel) -> None:
    while True:
        match await lane.receive():
            case b"exit":
                os._exit(3)
            case b"hang":
                time.sleep(1000.0)  # noqa: ASYNC251  # this is what hanging is
            case b"eat":
                lane.send(b"fed" if can_have(2**30) else b"no memory")
            case b"descriptors":
                lane.send(descriptors())
            case message:
                lane.send(message)


def descriptors() -> bytes:
    return " ".join(link.name for link in Path("/proc/self/fd").iterdir()).encode()


def can_have(size: int) -> bool:
    try:
        return len(bytearray(size)) > 0
    except MemoryError:
        return False


if __name__ == "__main__":
    asyncio.run(main())
