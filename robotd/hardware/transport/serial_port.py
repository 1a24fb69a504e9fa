"""A serial port, opened and set by pyserial, then served by the event loop; ours alone while it is open.

``flock`` keeps out those who ask first, and other instances of the daemon even when they run as root;
``TIOCEXCL`` keeps out everybody else. A pseudo-terminal gets the ``flock`` only: it would keep
``TIOCEXCL`` after the death of the process that set it, and never open again.
"""

import asyncio
import contextlib
import errno
import fcntl
import os
import stat
import termios
from pathlib import Path

import serial

from robotd.core.errors import TransportError
from robotd.hardware.transport.descriptor import DescriptorTransport
from robotd.hardware.transport.descriptor_readiness import InThread
from robotd.hardware.transport.holder import holder_of
from robotd.hardware.transport.line_format import LineFormat

_PTY_SLAVE_MAJORS = range(136, 144)
"""Device numbers by which Linux knows the slaves of pseudo-terminals."""
_ADVICE = {
    errno.ENOENT: "no such device",
    errno.EACCES: "permission denied; is this user in the group of the device?",
    errno.ENXIO: "no device behind it",
    errno.ENODEV: "no device behind it",
    errno.EIO: "no device behind it",
}


async def open_serial(path: str, line_format: LineFormat) -> DescriptorTransport:
    """Open a serial port or the slave side of a pseudo-terminal: raw, no flow control, exclusive.

    Raises:
        TransportError: it is not there, busy (the message names the holder if it can), or no serial port; or this
            process has no descriptor or thread left.
    """
    try:
        # In a thread: opening a port asks its driver, which takes its time.
        port = await asyncio.get_running_loop().run_in_executor(None, _open, path, line_format)
    except RuntimeError as error:
        raise TransportError(f"{path}: {error}") from error
    try:
        readiness = InThread(path, port.fileno())
    except (OSError, RuntimeError) as error:
        _release(port)
        raise TransportError(f"{path}: {error}") from error
    return DescriptorTransport(path, port.fileno(), readiness, lambda: _release(port))


def _open(path: str, line_format: LineFormat) -> serial.Serial:
    try:
        if not stat.S_ISCHR(Path(path).stat().st_mode):
            raise TransportError(f"{path}: not a serial port")
        port = serial.Serial(
            path,
            line_format.baud,
            bytesize=line_format.data_bits,
            parity=line_format.parity,
            stopbits=line_format.stop_bits,
            timeout=0,  # the loop waits, pyserial never does
            exclusive=True,
        )
    except ValueError as error:
        raise TransportError(f"{path}: {error}") from error
    except OSError as error:
        raise TransportError(f"{path}: {_reason(path, error)}") from error
    try:
        _finish(port.fileno())
    except (OSError, termios.error) as error:
        port.close()
        raise TransportError(f"{path}: {error}") from error
    return port


def _finish(descriptor: int) -> None:
    settings = termios.tcgetattr(descriptor)
    settings[6][termios.VMIN] = 1  # so that reading nothing means hung up, not nothing yet
    termios.tcsetattr(descriptor, termios.TCSANOW, settings)
    if os.major(os.fstat(descriptor).st_rdev) not in _PTY_SLAVE_MAJORS:
        fcntl.ioctl(descriptor, termios.TIOCEXCL)


def _release(port: serial.Serial) -> None:
    """Give it up at once, even while a thread still asks the kernel about it."""
    with contextlib.suppress(OSError):  # the device may be gone
        fcntl.flock(port.fileno(), fcntl.LOCK_UN)
        fcntl.ioctl(port.fileno(), termios.TIOCNXCL)
    port.close()


def _reason(path: str, error: OSError) -> str:
    if error.errno in {errno.EBUSY, errno.EWOULDBLOCK}:
        holder = holder_of(path)
        return f"busy: held by {holder}" if holder else "busy: another process holds it"
    return _ADVICE.get(error.errno or 0, str(error))
