"""From an address to a line."""

import socket
from contextlib import closing

import pytest

from robotd.core.errors import ConfigError, TransportError
from robotd.hardware.transport.address import connector
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.transport.pty import open_pty


@pytest.mark.real_clock
async def test_a_path_opens_a_serial_port() -> None:
    board = open_pty()
    line = await connector(board.path, LineFormat(115200))()
    assert line.name == board.path
    line.close()
    board.close()


@pytest.mark.real_clock
async def test_a_tcp_address_opens_a_connection() -> None:
    with closing(socket.create_server(("127.0.0.1", 0))) as server:
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        line = await connector(address, LineFormat(115200))()
        assert line.name == address
        line.close()


@pytest.mark.real_clock
async def test_nobody_listening_is_a_transport_error() -> None:
    with closing(socket.create_server(("127.0.0.1", 0))) as server:
        port = server.getsockname()[1]
    with pytest.raises(TransportError, match=f"tcp://127.0.0.1:{port}: "):
        await connector(f"tcp://127.0.0.1:{port}", LineFormat(115200))()


@pytest.mark.parametrize(
    "address", ["", "ttyUSB0", "tcp://host", "tcp://host:0", "tcp://:1", "tcp://h:99999", "udp://h:1"]
)
def test_another_address_is_a_config_error(address: str) -> None:
    with pytest.raises(ConfigError, match="expected a device path or tcp://host:port"):
        connector(address, LineFormat(115200))
