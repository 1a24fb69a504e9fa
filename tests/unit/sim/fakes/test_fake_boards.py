"""A fake board answers a living host as the recorded one answered its own."""

import random
from dataclasses import replace

import pytest

from firmware_proto.common import (
    Ack,
    Arm,
    BoardKind,
    BoardState,
    BoardStatus,
    Clear,
    Configure,
    ConfigureReply,
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
from firmware_proto.dictionary import dictionary_for
from firmware_proto.drive_messages import DriveReport, OdometryReport
from firmware_proto.framing import RawFrame, encode_frame
from firmware_proto.pantilt_messages import Aim, AimReport, Motion
from firmware_proto.rangefinder_messages import SetLaser, Shoot, Shot, ShotStatus
from firmware_proto.schema import Message
from robotd.core.errors import RecordingError
from robotd.recording.entries import BytesEntry, Entry
from robotd.recording.reader import Recording
from robotd.sim.fakes.fake_boards import FakeBoard, fake_boards
from tests.unit.sim.fakes.tapes import (
    HEADER,
    MS,
    PERIOD_MS,
    Host,
    Tape,
    laser_tape,
    odometry,
    only,
    shot,
    status,
)


def test_the_handshake_is_its_own_and_the_identity_is_the_recorded_one() -> None:
    host = Host(laser_tape().board(), BoardKind.RANGEFINDER)
    (hello, reply, *_) = host.open(nonce=4321)
    assert isinstance(hello, HelloReply)
    assert (hello.nonce, hello.boot_id) == (4321, 5)
    assert isinstance(reply, ConfigureReply)
    data = b""
    while len(data) < hello.dictionary_size:
        (piece,) = host.ask(Identify(len(data)))
        assert isinstance(piece, IdentifyReply)
        data += piece.data
    assert data[: hello.dictionary_size] == dictionary_for(BoardKind.RANGEFINDER)
    assert host.ask(Ping(55)) == [Pong(55, host.now_us)]


def test_a_recorded_dictionary_is_given_back() -> None:
    import zlib

    recorded = b"as it was in the flash of that board, years ago" * 2
    tape = Tape("drive").asks(0, Hello(1, 0, 7), 0)
    tape.says(1, HelloReply(1, 0, 7, len(recorded), zlib.crc32(recorded), 5, 1_000_000))
    for offset in (0, 64):
        tape.asks(2, Identify(offset), offset // 64)
        tape.says(3, IdentifyReply(offset, recorded[offset:][:64]), offset // 64)
    tape.asks(4, Configure(50, 500), 0).says(5, status(BoardState.CONFIGURED))
    host = Host(tape.board(), BoardKind.DRIVE)
    (hello,) = host.ask(Hello(1, 0, 8))
    assert isinstance(hello, HelloReply)
    assert hello.dictionary_crc32 == zlib.crc32(recorded)
    assert host.ask(Identify(64)) == [IdentifyReply(64, recorded[64:].ljust(64, b"\0"))]


def test_shots_come_in_order_with_the_living_seq_and_time() -> None:
    board = laser_tape().board()
    host = Host(board, BoardKind.RANGEFINDER)
    host.open()
    host.wait(300)
    host.ask(Arm())
    host.wait(3)
    host.ask(SetLaser(1))
    host.wait(2)
    for range_mm in (100, 200, 300):
        asked_us = host.now_us
        assert not only(Shot, host.ask(Shoot(500)) + host.wait(6))
        (answer,) = only(Shot, host.wait(1))
        assert answer == shot(range_mm, board_us=asked_us)
        assert [frame.seq for frame in host.frames if frame.type == Shot.TYPE][-1] == host.seq
        host.wait(random.Random(range_mm).uniform(0, 500))
    assert board.mismatches == []
    assert board.finished


def test_a_host_in_a_hurry_gets_every_answer_and_the_newest_telemetry() -> None:
    board = laser_tape().board()
    host = Host(board, BoardKind.RANGEFINDER)
    host.open()
    said = host.ask(Arm()) + host.ask(SetLaser(1)) + host.ask(Shoot(500)) + host.ask(Shoot(500))
    assert only(Ack, said) == [Ack(Result.OK)] * 2
    assert only(Shot, said) == [shot(100, host.now_us)]
    assert [message.state for message in said if isinstance(message, BoardStatus)][-1] == BoardState.ARMED
    assert only(Shot, host.wait(7)) == [shot(200, host.now_us - 7 * MS)]
    assert board.mismatches == []


def test_while_it_waits_it_repeats_its_last_telemetry_under_a_running_clock() -> None:
    host = Host(laser_tape().board(), BoardKind.RANGEFINDER)
    host.open()
    said = host.wait(1000)
    times = [message.board_us for message in said if isinstance(message, BoardStatus)]
    assert len(said) == len(times) == 1000 // PERIOD_MS
    assert times == sorted(set(times))
    assert {message.state for message in said if isinstance(message, BoardStatus)} == {BoardState.CONFIGURED}


def test_telemetry_counts_on_from_zero_in_each_session() -> None:
    host = Host(laser_tape().board(), BoardKind.RANGEFINDER)
    for nonce in (1, 2):
        host.frames.clear()
        host.open(nonce)
        host.wait(500)
        opened = next(at for at, frame in enumerate(host.frames) if frame.type == HelloReply.TYPE)
        seqs = [frame.seq for frame in host.frames[opened:] if frame.type == BoardStatus.TYPE]
        assert len(seqs) >= 10
        assert seqs == list(range(len(seqs)))


def test_a_repeat_gets_the_same_answer_and_moves_nothing() -> None:
    board = laser_tape().board()
    host = Host(board, BoardKind.RANGEFINDER)
    host.open()
    host.ask(Arm())
    host.ask(SetLaser(1))
    host.wait(5)
    host.ask(Shoot(500), seq=0)
    assert host.ask(Shoot(500), seq=0) == []
    first = only(Shot, host.wait(10))
    assert host.ask(Shoot(500), seq=0) == first == [shot(100, host.now_us - 10 * MS)]
    host.ask(Shoot(500), seq=1)
    assert only(Shot, host.wait(10)) == [shot(200, host.now_us - 10 * MS)]
    assert board.mismatches == []


def test_repeats_in_the_recording_are_one_request() -> None:
    tape = Tape("rangefinder").opens()
    tape.asks(100, Shoot(500), 0).asks(150, Shoot(500), 0).says(160, shot(1), 0).says(161, shot(1), 0)
    tape.asks(200, Shoot(500), 1).says(210, shot(2), 1)
    host = Host(tape.board(), BoardKind.RANGEFINDER)
    host.open()
    ranges = []
    for _ in range(2):
        host.ask(Shoot(500))
        ranges += [message.range_mm for message in host.wait(100) if isinstance(message, Shot)]
    assert ranges == [1, 2]


def test_bookkeeping_that_the_host_leaves_out_is_passed_over_and_told() -> None:
    tape = laser_tape((100,)).asks(2000, Stop(), 0xFFFF).says(2001, Ack(Result.OK), 0xFFFF, to=Stop)
    tape.says(2001, status(BoardState.CONFIGURED)).arms(3000, seq=1)
    tape.asks(3100, Shoot(500), 1).says(3107, shot(200), 1)
    board = tape.board()
    host = Host(board, BoardKind.RANGEFINDER)
    host.open()
    for request in (Arm(), SetLaser(1), Shoot(500)):
        host.ask(request)
        host.wait(10)
    host.ask(Shoot(500))
    assert only(Shot, host.wait(10)) == [shot(200, host.now_us - 10 * MS)]
    assert [(d.expected, d.actual) for d in board.mismatches] == [("Stop()", "nothing"), ("Arm()", "nothing")]


def test_what_was_never_asked_is_improvised_and_shown_and_leads_nowhere_else() -> None:
    board = laser_tape().board()
    host = Host(board, BoardKind.RANGEFINDER)
    host.open()
    host.ask(Arm())
    host.wait(10)
    stopped = host.ask(Stop(), seq=0xFFFF)
    assert stopped[0] == Ack(Result.OK)
    assert isinstance(stopped[1], BoardStatus)
    assert stopped[1].state == BoardState.CONFIGURED
    assert host.ask(Stop(), seq=0xFFFF) == [Ack(Result.OK)], "a volley is one"
    shown = {message.state for message in host.wait(500) if isinstance(message, BoardStatus)}
    assert shown == {BoardState.CONFIGURED}
    assert board.mismatches == [], "a stop may come at any time"
    host.ask(Arm())
    assert len(board.mismatches) == 1
    host.ask(SetLaser(1))
    host.wait(10)
    host.ask(Shoot(500))
    assert only(Shot, host.wait(10)) == [shot(100, host.now_us - 10 * MS)], "the readings go on where they were"
    assert len(board.mismatches) == 1


@pytest.mark.parametrize(
    ("request_", "state", "faults"),
    [(Kill(), BoardState.FAULT, Fault.KILLED), (Clear(), BoardState.CONFIGURED, Fault.NONE)],
)
def test_improvised_states_are_those_of_a_healthy_board(request_: Message, state: BoardState, faults: Fault) -> None:
    host = Host(laser_tape().board(), BoardKind.RANGEFINDER)
    host.open()
    host.wait(60)
    said = only(BoardStatus, host.ask(request_) + host.wait(60))
    assert {(m.state, m.faults) for m in said if isinstance(m, BoardStatus)} == {(state, faults)}


def test_beyond_its_end_the_fake_stays_alive_and_expects_nothing() -> None:
    board = Tape("pantilt").opens().board()
    host = Host(board, BoardKind.PANTILT)
    host.open()
    host.wait(10)
    assert board.finished
    assert host.ask(Arm())[0] == Ack(Result.OK)
    host.ask(Aim(5, 6, 900))
    report = [message for message in host.wait(100) if isinstance(message, AimReport)][-1]
    assert replace(report, board_us=0) == AimReport(0, 5, 6, 0, Motion.DONE)
    assert board.mismatches == []


def test_a_shot_beyond_the_end_is_not_measured() -> None:
    host = Host(laser_tape(()).board(), BoardKind.RANGEFINDER)
    host.open()
    for request in (Arm(), SetLaser(1)):
        host.ask(request)
    assert only(Shot, host.ask(Shoot(500))) == [Shot(host.now_us, 0, 0, ShotStatus.NOT_MEASURED)]


def test_a_recorded_refusal_is_refused_again() -> None:
    tape = Tape("drive").opens().asks(100, Arm(), 0).says(101, Nack(Result.WRONG_STATE, Arm.TYPE), 0)
    host = Host(tape.board(), BoardKind.DRIVE)
    host.open()
    assert not only(Nack, host.ask(Arm()))
    assert only(Nack, host.wait(5)) == [Nack(Result.WRONG_STATE, Arm.TYPE)]


def test_a_lost_line_is_lost_again_and_the_next_session_follows() -> None:
    tape = Tape("drive").opens(0, nonce=1, boot_id=5).says(60, odometry(1))
    tape.asks(99, Stop(), 0xFFFF).says(99, status(BoardState.CONFIGURED)).cut(100)
    tape.opens(1000, nonce=2, boot_id=6).says(1060, odometry(2)).arms(1100)
    board = tape.board()
    host = Host(board, BoardKind.DRIVE)
    (first, *_) = host.open(nonce=100)
    assert isinstance(first, HelloReply)
    assert first.boot_id == 5
    assert odometry(1) in [replace(m, board_us=0) for m in host.wait(100) if isinstance(m, OdometryReport)]
    assert host.wait(2000) == [], "silence, so that the host finds the line lost"
    assert not board.finished
    (second, *_) = host.open(nonce=101)
    assert isinstance(second, HelloReply)
    assert second.boot_id == 6
    assert {m.translate_counts for m in host.wait(500) if isinstance(m, OdometryReport)} == {2}
    assert board.mismatches == []


def test_a_fresh_daemon_begins_at_the_beginning() -> None:
    board = laser_tape().board()
    for nonce in (1, 2, 3):
        host = Host(board, BoardKind.RANGEFINDER, now_ms=10_000.0 * nonce)
        host.open(nonce)
        for request in (Arm(), SetLaser(1)):
            host.ask(request)
            host.wait(10)
        host.ask(Shoot(500))
        assert only(Shot, host.wait(10)) == [shot(100, host.now_us - 10 * MS)]
    assert board.mismatches == []


def test_a_repeated_hello_is_not_a_fresh_daemon() -> None:
    host = Host(laser_tape().board(), BoardKind.RANGEFINDER)
    assert host.ask(Hello(1, 0, 9)) == host.ask(Hello(1, 0, 9))


def test_before_hello_only_what_is_always_allowed_is_allowed() -> None:
    board = laser_tape().board()
    host = Host(board, BoardKind.RANGEFINDER)
    assert host.ask(Arm()) == [Nack(Result.WRONG_STATE, Arm.TYPE)]
    assert host.ask(Stop()) == [Ack(Result.OK)]
    assert host.wait(1000) == []
    host.open()
    assert host.ask(Arm())[-1] is not None
    assert board.mismatches == []


def test_noise_and_strange_frames_do_no_harm() -> None:
    board = laser_tape().board()
    host = Host(board, BoardKind.RANGEFINDER)
    host.open()
    board.receive(random.Random(1).randbytes(5000) + b"\0", host.now_us)
    board.take_output()
    board.receive(encode_frame(RawFrame(0x3F, 3, b"")), host.now_us)
    assert host.heard() == [Nack(Result.UNKNOWN_TYPE, 0x3F)]
    board.receive(encode_frame(RawFrame(Shoot.TYPE, 3, b"")), host.now_us)
    assert host.heard() == [Nack(Result.BAD_LENGTH, Shoot.TYPE)]
    board.receive(encode_frame(RawFrame(BoardStatus.TYPE, 3, b"")), host.now_us)
    assert host.heard() == []


def test_bytes_of_a_frame_may_be_recorded_in_pieces() -> None:
    tape = laser_tape()
    pieces: list[Entry] = []
    for entry in tape.entries:
        assert isinstance(entry, BytesEntry)
        pieces += [replace(entry, data=bytes([byte])) for byte in entry.data]
    whole, cut = tape.board(), FakeBoard(Recording(HEADER, tuple(pieces)), "rangefinder")
    assert whole._script == cut._script


def test_all_boards_come_from_one_recording() -> None:
    boards = fake_boards(Recording(HEADER, tuple(laser_tape().entries)))
    assert set(boards) == {"drive", "pantilt", "rangefinder"}
    host = Host(boards["drive"], BoardKind.DRIVE)
    host.open()
    said = host.wait(500)
    assert not only(DriveReport, said), "what was never recorded is not made up"
    with pytest.raises(RecordingError, match="no bytes of drive, pantilt, rangefinder"):
        fake_boards(Recording(HEADER, ()))
