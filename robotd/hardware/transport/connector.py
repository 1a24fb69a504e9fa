"""From the address in the configuration to a line."""

from typing import NoReturn

from robotd.core.errors import TransportError
from robotd.hardware.transport.address import host_and_port
from robotd.hardware.transport.descriptor import DescriptorTransport
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.transport.serial_port import open_serial
from robotd.hardware.transport.tcp import open_tcp
from robotd.hardware.transport.transport import Connect


def connector(address: str, line_format: LineFormat) -> Connect:
    """Return what opens the line at an address; a name under ``/dev`` is resolved again each time.

    Args:
        address: see :func:`host_and_port`.
        line_format: of a serial line; TCP has none.

    Raises:
        ConfigError: it is no address.
    """
    there = host_and_port(address)
    if there is None:
        return lambda: open_serial(address, line_format)
    host, port = there

    async def connect() -> DescriptorTransport:
        return await open_tcp(host, port)

    return connect


async def no_line() -> NoReturn:
    """Stand for the line of a device that has none; TransportError."""
    raise TransportError("this device has no line")
