"""What all emulated boards owe the protocol: session, states, repeats."""

import itertools
import zlib
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware_proto.common import (
    Ack,
    Arm,
    BoardKind,
    BoardState,
    BoardStatus,
    Clear,
    Configure,
    ConfigureReply,
    Disarm,
    Fault,
    Hello,
    HelloReply,
    Identify,
    IdentifyReply,
    Kill,
    Nack,
    Ping,
    Pong,
    Result,
    Stop,
)
from firmware_proto.dictionary import TELEMETRY_END, TELEMETRY_START, dictionary_for, requests_for
from firmware_proto.drive_messages import SetVelocity
from firmware_proto.framing import RawFrame, encode_frame
from firmware_proto.pantilt_messages import Aim, ReadAim, ReadLimits
from firmware_proto.rangefinder_messages import SetLaser, Shoot, ShotStatus
from firmware_proto.rules import RULES
from firmware_proto.schema import Message
from robotd.hardware.wire.board import STOP_BYTES, BoardWire, Received
from robotd.sim.boards.drive_board import DriveBoard
from robotd.sim.boards.emulated_board import Board
from robotd.sim.boards.pantilt_board import PanTiltBoard
from robotd.sim.boards.rangefinder_board import RangefinderBoard
from robotd.sim.physics.plant import ShotAnswer
from tests.support.own_boards import KILL_BYTES


class Still:
    """Every plant at once: nothing happens, at once."""

    limits_rad = (-1.0, 1.0, -0.5, 0.5)
    counts = (0, 0)
    velocity = (0.0, 0.0)
    bumpers = 0
    battery_mv = 24_000
    angles_rad = (0.0, 0.0)
    arrives_us = None
    broken = Fault.NONE

    def advance(self, to_us: int) -> None:
        pass

    def command(self, speed_mps: float, turn_radps: float) -> None:
        pass

    def cut(self) -> None:
        pass

    def aim(self, pan_rad: float, tilt_rad: float) -> None:
        pass

    def halt(self) -> None:
        pass

    def switch(self, *, on: bool) -> None:
        pass

    def shoot(self, at_us: int) -> ShotAnswer:
        return ShotAnswer(ShotStatus.OK, 1.0, 7, 1000)


BOARDS: dict[BoardKind, Callable[[], Board]] = {
    BoardKind.DRIVE: lambda: DriveBoard(Still(), boot_id=7),
    BoardKind.PANTILT: lambda: PanTiltBoard(Still(), boot_id=7),
    BoardKind.RANGEFINDER: lambda: RangefinderBoard(Still(), boot_id=7),
}
EXAMPLES: dict[type[Message], Message] = {
    Hello: Hello(1, 0, 99),
    Ping: Ping(5),
    Identify: Identify(0),
    Configure: Configure(50, 500),
    SetVelocity: SetVelocity(100, 0, 250),
    Aim: Aim(100, 100, 250),
    SetLaser: SetLaser(1),
    Shoot: Shoot(100),
} | {empty: empty() for empty in (Arm, Disarm, Clear, Stop, Kill, ReadAim, ReadLimits)}
each_board = pytest.mark.parametrize("kind", BoardKind)


class Host:
    """The other end of the line, with a clock that only moves when told."""

    def __init__(self, kind: BoardKind, state: BoardState = BoardState.BOOT) -> None:
        self.board = BOARDS[kind]()
        self.wire = BoardWire(kind)
        self.now_us = 1_000_000
        self._seq = itertools.count()
        steps: dict[BoardState, list[type[Message]]] = {
            BoardState.BOOT: [],
            BoardState.IDENTIFIED: [Hello],
            BoardState.CONFIGURED: [Hello, Configure],
            BoardState.ARMED: [Hello, Configure, Arm],
            BoardState.FAULT: [Hello, Configure, Kill],
        }
        for step in steps[state]:
            self.ask(EXAMPLES[step])
        self.heard()
        assert self.state() is state

    def state(self) -> BoardState:
        return self.board.state

    def ask(self, request: Message, seq: int | None = None) -> Message:
        """Send a request and return the answer; other answers than one would be a mistake."""
        seq = next(self._seq) if seq is None else seq
        answers = [one for one in self.send(self.wire.encode(request, seq)) if not _is_telemetry(one)]
        (answer,) = answers
        assert answer.seq == seq
        return answer.message

    def send(self, data: bytes) -> list[Received]:
        """Send bytes and return what came at once, and a little later for a shot."""
        self.board.receive(data, self.now_us)
        return self.wait(1) if self.board.next_event_us is not None else self.heard()

    def wait(self, ms: int) -> list[Received]:
        """Let time pass and return what the board said."""
        self.now_us += ms * 1000
        self.board.advance(self.now_us)
        return self.heard()

    def heard(self) -> list[Received]:
        return self.wire.feed(self.board.take_output())


def _last_status(received: list[Received]) -> BoardStatus:
    return [one.message for one in received if isinstance(one.message, BoardStatus)][-1]


def _is_telemetry(one: Received) -> bool:
    return TELEMETRY_START <= one.type < TELEMETRY_END


