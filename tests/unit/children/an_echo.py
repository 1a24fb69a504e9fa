"""A child for the tests: it gives back what it hears, and does what a word asks it to."""

import asyncio
import contextlib
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from robotd.children.channel import Channel
from robotd.children.inside import Birth, adopted, live


async def main() -> None:
    birth = adopted(sys.argv[1:])
    life, (lane,) = birth.channels()
    if birth.arguments == ("mute",):
        await asyncio.Event().wait()
    if birth.arguments == ("garbage",):
        life.send(b"\x00\xff what is this")
        await asyncio.Event().wait()
    living = asyncio.create_task(live(life, "0.0" if birth.arguments == ("old",) else "1.0"))
    echoing = asyncio.create_task(echo(lane, birth))
    await asyncio.wait((living, echoing), return_when=asyncio.FIRST_COMPLETED)


async def echo(lane: Channel, birth: Birth) -> None:
    while True:
        match bytes(await lane.receive()):
            case b"exit":
                os._exit(3)
            case b"hang":
                time.sleep(1000.0)  # noqa: ASYNC251  # this is what hanging is
            case b"eat":
                lane.send(b"fed" if can_have(2**30) else b"no memory")
            case b"descriptors":
                lane.send(descriptors())
            case b"unconfined":
                lane.send(birth.unconfined.encode())
            case attempt if attempt.startswith(b"try "):
                lane.send(attempted(*attempt.decode().split(" ", 2)[1:]))
            case message:
                lane.send(message)


def descriptors() -> bytes:
    return " ".join(str(number) for number in range(1024) if is_open(number)).encode()


def is_open(number: int) -> bool:
    with contextlib.suppress(OSError):
        os.fstat(number)
        return True
    return False


def attempted(what: str, where: str) -> bytes:
    """Say how an attempt to do something ended."""
    ways: dict[str, Callable[[], object]] = {
        "read": lambda: Path(where).read_bytes(),
        "write": lambda: Path(where).write_bytes(b"yes"),
        "open": lambda: os.close(os.open(where, os.O_RDWR | os.O_NOCTTY)),
        "list": lambda: list(Path(where).iterdir()),
        "remove": lambda: Path(where).unlink(),
        "rename": lambda: Path(where).rename(where + "-"),
        "truncate": lambda: os.truncate(where, 0),
        "listen": lambda: socket.socket(socket.AF_UNIX).bind(where),
        "run": lambda: subprocess.run((where,), check=True),
        "signal": lambda: os.kill(int(where), signal.SIGCONT),
        "connect": lambda: socket.socket().connect(("127.0.0.1", int(where))),
    }
    try:
        ways[what]()
    except OSError as error:
        return (error.strerror or str(error)).encode()
    return b"done"


def can_have(size: int) -> bool:
    try:
        return len(bytearray(size)) > 0
    except MemoryError:
        return False


if __name__ == "__main__":
    asyncio.run(main())
