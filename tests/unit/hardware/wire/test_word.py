"""What bytes ask for, in words, in every dialect: what is asked all the time is left out, and nothing else is."""

import pytest

from firmware_proto.common import Arm, BoardKind, Ping, Stop
from firmware_proto.drive_messages import SetVelocity
from firmware_proto.framing import RawFrame, encode_frame
from firmware_proto.rangefinder_messages import Shoot
from robotd.hardware.wire import dimetix, disto, dynamixel, lw20, lwnx, ptu, rflex, rwi_ascii, scip, tfmini
from robotd.hardware.wire.board import STOP_BYTES, requests_to
from robotd.hardware.wire.word import Repeat, Word, Words
from tests.support.own_boards import KILL_BYTES

DRIVE = requests_to(BoardKind.DRIVE)


def frame(seq: int, message: Ping | Arm | Stop | SetVelocity | Shoot) -> bytes:
    return encode_frame(RawFrame(message.TYPE, seq, message.to_payload()))


RFLEX_REPORTS = "port 2 opcode 34 00 00 00 64 00 00 00 03"
LEFT_OUT: list[tuple[Words, bytes]] = [
    (DRIVE, frame(3, Ping(5)) + frame(4, SetVelocity(100, 0, 300))),
    (rwi_ascii.requests, b"TW\rRW\rBV\rWD 1a\rTV ff\rRV 0\r"),
    (rflex.requests, rflex.STATUS + rflex.set_direction(0, 500, 1000, 30_000, forwards=True)),
    (ptu.requests, b"PP TP "),
    (dynamixel.requests, dynamixel.read(1, dynamixel.PRESENT_POSITION, 4) + dynamixel.read(2, dynamixel.MOVING, 1)),
    (dimetix.requests, b"s0t\r\ns7t\r\n"),
    (disto.requests, b"t\r\n"),
    (lw20.requests, lw20.PRODUCT),
    (lwnx.requests, lwnx.read(lwnx.NAME)),
    (scip.requests, scip.PARAMETERS),
    (tfmini.requests, tfmini.VERSION),
]
SAID: list[tuple[Words, bytes, list[str]]] = [
    (DRIVE, frame(7, Arm()), ["#7 Arm()"]),
    (requests_to(BoardKind.RANGEFINDER), frame(8, Shoot(250)), ["#8 Shoot(timeout_ms=250)"]),
    (rwi_ascii.requests, b"\rTH\rRH\rHD\rWD 1a\rTV ff\rT+\rJD 1\r", ["TH", "RH", "HD", "T+", "JD 1"]),
    (rflex.requests, rflex.BRAKE_RELEASE + rflex.report_every(100), ["port 2 opcode 12", RFLEX_REPORTS]),
    (rflex.requests, rflex.set_direction(1, 0, 1000, 35_000, forwards=True), ["halt 1"]),
    (ptu.requests, b" H PP-2500 TP0 FT ", ["H", "PP-2500", "TP0", "FT"]),
    (dynamixel.requests, dynamixel.packet(2, dynamixel.PING), ["servo 2 instruction 0x01"]),
    (dynamixel.requests, dynamixel.write(1, dynamixel.TORQUE_ENABLE, 1, 1), ["servo 1 instruction 0x03 40 00 01"]),
    (dimetix.requests, b"\r\ns0c\r\ns0g\r\n", ["s0c", "s0g"]),
    (disto.requests, b"\r\np\r\ng\r\n", ["p", "g"]),
    (lw20.requests, b"\r\n#LF,0\r\n?LDF,1\r\n", ["#LF,0", "?LDF,1"]),
    (lwnx.requests, lwnx.write(lwnx.LASER_FIRING, 1, 1) + lwnx.read(lwnx.DISTANCE), ["write 50 01", "read 44"]),
    (scip.requests, b"\nQT\n" + scip.one_scan(44, 725), ["QT", "MD0044072500001"]),
    (tfmini.requests, tfmini.TRIGGER + tfmini.OUTPUT_OFF, ["command 0x04", "command 0x07 00"]),
    (tfmini.requests, tfmini.FIRST_STANDARD, ["first generation: say data frames"]),
]
ALL: dict[str, Words] = {words.__module__.rpartition(".")[2]: words for words, _ in LEFT_OUT}


@pytest.mark.parametrize(("words", "data"), LEFT_OUT)
def test_what_is_asked_all_the_time_is_left_out(words: Words, data: bytes) -> None:
    assert words(data) == []


@pytest.mark.parametrize(("words", "data", "texts"), SAID)
def test_a_request_is_said_in_words(words: Words, data: bytes, texts: list[str]) -> None:
    assert [word.text for word in words(data)] == texts


@pytest.mark.parametrize("words", ALL.values(), ids=ALL)
def test_bytes_that_are_no_request_are_a_word(words: Words) -> None:
    assert [word.text for word in words(b"\x80\x81")] == ["bytes 80 81"]


@pytest.mark.parametrize(("words", "data"), LEFT_OUT)
def test_a_question_that_is_damaged_is_no_question(words: Words, data: bytes) -> None:
    for at in range(len(data)):
        damaged = data[:at] + bytes((data[at] ^ 0x7F,)) + data[at + 1 :]
        assert words(damaged) != [], (at, damaged)


def test_stops_are_said_until_they_are_obeyed() -> None:
    halts = (rflex.requests(rflex.set_direction(0, 0, 1000, 30_000, forwards=True)), rwi_ascii.requests(b"\rTH\rRH\r"))
    own = (DRIVE(STOP_BYTES), DRIVE(KILL_BYTES))
    servos = dynamixel.requests(dynamixel.sync_write(dynamixel.TORQUE_ENABLE, 1, {1: 0, 2: 0}))
    for words in (*halts, *own, ptu.requests(ptu.STOP_BYTES), servos):
        assert words
        assert all(word.repeat is Repeat.UNTIL_OBEYED for word in words)


def test_requests_to_our_own_boards_bear_their_number() -> None:
    assert DRIVE(frame(7, Arm())) == [Word("#7 Arm()", Repeat.NUMBERED)]