CASES = [
    pytest.param(kind, state, request, id=f"{kind.name} {state.name} {request.__name__}")
    for kind in BoardKind
    for state in BoardState
    for request in requests_for(kind).values()
]


@pytest.mark.parametrize(("kind", "state", "request_type"), CASES)
def test_each_request_in_each_state_is_done_or_refused_as_the_rules_say(
    kind: BoardKind, state: BoardState, request_type: type[Message]
) -> None:
    host = Host(kind, state)
    answer = host.ask(EXAMPLES[request_type])
    if state in RULES[request_type].states:
        assert not isinstance(answer, Nack)
    else:
        assert answer == Nack(Result.WRONG_STATE, request_type.TYPE)
        assert host.state() is state


LEADS_TO = {
    Hello: [BoardState.IDENTIFIED] * 4 + [BoardState.FAULT],
    Configure: [BoardState.BOOT] + [BoardState.CONFIGURED] * 3 + [BoardState.FAULT],
    Arm: [BoardState.BOOT, BoardState.IDENTIFIED, BoardState.ARMED, BoardState.ARMED, BoardState.FAULT],
    Disarm: [BoardState.BOOT, BoardState.IDENTIFIED, BoardState.CONFIGURED, BoardState.CONFIGURED, BoardState.FAULT],
    Clear: [BoardState.BOOT, BoardState.IDENTIFIED] + [BoardState.CONFIGURED] * 3,
    Stop: [BoardState.BOOT, BoardState.IDENTIFIED, BoardState.CONFIGURED, BoardState.CONFIGURED, BoardState.FAULT],
    Kill: [BoardState.FAULT] * 5,
}


@each_board
@pytest.mark.parametrize("request_type", LEADS_TO, ids=lambda request: request.__name__)
def test_requests_lead_where_the_state_diagram_says(kind: BoardKind, request_type: type[Message]) -> None:
    for before, after in zip(BoardState, LEADS_TO[request_type], strict=True):
        host = Host(kind, before)
        host.ask(EXAMPLES[request_type])
        assert host.state() is after, f"from {before.name}"


@each_board
@pytest.mark.parametrize("state", BoardState)
def test_emergency_frames_work_in_every_state(kind: BoardKind, state: BoardState) -> None:
    host = Host(kind, state)
    assert [one.message for one in host.send(b"\x55" + STOP_BYTES) if not _is_telemetry(one)] == [Ack(0)]
    assert host.state() is not BoardState.ARMED
    assert [one.message for one in host.send(KILL_BYTES) if not _is_telemetry(one)] == [Ack(0)]
    assert host.board.faults & Fault.KILLED


@each_board
def test_a_fault_before_the_first_hello_takes_the_whole_handshake(kind: BoardKind) -> None:
    host = Host(kind)
    host.ask(Kill())
    assert host.ask(Clear()) == Nack(Result.WRONG_STATE, Clear.TYPE)
    assert host.ask(Configure(50, 500)) == Nack(Result.WRONG_STATE, Configure.TYPE)
    assert isinstance(host.ask(Hello(1, 0, 1)), HelloReply)
    assert host.ask(Clear()) == Nack(Result.WRONG_STATE, Clear.TYPE)
    assert isinstance(host.ask(Configure(50, 500)), ConfigureReply)
    assert host.state() is BoardState.FAULT
    assert host.ask(Clear()) == Ack(0)
    assert host.state() is BoardState.CONFIGURED
    assert host.board.faults is Fault.NONE


# Handshake


@each_board
def test_hello_says_who_the_board_is(kind: BoardKind) -> None:
    dictionary = dictionary_for(kind)
    reply = Host(kind).ask(Hello(1, 0, 0xDEADBEEF))
    assert reply == HelloReply(1, 0, 0xDEADBEEF, len(dictionary), zlib.crc32(dictionary), 7, 1_000_000)


@each_board
def test_a_host_of_another_major_version_gets_no_session(kind: BoardKind) -> None:
    host = Host(kind, BoardState.ARMED)
    reply = host.ask(Hello(2, 0, 1))
    assert isinstance(reply, HelloReply)
    assert reply.major == 1
    assert host.state() is BoardState.BOOT


@each_board
def test_the_dictionary_can_be_read_in_pieces(kind: BoardKind) -> None:
    host = Host(kind, BoardState.IDENTIFIED)
    dictionary = dictionary_for(kind)
    pieces = []
    for offset in range(0, len(dictionary), 64):
        reply = host.ask(Identify(offset))
        assert isinstance(reply, IdentifyReply)
        assert reply.offset == offset
        pieces.append(reply.data)
    assert b"".join(pieces).rstrip(b"\0") == dictionary.rstrip(b"\0")
    assert host.ask(Identify(60_000)) == IdentifyReply(60_000, bytes(64))


@each_board
def test_configure_says_what_it_took_over(kind: BoardKind) -> None:
    request = Configure(20, 400)
    expected = ConfigureReply(Result.OK, zlib.crc32(request.to_payload()))
    assert Host(kind, BoardState.IDENTIFIED).ask(request) == expected


