"""The binary dialect of RWI's rFLEX controllers (B14R, B21R, ATRV, Magellan Pro): bytes and messages.

A frame is ``1B 02``, port, id, opcode, length, data, the XOR of all from the port on, ``1B 03``; integers are
big-endian. Nothing is escaped, so the length leads, and a frame counts only if its XOR and its end are right. The
controller never acknowledges, drops what comes in quick bursts, and loses speeds with a byte 1B in two places: see
:func:`safe_speed`.
"""

import struct
from dataclasses import dataclass

from robotd.hardware.wire.receiving import Receiving
from robotd.hardware.wire.word import Repeat, Word, whole

HEAD, TAIL = b"\x1b\x02", b"\x1b\x03"
OVERHEAD = 9
DATA_MAX = 64
"""No report that we know is longer; a larger length is noise."""

SYSTEM, MOTION, DIO = 1, 2, 5
_ESCAPE = 0x1B
_AXIS_REPORT = struct.Struct(">IIBiiII")
_STATUS = struct.Struct(">IIB")
_SET_DIRECTION, _DIRECTION = 7, struct.Struct(">BIIIB")


@dataclass(frozen=True, slots=True)
class AxisReport:
    """Port 2, opcode 33: where an axis is."""

    axis: int
    """0 translates, 1 rotates."""
    position: int
    """Signed 32 bits, wraps."""
    speed: int
    """Signed, units per second."""


@dataclass(frozen=True, slots=True)
class SystemStatus:
    """Port 1, opcode 1."""

    centivolts: int
    """Less than the battery has by an offset of the robot."""
    brake: int


@dataclass(frozen=True, slots=True)
class Switches:
    """Port 5, opcode 1: the digital inputs of one address."""

    address: int
    data: bytes


@dataclass(frozen=True, slots=True)
class OtherFrame:
    """Whatever else is whole."""

    port: int
    opcode: int
    data: bytes


Message = AxisReport | SystemStatus | Switches | OtherFrame


def frame(port: int, opcode: int, data: bytes = b"", *, sender: int = 0) -> bytes:
    """Return a frame.

    >>> frame(2, 12).hex(" ")
    '1b 02 02 00 0c 00 0e 1b 03'
    """
    body = bytes((port, sender, opcode, len(data))) + data
    check = 0
    for byte in body:
        check ^= byte
    return HEAD + body + bytes((check,)) + TAIL


def set_direction(axis: int, speed: int, acceleration: int, torque: int, *, forwards: bool) -> bytes:
    """Return the order that lets an axis run at a speed."""
    return frame(MOTION, _SET_DIRECTION, _DIRECTION.pack(axis, speed, acceleration, torque, forwards))


def safe_speed(speed: int) -> int:
    """Return the nearest lower speed that the controller does not lose: its firmware drops some with a byte 1B.

    The lowest byte but one is rounded down to ``1A FF``; the highest cannot be 1B at any speed a base can run.

    >>> hex(safe_speed(0x1B34)), hex(safe_speed(0x1C00))
    ('0x1aff', '0x1c00')
    """
    if speed >> 8 & 0xFF == _ESCAPE:
        return (speed & ~0xFFFF) | 0x1AFF
    return speed


STATUS = frame(SYSTEM, 1)
BRAKE_SET, BRAKE_RELEASE, DEFAULTS = frame(MOTION, 11), frame(MOTION, 12), frame(MOTION, 10)


def report_every(period_us: int, axes: int = 3) -> bytes:
    """Return the order that asks for reports of both axes."""
    return frame(MOTION, 34, struct.pack(">II", period_us, axes))


def switches_every(period_us: int) -> bytes:
    """Return the order that asks for reports of the digital inputs."""
    return frame(DIO, 0, struct.pack(">I", period_us))


class RflexWire(Receiving):
    """The receiving half."""

    def __init__(self) -> None:
        super().__init__("frames", "checksum_errors")

    def feed(self, data: bytes) -> list[Message]:
        """Take bytes as they come; return the messages that are whole now."""
        self._begun += data
        messages: list[Message] = []
        while self._hunt():
            size = self._begun[5] + OVERHEAD
            if len(self._begun) < size:
                break
            whole = bytes(self._begun[:size])
            check = 0
            for byte in whole[2:-3]:
                check ^= byte
            if check != whole[-3] or whole[-2:] != TAIL:
                self._counters["checksum_errors"] += 1
                del self._begun[: len(HEAD)]  # not the frame: its length may be what was damaged
                continue
            del self._begun[:size]
            self._counters["frames"] += 1
            messages.append(_message(whole[2], whole[4], whole[6:-3]))
        return messages

    def _hunt(self) -> bool:
        """Let go of what begins no frame; return whether the length of one can be seen."""
        while True:
            at = self._begun.find(HEAD)
            if at < 0:
                keep = 1 if self._begun[-1:] == HEAD[:1] else 0  # a head may be cut in half here
                self._skip(len(self._begun) - keep)
                return False
            self._skip(at)
            if len(self._begun) < OVERHEAD - 3:
                return False
            if self._begun[5] <= DATA_MAX:
                return True
            # Nothing is escaped, so data may look like a head: only that is let go, and what follows is read again.
            self._skip(len(HEAD))


def _message(port: int, opcode: int, data: bytes) -> Message:
    if (port, opcode, len(data)) == (MOTION, 33, _AXIS_REPORT.size):
        _, _, axis, position, speed, _, _ = _AXIS_REPORT.unpack(data)
        return AxisReport(axis, position, speed)
    if (port, opcode, len(data)) == (SYSTEM, 1, _STATUS.size):
        _, centivolts, brake = _STATUS.unpack(data)
        return SystemStatus(centivolts, brake)
    if (port, opcode) == (DIO, 1) and len(data) >= 6:
        return Switches(data[4], data[5:])
    return OtherFrame(port, opcode, data)


def requests(data: bytes) -> list[Word]:
    """Return what bytes to the controller ask for, in words: without speeds, which are renewed, and its status."""
    frames = (message for message in RflexWire().feed(data) if isinstance(message, OtherFrame))
    return whole(data, ((frame(one.port, one.opcode, one.data), _word(one)) for one in frames))


def _word(order: OtherFrame) -> Word | None:
    if (order.port, order.opcode, len(order.data)) == (MOTION, _SET_DIRECTION, _DIRECTION.size):
        axis, speed, _, _, _ = _DIRECTION.unpack(order.data)
        # A halt is said until the base obeys: how often is a matter of the machine, that it was said is not.
        return None if speed else Word(f"halt {axis}", Repeat.UNTIL_OBEYED)
    if (order.port, order.opcode) == (SYSTEM, 1):
        return None
    return Word(f"port {order.port} opcode {order.opcode} {order.data.hex(' ')}".rstrip())
