"""Clients that take too much, each a program of its own.

``python -m tests.studies.heart.attackers NAME RUNTIME_DIR SHARE``: with this share of what is too much. Each says
``begun`` when it has begun, and goes on until it is killed. It expects to be cut off, and comes again.
"""

import contextlib
import os
import socket
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import zmq

from robotd.contract.envelope import encode_request
from robotd.contract.requests import GetStatus, ListMaps, MapShow
from robotd.server.zmtp import GREETING, message, ready

SUBSCRIPTIONS = 120_000
CONNECTIONS = 1050
BYTES_OF_FRAMES = 60_000_000
BYTES_OF_SUBSCRIPTIONS = 75_000_000
CROWD = 300
FLOODERS = 200
SLOW = 32


def subscribe_and_hang_up(runtime_dir: Path, share: float) -> Iterator[None]:
    """A libzmq client with 120 000 subscriptions, which then hangs up."""
    with zmq.Context() as context:
        while True:
            with context.socket(zmq.SUB) as reader:
                reader.setsockopt(zmq.LINGER, 0)
                reader.connect(f"ipc://{runtime_dir}/state.sock")
                for number in range(round(share * SUBSCRIPTIONS)):
                    reader.subscribe(b"topic %d" % number)
                yield


def connect(runtime_dir: Path, share: float) -> Iterator[None]:
    """A thousand connections as fast as they can be made."""
    while True:
        with contextlib.ExitStack() as stack:
            for _ in range(round(share * CONNECTIONS)):
                end = stack.enter_context(socket.socket(socket.AF_UNIX))
                with contextlib.suppress(OSError):
                    end.connect(str(runtime_dir / "commands.sock"))
            yield


def frames_of_a_byte(runtime_dir: Path, share: float) -> Iterator[None]:
    """One message of 60 MB, a byte a frame."""
    yield from _pour(runtime_dir / "commands.sock", b"DEALER", b"\x01\x01x" * 65536, round(3 * share * BYTES_OF_FRAMES))


def megabytes_of_subscriptions(runtime_dir: Path, share: float) -> Iterator[None]:
    """75 MB of subscriptions."""
    block = b"".join(message(b"\x01%03d" % number + b"x" * 240) for number in range(256))
    yield from _pour(runtime_dir / "state.sock", b"SUB", block, round(share * BYTES_OF_SUBSCRIPTIONS))


def crowd(runtime_dir: Path, share: float) -> Iterator[None]:
    """300 readers of libzmq's, each with all topics."""
    with zmq.Context() as context, contextlib.ExitStack() as stack:
        for _ in range(round(share * CROWD)):
            reader = stack.enter_context(context.socket(zmq.SUB))
            reader.setsockopt(zmq.LINGER, 0)
            reader.subscribe(b"")
            for name in ("state", "maps"):
                reader.connect(f"ipc://{runtime_dir}/{name}.sock")
        while True:
            yield


def flood(runtime_dir: Path, share: float) -> Iterator[None]:
    """200 clients that ask without end, and read what they are answered; eight processes share them."""
    request = encode_request(1, GetStatus())
    for _ in range(7):
        if os.fork() == 0:
            break
    with zmq.Context() as context, contextlib.ExitStack() as stack:
        clients = [stack.enter_context(context.socket(zmq.DEALER)) for _ in range(round(share * FLOODERS) // 8)]
        for client in clients:
            client.setsockopt(zmq.LINGER, 0)
            client.connect(f"ipc://{runtime_dir}/commands.sock")
        while True:
            for client in clients:
                with contextlib.suppress(zmq.Again):
                    for _ in range(20):
                        client.send(request, zmq.NOBLOCK)
                with contextlib.suppress(zmq.Again):
                    for _ in range(20):
                        client.recv(zmq.NOBLOCK)
            yield


def slow(runtime_dir: Path, share: float) -> Iterator[None]:
    """One client with 32 requests at a time that take long: maps from the disk."""
    asked = max(2, round(share * SLOW))
    with zmq.Context() as context, context.socket(zmq.DEALER) as client:
        client.setsockopt(zmq.LINGER, 0)
        client.connect(f"ipc://{runtime_dir}/commands.sock")
        number = 0
        while True:
            for _ in range(asked):
                number += 1
                client.send(encode_request(number, MapShow("large") if number % 2 else ListMaps()))
            yield
            for _ in range(asked):
                client.recv()


def _pour(path: Path, kind: bytes, block: bytes, total: int) -> Iterator[None]:
    while True:
        with socket.socket(socket.AF_UNIX) as end, contextlib.suppress(OSError):
            end.connect(str(path))
            end.sendall(GREETING + ready(kind))
            for _ in range(total // len(block)):
                end.sendall(block)
        yield


ATTACKERS: dict[str, Callable[[Path, float], Iterator[None]]] = {
    "120 000 subscriptions, and a hang-up": subscribe_and_hang_up,
    "1050 connections at once": connect,
    "60 MB in frames of a byte": frames_of_a_byte,
    "75 MB of subscriptions": megabytes_of_subscriptions,
    "300 connections": crowd,
    "200 clients flood": flood,
    "32 slow requests of one client": slow,
}


def main() -> None:
    """Attack until killed."""
    attack = ATTACKERS[sys.argv[1]](Path(sys.argv[2]), float(sys.argv[3]))
    next(attack)
    print("begun", flush=True)
    parent = os.getppid()
    for _ in attack:
        if os.getppid() != parent:  # a run that was killed leaves nothing behind
            break


if __name__ == "__main__":
    main()
