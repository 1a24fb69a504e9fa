"""What only a real terminal can get wrong."""

import asyncio
import errno
import fcntl
import os
import resource
import threading
from array import array
from pathlib import Path

import pytest

from robotd.core.errors import TransportError
from robotd.hardware.transport import holder, serial_port
from robotd.hardware.transport.descriptor import DescriptorTransport
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.transport.pty import PtyEnd, open_pty
from robotd.hardware.transport.serial_port import open_serial

pytestmark = pytest.mark.real_clock


async def exchange(board: PtyEnd) -> None:
    """Open the other side, pass a byte each way, close it."""
    host = await open_serial(board.path, LineFormat(115200))
    host.write(b"?")
    assert await board.read() == b"?"
    board.write(b"!")
    assert await host.read() == b"!"
    host.close()


async def test_a_pty_serves_one_program_after_the_other() -> None:
    board = open_pty()
    for _ in range(3):
        await exchange(board)
    board.close()


async def test_a_pty_read_waits_through_unplugging_and_delivers_what_comes_after() -> None:
    board = open_pty()
    reading = asyncio.create_task(board.read())
    for _ in range(2):
        host = await open_serial(board.path, LineFormat(115200))
        await asyncio.sleep(0.03)
        plugged = board.is_plugged
        host.close()
        await asyncio.sleep(0.03)
        assert (plugged, board.is_plugged, reading.done()) == (True, False, False)
    host = await open_serial(board.path, LineFormat(115200))
    host.write(b"here")
    assert await reading == b"here"
    host.close()
    board.close()


async def test_a_pty_that_nobody_opened_forgets_what_it_writes_and_costs_nothing() -> None:
    board = open_pty()
    reading = asyncio.create_task(board.read())
    used = resource.getrusage(resource.RUSAGE_SELF).ru_utime
    for _ in range(5):
        board.write(bytes(60_000))
        await asyncio.sleep(0.05)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_utime - used < 0.1
    host = await open_serial(board.path, LineFormat(115200))
    board.write(b"fresh")
    assert await host.read() == b"fresh"
    host.close()
    board.close()
    with pytest.raises(TransportError):
        await reading


async def test_what_waits_for_a_program_that_closed_is_not_given_to_the_next() -> None:
    board = open_pty()
    deaf = await open_serial(board.path, LineFormat(115200))
    board.write(b"old" * 20_000)
    deaf.close()
    await asyncio.sleep(0.03)
    host = await open_serial(board.path, LineFormat(115200))
    board.write(b"new")
    assert await host.read() == b"new"
    host.close()
    board.close()


async def test_a_port_in_use_is_refused_and_its_holder_named() -> None:
    board = open_pty()
    first = await open_serial(board.path, LineFormat(115200))
    with pytest.raises(TransportError, match=rf"busy: held by pid {os.getpid()} \("):
        await open_serial(board.path, LineFormat(115200))
    first.close()
    await exchange(board)
    board.close()


TIOCGEXCL = 0x80045440


def is_exclusive(line: DescriptorTransport) -> bool:
    answer = array("i", [0])
    fcntl.ioctl(line._descriptor, TIOCGEXCL, answer)
    return bool(answer[0])


async def test_a_real_port_is_closed_to_everybody_and_a_pty_stays_open_after_its_holder_was_killed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    board = open_pty()
    as_pty = await open_serial(board.path, LineFormat(115200))
    assert not is_exclusive(as_pty)
    as_pty.close()
    monkeypatch.setattr(serial_port, "_PTY_SLAVE_MAJORS", range(0))
    as_port = await open_serial(board.path, LineFormat(115200))
    assert is_exclusive(as_port)
    as_port.close()
    board.close()


async def test_without_a_view_of_the_locks_the_holder_is_still_found_by_its_descriptor(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def hidden(path: str) -> int:
        raise PermissionError(path)

    monkeypatch.setattr(holder, "_locking_pid", hidden)
    board = open_pty()
    line = await open_serial(board.path, LineFormat(115200))
    assert (holder.holder_of(board.path) or "").startswith(f"pid {os.getpid()} (")
    line.close()
    board.close()
    assert holder.holder_of(board.path) is None


async def test_a_missing_port_is_a_transport_error() -> None:
    with pytest.raises(TransportError, match=r"/dev/tty-nowhere: no such device"):
        await open_serial("/dev/tty-nowhere", LineFormat(115200))


async def test_a_file_is_not_a_serial_port(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no")
    with pytest.raises(TransportError, match="not a serial port"):
        await open_serial(str(tmp_path / "file"), LineFormat(115200))


async def test_a_character_device_that_is_no_terminal_is_refused() -> None:
    with pytest.raises(TransportError, match="/dev/null"):
        await open_serial("/dev/null", LineFormat(115200))


async def test_an_impossible_speed_is_refused() -> None:
    board = open_pty()
    with pytest.raises(TransportError, match="baud"):
        await open_serial(board.path, LineFormat(-1))
    board.close()


async def test_a_symlink_is_resolved_at_each_open(tmp_path: Path) -> None:
    link = tmp_path / "by-id"
    for _ in range(2):
        board = open_pty()
        link.unlink(missing_ok=True)
        link.symlink_to(board.path)
        host = await open_serial(str(link), LineFormat(115200))
        host.write(b"?")
        assert await board.read() == b"?"
        host.close()
        board.close()


@pytest.mark.parametrize("missing", ["descriptor", "thread"])
async def test_a_port_is_given_back_where_there_is_no_descriptor_or_thread_to_watch_it(
    missing: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It ended the daemon, with an error of the wrong kind."""
    board = open_pty()

    def no_descriptor(*_: int) -> int:
        raise OSError(errno.EMFILE, os.strerror(errno.EMFILE))

    def no_thread(thread: threading.Thread) -> None:
        if not thread.name.startswith("watch "):
            return start(thread)
        raise RuntimeError("can't start new thread")

    start = threading.Thread.start
    with monkeypatch.context() as refusing:
        if missing == "descriptor":
            refusing.setattr(os, "eventfd", no_descriptor)
        else:
            refusing.setattr(threading.Thread, "start", no_thread)
        with pytest.raises(TransportError, match=r"Too many open files|can't start new thread"):
            await open_serial(board.path, LineFormat(115200))
    await exchange(board)
    board.close()
