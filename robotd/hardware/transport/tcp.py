"""A TCP connection to a serial server, or to an emulator elsewhere."""

import asyncio
import socket

from robotd.core.errors import TransportError
from robotd.hardware.transport.descriptor import DescriptorTransport
from robotd.hardware.transport.descriptor_readiness import OnLoop

_CONNECT_TIMEOUT_S = 5.0
_MOST_ADDRESSES = 4
"""Addresses of one name that are tried; they share the time."""
_Address = tuple[str, int] | tuple[str, int, int, int] | tuple[int, bytes]
_KERNEL_BUFFER_BYTES = 16 * 1024
"""Kept small, because what waits in the kernel cannot be overtaken by a stop."""


async def open_tcp(host: str, port: int) -> DescriptorTransport:
    """Connect to the first address of a name where somebody listens.

    Raises:
        TransportError: nobody does, at any of them; says of each why not.
    """
    name = f"tcp://{host}:{port}"
    addresses = (await _look_up(name, host, port))[:_MOST_ADDRESSES]
    reasons = []
    for family, address in addresses:
        try:
            # A share for each: one that swallows packets must not use up the time of the next.
            async with asyncio.timeout(_CONNECT_TIMEOUT_S / len(addresses)):
                return tcp_transport(name, await _connect(family, address))
        except TimeoutError:
            reasons.append(f"no answer from {address[0]} within {_CONNECT_TIMEOUT_S / len(addresses):g} s")
        except OSError as error:
            reasons.append(f"{address[0]}: {error.strerror}")
    raise TransportError(f"{name}: {'; '.join(reasons)}")


def tcp_transport(name: str, connection: socket.socket) -> DescriptorTransport:
    """Take over a connected socket."""
    connection.setblocking(False)
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _KERNEL_BUFFER_BYTES)
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)  # a stop does not wait for an acknowledgement
    return DescriptorTransport(name, connection.fileno(), OnLoop(connection.fileno()), connection.close)


async def _look_up(name: str, host: str, port: int) -> list[tuple[int, _Address]]:
    try:
        async with asyncio.timeout(_CONNECT_TIMEOUT_S):
            found = await asyncio.get_running_loop().getaddrinfo(host, port, type=socket.SOCK_STREAM)
    except TimeoutError as error:
        raise TransportError(f"{name}: the name was not found within {_CONNECT_TIMEOUT_S:g} s") from error
    except OSError as error:
        raise TransportError(f"{name}: {error.strerror}") from error
    except UnicodeError as error:  # how the lookup says that a label is empty or too long
        raise TransportError(f"{name}: no name of a host: {error}") from error
    return [(family, address) for family, *_, address in found]


async def _connect(family: int, address: _Address) -> socket.socket:
    connection = socket.socket(family, socket.SOCK_STREAM)
    connection.setblocking(False)
    try:
        await asyncio.get_running_loop().sock_connect(connection, address)
    except BaseException:  # cancelled by its timeout, too: nobody else knows this socket
        connection.close()
        raise
    return connection
