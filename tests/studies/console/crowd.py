"""Browsers of a gateway, many at once, as a program of its own: what they cost themselves is not the gateway's.

Some read, some stall (their sockets fill), and one is hostile. It prints what those that read saw, as JSON.
"""

import argparse
import asyncio
import base64
import contextlib
import json
import math
import os
import socket
import sys
from collections.abc import AsyncIterator
from dataclasses import dataclass, field

import aiohttp
import msgpack
from yarl import URL

from robotd.core.clock import NS_PER_S, now_ns

A_SESSION = 30
"""Pages that share a session: the gateway takes 32."""
_SAMPLED = b"\x01odometry\0"
_SUBPROTOCOL = "robotd.console.v1"


@dataclass
class Seen:
    """What the pages that read were told."""

    late_ms: list[float] = field(default_factory=list)
    """From the robot's own time of a message to its arrival."""
    received_bytes: int = 0
    hung_up: int = 0


async def _reading(session: aiohttp.ClientSession, seen: Seen) -> None:
    async with session.ws_connect("api/ws", protocols=(_SUBPROTOCOL,), max_msg_size=1 << 27) as ws:
        async for message in ws:
            if message.type is aiohttp.WSMsgType.TEXT:
                seen.received_bytes += len(message.data)
                said = json.loads(message.data)
                if said["type"] == "question":
                    await ws.send_json({"type": "answer", "n": said["n"]})
                continue
            seen.received_bytes += len(message.data)
            if message.data.startswith(_SAMPLED):
                fields = msgpack.unpackb(message.data[len(_SAMPLED) :])
                seen.late_ms.append((now_ns() - fields["time_ns"]) / NS_PER_S * 1000.0)
    seen.hung_up += 1


async def _stalled(session: aiohttp.ClientSession, address: URL) -> None:
    """Open a socket by hand, and never read of it; again, when it is hung up on."""
    cookies = "; ".join(f"{one.key}={one.value}" for one in session.cookie_jar)
    key = base64.b64encode(os.urandom(16)).decode()
    lines = (
        *("GET /api/ws HTTP/1.1", f"Host: {address.authority}", f"Origin: {address.origin()}", f"Cookie: {cookies}"),
        *("Connection: Upgrade", "Upgrade: websocket", "Sec-WebSocket-Version: 13", f"Sec-WebSocket-Key: {key}"),
        f"Sec-WebSocket-Protocol: {_SUBPROTOCOL}",
    )
    while True:
        with socket.socket() as one:
            one.setblocking(False)
            one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            loop = asyncio.get_running_loop()
            await loop.sock_connect(one, (address.host or "", address.port or 0))
            await loop.sock_sendall(one, ("\r\n".join(lines) + "\r\n\r\n").encode())
            await asyncio.sleep(20.0)


async def _hostile(session: aiohttp.ClientSession) -> None:
    """Say too much, and nonsense, again and again; guess tokens in between."""
    while True:
        with contextlib.suppress(aiohttp.ClientError, ConnectionError):
            async with session.ws_connect("api/ws", protocols=(_SUBPROTOCOL,)) as ws:
                for _ in range(500):
                    await ws.send_str('{"type": "command", "id": 1, "cmd": "config"')
                await ws.send_str("x" * 60_000)
            async with session.post("api/session", json={"token": "x" * 43}):
                pass
        await asyncio.sleep(0.02)


@contextlib.asynccontextmanager
async def _sessions(address: URL, secret: str, count: int) -> AsyncIterator[list[aiohttp.ClientSession]]:
    async with contextlib.AsyncExitStack() as stack:
        made = []
        for _ in range(count):
            jar, connector = aiohttp.CookieJar(unsafe=True), aiohttp.TCPConnector(limit=0)
            headers = {"Origin": str(address.origin())}
            session = aiohttp.ClientSession(address, headers=headers, cookie_jar=jar, connector=connector)
            await stack.enter_async_context(session)
            async with session.post("api/session", json={"token": secret}) as answer:
                answer.raise_for_status()
            made.append(session)
        yield made


async def crowd(address: URL, secret: str, pages: int, stalled: int, hostile: int, seconds: float) -> Seen:
    """Let a crowd look for some time, and return what those that read saw in the second half of it."""
    seen = Seen()
    reading = pages - stalled - hostile
    async with _sessions(address, secret, math.ceil(pages / A_SESSION)) as sessions:
        work = [_reading(sessions[number // A_SESSION], seen) for number in range(reading)]
        work += [_stalled(sessions[number // A_SESSION], address) for number in range(reading, reading + stalled)]
        work += [_hostile(sessions[-1]) for _ in range(hostile)]
        tasks = [asyncio.create_task(one) for one in work]
        await asyncio.sleep(seconds / 2)
        print("half", flush=True)
        seen.late_ms.clear()
        seen.received_bytes = 0
        await asyncio.sleep(seconds / 2)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
    return seen


def main() -> None:
    """Do as the command line says."""
    parser = argparse.ArgumentParser()
    parser.add_argument("address", type=URL)
    parser.add_argument("--pages", type=int, required=True)
    parser.add_argument("--stalled", type=int, default=0)
    parser.add_argument("--hostile", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=20.0)
    arguments = parser.parse_args()
    secret = sys.stdin.readline().strip()
    seen = asyncio.run(
        crowd(arguments.address, secret, arguments.pages, arguments.stalled, arguments.hostile, arguments.seconds)
    )
    late_ms = sorted(seen.late_ms) or [math.nan]
    reading = arguments.pages - arguments.stalled - arguments.hostile
    told = {
        "p50_ms": late_ms[len(late_ms) // 2],
        "p95_ms": late_ms[int(0.95 * (len(late_ms) - 1))],
        "messages": len(seen.late_ms),
        "bytes_per_s": seen.received_bytes / reading / (arguments.seconds / 2),
        "hung_up": seen.hung_up,
    }
    print(json.dumps(told), flush=True)


if __name__ == "__main__":
    main()
