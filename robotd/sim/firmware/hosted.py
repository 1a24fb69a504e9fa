"""A board whose firmware is C: the same sans-I/O interface as an emulated one."""

from typing import Any

from firmware_proto.common import BoardState, Fault
from robotd.sim.firmware._native import ffi, lib

_NEVER = (1 << 64) - 1
_raised: list[BaseException] = []
"""What a function of a plant raised beneath the C that called it. Boards live in one thread."""


class FirmwareBoard:
    """Firmware on its hardware abstraction; a board is made by :mod:`robotd.sim.firmware.boards`.

    Args:
        device: the C struct of the device, which begins with its board.
        hal: the C struct of what is beneath it.
        power_up: the C function that makes one of the other.
        keep: what the C side points to.
        boot_id: differs from boot to boot.
    """

    def __init__(self, device: Any, hal: Any, power_up: Any, *, keep: object, boot_id: int) -> None:
        self._output = bytearray()
        # Held for as long as the board lives: C has pointers to them, of which Python knows nothing.
        self._device, self._hal, self._power_up, self._keep = device, hal, power_up, keep
        self._board = ffi.addressof(device, "board")
        self._handle = ffi.new_handle(self._output)
        self._line = ffi.new("struct board_line *", {"context": self._handle, "write": lib.line_write})
        self.reboot(boot_id)

    def receive(self, data: bytes, now_us: int) -> None:
        """Take bytes from the host, at the board's time."""
        _call(lib.board_receive, self._board, data, len(data), now_us)

    def advance(self, now_us: int) -> None:
        """Let time pass; what falls due on the way happens in order, each at its own time."""
        _call(lib.board_advance, self._board, now_us)

    def take_output(self) -> bytes:
        """Return, once, the bytes that the board has for the host."""
        taken = bytes(self._output)
        self._output.clear()
        return taken

    @property
    def next_event_us(self) -> int | None:
        """When :meth:`advance` must be called at the latest; None while nothing is under way."""
        next_us = int(_call(lib.board_next_us, self._board))
        return None if next_us == _NEVER else next_us

    @property
    def state(self) -> BoardState:
        """Where in its life the board is; ``FAULT`` lies over the state beneath it."""
        return BoardState(lib.board_state(self._board))

    @property
    def faults(self) -> Fault:
        """The latched faults."""
        return Fault(self._board.faults)

    def reboot(self, boot_id: int) -> None:
        """Lose power and come back: motors cut, everything forgotten, bytes under way lost."""
        self._output.clear()
        _call(self._power_up, self._device, self._hal, self._line, boot_id)


def call_back(device: str, **functions: Any) -> None:
    """Let C call these functions, as ``device_name``; what they raise comes out of the board that called."""
    for name, function in functions.items():
        ffi.def_extern(name=f"{device}_{name}", onerror=_note)(function)


def _call(function: Any, *arguments: Any) -> Any:
    result = function(*arguments)
    if _raised:
        error = _raised[0]
        _raised.clear()
        raise error
    return result


def _note(_kind: object, error: BaseException, _trace: object) -> None:
    _raised.append(error)


def _write(line: Any, data: Any, size: int) -> None:
    output: bytearray = ffi.from_handle(line)
    output += ffi.buffer(data, size)


call_back("line", write=_write)
