"""From an address to a line."""

import asyncio
import socket
from contextlib import closing

import pytest

from robotd.core.errors import ConfigError, TransportError
from robotd.hardware.transport import tcp
from robotd.hardware.transport.connector import connector
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.transport.pty import open_pty
from robotd.hardware.transport.tcp import open_tcp


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


@pytest.mark.real_clock
async def test_all_addresses_of_a_name_are_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server, socket.socket() as dead:
        dead.bind(("127.0.0.2", 0))  # and nobody listens
        port = server.getsockname()[1]

        async def two(*_: object, **__: object) -> list[tuple[object, ...]]:
            kind = (socket.AF_INET, socket.SOCK_STREAM, 6, "")
            return [(*kind, dead.getsockname()), (*kind, ("127.0.0.1", port))]

        monkeypatch.setattr(asyncio.get_running_loop(), "getaddrinfo", two)
        line = await open_tcp("scanner.local", port)
        accepted, _ = server.accept()
        line.write(b"hello")
        assert accepted.recv(5) == b"hello"
        line.close()
        accepted.close()


async def test_an_address_that_never_answers_leaves_time_for_the_next(monkeypatch: pytest.MonkeyPatch) -> None:
    async def two(*_: object, **__: object) -> list[tuple[object, ...]]:
        return [(socket.AF_INET6, 1, 6, "", ("::1", 1, 0, 0)), (socket.AF_INET, 1, 6, "", ("127.0.0.1", 1))]

    async def connect(family: int, _: object) -> socket.socket:
        if family == socket.AF_INET6:
            await asyncio.Event().wait()
        raise ConnectionRefusedError(111, "Connection refused")

    monkeypatch.setattr(asyncio.get_running_loop(), "getaddrinfo", two)
    monkeypatch.setattr(tcp, "_connect", connect)
    expected = r"tcp://both:1: no answer from ::1 within 2.5 s; 127.0.0.1: Connection refused"
    with pytest.raises(TransportError, match=expected):
        await open_tcp("both", 1)


@pytest.mark.parametrize("error", [socket.gaierror(-2, "Name or service not known"), UnicodeError("label too long")])
async def test_a_name_that_is_not_known_is_a_transport_error(monkeypatch: pytest.MonkeyPatch, error: Exception) -> None:
    async def nobody(*_: object, **__: object) -> list[tuple[object, ...]]:
        raise error

    monkeypatch.setattr(asyncio.get_running_loop(), "getaddrinfo", nobody)
    with pytest.raises(TransportError, match="tcp://nowhere:1: "):
        await open_tcp("nowhere", 1)