@each_board
@pytest.mark.parametrize("impossible", [Configure(0, 500), Configure(50, 0)])
def test_the_deadman_and_telemetry_cannot_be_turned_off(kind: BoardKind, impossible: Configure) -> None:
    host = Host(kind, BoardState.IDENTIFIED)
    assert host.ask(impossible) == Nack(Result.BAD_VALUE, Configure.TYPE)
    assert host.state() is BoardState.IDENTIFIED


@each_board
def test_a_reboot_shows_as_silence_refusals_and_a_new_boot_id(kind: BoardKind) -> None:
    host = Host(kind, BoardState.ARMED)
    host.board.reboot(8)
    assert host.wait(1000) == []
    assert host.ask(Arm()) == Nack(Result.WRONG_STATE, Arm.TYPE)
    reply = host.ask(Hello(1, 0, 1))
    assert isinstance(reply, HelloReply)
    assert reply.boot_id == 8
    assert host.state() is BoardState.IDENTIFIED


@each_board
def test_a_reboot_takes_faults_and_bytes_under_way_with_it(kind: BoardKind) -> None:
    host = Host(kind, BoardState.FAULT)
    host.board.receive(host.wire.encode(Ping(1), 0), host.now_us)
    host.board.reboot(8)
    assert host.board.take_output() == b""
    assert host.state() is BoardState.BOOT
    assert host.board.next_event_us is None


# Repeats


@each_board
def test_a_repeated_request_gets_the_same_answer_and_is_not_done_again(kind: BoardKind) -> None:
    host = Host(kind, BoardState.CONFIGURED)
    assert host.ask(Arm(), seq=70) == Ack(0)
    host.ask(Stop())
    assert host.ask(Arm(), seq=70) == Ack(0)
    assert host.state() is BoardState.CONFIGURED
    assert host.ask(Arm(), seq=71) == Ack(0)
    assert host.state() is BoardState.ARMED


@each_board
def test_a_refusal_is_repeated_too(kind: BoardKind) -> None:
    host = Host(kind, BoardState.FAULT)
    assert host.ask(Arm(), seq=70) == Nack(Result.WRONG_STATE, Arm.TYPE)
    host.ask(Clear())
    assert host.ask(Arm(), seq=70) == Nack(Result.WRONG_STATE, Arm.TYPE)
    assert host.ask(Arm(), seq=71) == Ack(0)


@each_board
def test_a_new_session_forgets_what_was_answered(kind: BoardKind) -> None:
    host = Host(kind, BoardState.CONFIGURED)
    host.ask(Arm(), seq=0)
    host.ask(Hello(1, 0, 2))
    assert host.ask(Arm(), seq=0) == Nack(Result.WRONG_STATE, Arm.TYPE)


@each_board
def test_requests_that_need_no_memory_are_answered_afresh(kind: BoardKind) -> None:
    host = Host(kind, BoardState.IDENTIFIED)
    first = host.ask(Ping(1), seq=4)
    host.now_us += 500
    second = host.ask(Ping(1), seq=4)
    assert isinstance(first, Pong)
    assert isinstance(second, Pong)
    assert second.board_us == first.board_us + 500


# Not understood


@each_board
def test_an_unknown_request_is_refused(kind: BoardKind) -> None:
    received = Host(kind).send(encode_frame(RawFrame(0x3F, 12, b"abc")))
    assert received == [Received(Nack.TYPE, 12, Nack(Result.UNKNOWN_TYPE, 0x3F))]


@each_board
def test_a_request_of_the_wrong_size_is_refused_and_counted(kind: BoardKind) -> None:
    host = Host(kind, BoardState.CONFIGURED)
    host.heard()
    assert host.send(encode_frame(RawFrame(Arm.TYPE, 3, b"\1"))) == [
        Received(Nack.TYPE, 3, Nack(Result.BAD_LENGTH, Arm.TYPE))
    ]
    assert _last_status(host.wait(60)).length_errors == 1


@each_board
@pytest.mark.parametrize("code", [0x40, 0x80, 0x85, 0xC0, 0xEE, 0xFE, 0xFF])
def test_a_looped_back_line_is_not_answered(kind: BoardKind, code: int) -> None:
    assert Host(kind).send(encode_frame(RawFrame(code, 0, b"\0\0"))) == []


@each_board
def test_noise_is_counted_and_reported(kind: BoardKind) -> None:
    host = Host(kind, BoardState.CONFIGURED)
    damaged = STOP_BYTES[:-2] + bytes([STOP_BYTES[-2] ^ 1, 0])
    host.send(damaged + b"\x05\x01\x00" + b"\x01" * 300 + b"\x00")
    status = _last_status(host.wait(60))
    assert (status.crc_errors, status.cobs_errors, status.length_errors) == (1, 1, 1)


@each_board
@settings(max_examples=30)
@given(noise=st.lists(st.binary(max_size=40), max_size=8), state=st.sampled_from(BoardState))
def test_noise_neither_raises_nor_moves_a_board(kind: BoardKind, noise: list[bytes], state: BoardState) -> None:
    host = Host(kind, state)
    for data in noise:
        host.send(data)
    host.send(b"\0")
    assert host.state() is state
    assert isinstance(host.ask(Ping(1)), Pong)
