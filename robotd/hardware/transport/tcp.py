"""A TCP connection to a serial server, or to an emulator elsewhere."""

import asyncio
import socket

from robotd.core.errors import TransportError
from robotd.hardware.transport.descriptor import DescriptorTransport
from robotd.hardware.transport.readiness import OnLoop

_CONNECT_TIMEOUT_S = 5.0
_KERNEL_BUFFER_BYTES = 16 * 1024
"""Kept small, because what waits in the kernel cannot be overtaken by a stop."""


async def open_tcp(host: str, port: int) -> DescriptorTransport:
    """Connect.

    Raises:
        TransportError: nobody answers there within five seconds, or nobody listens.
    """
    name = f"tcp://{host}:{port}"
    try:
        async with asyncio.timeout(_CONNECT_TIMEOUT_S):
            connection = await _connect(host, port)
    except TimeoutError as error:
        raise TransportError(f"{name}: no answer within {_CONNECT_TIMEOUT_S:g} s") from error
    except OSError as error:
        raise TransportError(f"{name}: {error.strerror}") from error
    return tcp_transport(name, connection)


def tcp_transport(name: str, connection: socket.socket) -> DescriptorTransport:
    """Take over a connected socket."""
    connection.setblocking(False)
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _KERNEL_BUFFER_BYTES)
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return DescriptorTransport(name, connection.fileno(), OnLoop(connection.fileno()), connection.close)


async def _connect(host: str, port: int) -> socket.socket:
    loop = asyncio.get_running_loop()
    (family, kind, protocol, _, address), *_ = await loop.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    connection = socket.socket(family, kind, protocol)
    connection.setblocking(False)
    try:
        await loop.sock_connect(connection, address)
    except BaseException:
        connection.close()
        raise
    return connection
