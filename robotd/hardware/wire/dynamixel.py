"""Dynamixel Protocol 2.0 (X series servos): packets and registers.

A packet is ``FF FF FD 00``, id, length, instruction, parameters and a CRC-16; a ``FF FF FD`` among instruction and
parameters gets an extra ``FD``. Servos answer with instruction 55 and an error byte. The bus is half duplex, so what is
sent may come back as an echo: packets that are not answers are let go.
"""

import struct
from dataclasses import dataclass
from typing import Final

from robotd.hardware.wire.enquiry import Enquiry
from robotd.hardware.wire.receiving import Receiving
from robotd.hardware.wire.word import Repeat, Word, whole

HEADER: Final = b"\xff\xff\xfd\x00"
STATUS = 0x55
PING, READ, WRITE, REBOOT, SYNC_WRITE = 0x01, 0x02, 0x03, 0x08, 0x83
BROADCAST = 0xFE
LENGTH_MAX = 128
"""No answer that we ask for is longer; a larger length is noise."""

TORQUE_ENABLE, HARDWARE_ERROR, BUS_WATCHDOG = 64, 70, 98
PROFILE_VELOCITY, GOAL_POSITION, MOVING, PRESENT_POSITION = 112, 116, 122, 132
_ASKED = (MOVING, PRESENT_POSITION, TORQUE_ENABLE)
"""What is read again and again until the answer is right: how often is a matter of the machine's pace."""
BUS_WATCHDOG_MS = 20
"""Unit of the bus watchdog."""
_FIRST_SERVO = 1
ALERT = 0x80
"""Bit of the error byte: read the hardware error."""

_HARDWARE_ERRORS = {
    0x01: "supply voltage out of range",
    0x04: "overheated",
    0x08: "encoder broken",
    0x10: "electrical shock",
    0x20: "overloaded",
}

_STUFF, _STUFFED = b"\xff\xff\xfd", b"\xff\xff\xfd\xfd"


def _crc_table() -> tuple[int, ...]:
    table = []
    for value in range(256):
        crc = value << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x8005 if crc & 0x8000 else crc << 1) & 0xFFFF
        table.append(crc)
    return tuple(table)


_CRC = _crc_table()


def crc16(data: bytes) -> int:
    """Return the CRC-16 with polynomial 0x8005, not reflected, from 0."""
    crc = 0
    for byte in data:
        crc = (crc << 8 ^ _CRC[(crc >> 8 ^ byte) & 0xFF]) & 0xFFFF
    return crc


@dataclass(frozen=True, slots=True)
class ServoStatus:
    """What a servo answers: which one, its error byte, and the parameters."""

    servo: int
    error: int
    """0, or a result in the low bits and :data:`ALERT`."""
    parameters: bytes


@dataclass(frozen=True, slots=True)
class Instruction:
    """A packet that is no answer: an echo of our own, or another master's."""

    servo: int
    instruction: int
    parameters: bytes


Message = ServoStatus | Instruction


def hardware_error(bits: int) -> str:
    """Return what a servo says is wrong with it, in words.

    >>> hardware_error(0x24)
    'overheated, overloaded'
    """
    known = [text for bit, text in _HARDWARE_ERRORS.items() if bits & bit]
    return ", ".join(known) or f"hardware error {bits:#04x}"


def packet(servo: int, instruction: int, parameters: bytes = b"") -> bytes:
    """Return a packet.

    >>> packet(1, PING).hex(" ")
    'ff ff fd 00 01 03 00 01 19 4e'
    """
    # Nothing inside a packet may look like the beginning of one: such bytes are written with one more.
    body = (bytes((instruction,)) + parameters).replace(_STUFF, _STUFFED)
    head = HEADER + bytes((servo,)) + struct.pack("<H", len(body) + 2) + body
    return head + struct.pack("<H", crc16(head))


def read(servo: int, register: int, size: int) -> bytes:
    """Return the instruction that reads a register."""
    return packet(servo, READ, struct.pack("<HH", register, size))


def write(servo: int, register: int, value: int, size: int) -> bytes:
    """Return the instruction that writes a register of 1, 2 or 4 bytes."""
    return packet(servo, WRITE, struct.pack("<H", register) + value.to_bytes(size, "little", signed=value < 0))


def sync_write(register: int, size: int, values: dict[int, int]) -> bytes:
    """Return the instruction that writes a register of several servos at once; nobody answers it."""
    data = b"".join(
        bytes((servo,)) + value.to_bytes(size, "little", signed=value < 0) for servo, value in values.items()
    )
    return packet(BROADCAST, SYNC_WRITE, struct.pack("<HH", register, size) + data)


class DynamixelWire(Receiving):
    """The receiving half."""

    def __init__(self) -> None:
        super().__init__("packets", "crc_errors")

    def feed(self, data: bytes) -> list[Message]:
        """Take bytes as they come; return the messages that are whole now."""
        self._begun += data
        messages: list[Message] = []
        while self._hunt():
            size = 7 + int.from_bytes(self._begun[5:7], "little")
            if len(self._begun) < size:
                break
            whole = bytes(self._begun[:size])
            if crc16(whole[:-2]) != int.from_bytes(whole[-2:], "little"):
                self._counters["crc_errors"] += 1
                del self._begun[:1]  # not the packet: its length may be what was damaged
                continue
            del self._begun[:size]
            self._counters["packets"] += 1
            messages.append(_message(whole[4], whole[7:-2].replace(_STUFFED, _STUFF)))
        return messages

    def _hunt(self) -> bool:
        """Let go of what begins no packet; return whether the length of one can be seen."""
        while True:
            at = self._begun.find(HEADER)
            if at < 0:
                # The last bytes may be the beginning of a header.
                keep = next((k for k in (3, 2, 1) if self._begun[-k:] == HEADER[:k]), 0)
                self._skip(len(self._begun) - keep)
                return False
            self._skip(at)
            if len(self._begun) < 7:
                return False
            if 3 <= int.from_bytes(self._begun[5:7], "little") <= LENGTH_MAX:  # an instruction and the CRC at least
                return True
            self._skip(1)


def _message(servo: int, body: bytes) -> Message:
    # The bus is half duplex: what is no status is an echo of ours, and answers nothing.
    if body[0] == STATUS and len(body) > 1:
        return ServoStatus(servo, body[1], body[2:])
    return Instruction(servo, body[0], body[1:])


ENQUIRY = Enquiry(
    packet(_FIRST_SERVO, PING),
    DynamixelWire,
    lambda message: (
        f"servo {message.servo}" if isinstance(message, ServoStatus) and message.servo == _FIRST_SERVO else None
    ),
)
"""Whether the servo is there that pans, unless the configuration says otherwise; it holds or rests as before."""


def requests(data: bytes) -> list[Word]:
    """Return what bytes to the servos ask for, in words: without the questions that are asked until they are obeyed."""
    orders = (message for message in DynamixelWire().feed(data) if isinstance(message, Instruction))
    return whole(data, ((packet(one.servo, one.instruction, one.parameters), _word(one)) for one in orders))


def _word(order: Instruction) -> Word | None:
    if order.instruction == READ and int.from_bytes(order.parameters[:2], "little") in _ASKED:
        return None
    text = f"servo {order.servo} instruction {order.instruction:#04x} {order.parameters.hex(' ')}".rstrip()
    return Word(text, Repeat.UNTIL_OBEYED if order.instruction == SYNC_WRITE else Repeat.UNANSWERED)
