"""From the address in the configuration to a line."""

import urllib.parse
from typing import NoReturn

from robotd.core.errors import ConfigError, TransportError
from robotd.hardware.transport.descriptor import DescriptorTransport
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.transport.serial_port import open_serial
from robotd.hardware.transport.tcp import open_tcp
from robotd.hardware.transport.transport import Connect


def connector(address: str, line_format: LineFormat) -> Connect:
    """Return what opens the line at an address; a name under ``/dev`` is resolved again each time.

    Args:
        address: ``/dev/serial/by-id/...`` or another absolute path, or ``tcp://host:port``.
        line_format: of a serial line; TCP has none.

    Raises:
        ConfigError: the address is neither.
    """
    if address.startswith("/"):
        return lambda: open_serial(address, line_format)
    host, port = _host_and_port(address)

    async def connect() -> DescriptorTransport:
        return await open_tcp(host, port)

    return connect


async def no_line() -> NoReturn:
    """Stand for the line of a device that has none; TransportError."""
    raise TransportError("this device has no line")


def _host_and_port(address: str) -> tuple[str, int]:
    parts = urllib.parse.urlsplit(address)
    try:
        port = parts.port
    except ValueError:
        port = None
    # A path is a slip of somebody who thinks of URLs, and port 0 is no port to connect to.
    if parts.scheme != "tcp" or not parts.hostname or not port or parts.path:
        raise ConfigError(f"expected a device path or tcp://host:port, got {address!r}")
    return parts.hostname, port
