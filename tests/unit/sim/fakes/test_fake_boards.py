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
from firmware_proto.dictionary import answers_for, dictionary_for
from firmware_proto.drive_messages import DriveReport, OdometryReport, SetVelocity
from firmware_proto.framing import Deframer, RawFrame, encode_frame
from firmware_proto.pantilt_messages import Aim, AimReadback, AimReport, Limits, Motion, ReadAim, ReadLimits
from firmware_proto.rangefinder_messages import SetLaser, Shoot, Shot, ShotStatus
from firmware_proto.schema import REPLY, Message
from robotd.core.errors import RecordingError
from robotd.hardware.link.tap import Direction
from robotd.recording.entries import BytesEntry, Entry, LineEntry, RecordingHeader
from robotd.recording.reader import Recording
from robotd.sim.fakes.fake_boards import FakeBoard, fake_boards

MS = 1000
HEADER = RecordingHeader("0.1.0", "", 1, 0, 0)
PERIOD_MS = 50


class Tape:
    """Writes a recording of one line by hand, in milliseconds."""

    def __init__(self, device: str) -> None:
        self.device = device
        self.entries: list[Entry] = []

    def asks(self, at_ms: float, message: Message, seq: int) -> "Tape":
        return self._put(at_ms, Direction.TO_BOARD, RawFrame(message.TYPE, seq, message.to_payload()))

    def says(self, at_ms: float, message: Message, seq: int = 0, to: type[Message] | None = None) -> "Tape":
        code = to.TYPE | REPLY if to else message.TYPE
        return self._put(at_ms, Direction.FROM_BOARD, RawFrame(code, seq, message.to_payload()))

    def cut(self, at_ms: float) -> "Tape":
        self.entries += [LineEntry(round(at_ms * 1e6), self.device, up=up) for up in (False, True)]
        return self

    def opens(self, at_ms: float = 0.0, nonce: int = 77, boot_id: int = 5) -> "Tape":
        self.asks(at_ms, Hello(1, 0, nonce), 0)
        self.says(at_ms + 1, HelloReply(1, 0, nonce, 10, 20, boot_id, 1_000_000))
        self.asks(at_ms + 2, Configure(PERIOD_MS, 500), 0)
        return self.says(at_ms + 3, ConfigureReply(Result.OK, 1)).says(at_ms + 3, status(BoardState.CONFIGURED))

    def arms(self, at_ms: float, seq: int = 0) -> "Tape":
        self.asks(at_ms, Arm(), seq)
        return self.says(at_ms + 1, Ack(Result.OK), seq, to=Arm).says(at_ms + 1, status(BoardState.ARMED))

    def board(self) -> FakeBoard:
        return FakeBoard(Recording(HEADER, tuple(self.entries)), self.device)

    def _put(self, at_ms: float, direction: Direction, frame: RawFrame) -> "Tape":
        self.entries.append(BytesEntry(round(at_ms * 1e6), self.device, direction, encode_frame(frame)))
        return self


def status(state: BoardState, faults: Fault = Fault.NONE) -> BoardStatus:
    return BoardStatus(0, state, faults, 0, 0, 0)


class Host:
    """A living host, as far as a test needs one."""

    def __init__(self, board: FakeBoard, kind: BoardKind, now_ms: float = 10_000.0) -> None:
        self.board = board
        self.now_us = round(now_ms * MS)
        self._deframer = Deframer()
        self._layouts = answers_for(kind)
        self._seqs: dict[type[Message], int] = {}
        self.frames: list[RawFrame] = []

    def ask(self, message: Message, seq: int | None = None) -> list[Message]:
        """Send a request and return what is said at once."""
        if seq is None:
            seq = self._seqs.get(type(message), 0)
            self._seqs[type(message)] = seq + 1
        self.seq = seq
        self.board.receive(encode_frame(RawFrame(message.TYPE, seq, message.to_payload())), self.now_us)
        return self.heard()

    def open(self, nonce: int = 1234) -> list[Message]:
        self._seqs.clear()
        hello = self.ask(Hello(1, 0, nonce))[-1]  # what comes before it is of the session before
        assert isinstance(hello, HelloReply)
        return [hello, *self.ask(Configure(PERIOD_MS, 500))]

    def wait(self, ms: float) -> list[Message]:
        """Let time pass, waking the board when it wants to be woken."""
        until_us = self.now_us + round(ms * MS)
        said: list[Message] = []
        while (due_us := self.board.next_event_us) is not None and due_us <= until_us:
            assert due_us >= self.now_us
            self.now_us = due_us
            self.board.advance(due_us)
            said += self.heard()
        self.now_us = until_us
        self.board.advance(until_us)
        return said + self.heard()

    def heard(self) -> list[Message]:
        frames = self._deframer.feed(self.board.take_output())
        self.frames += frames
        return [self._layouts[frame.type].from_payload(frame.payload) for frame in frames]


def only(kind: type[Message], said: list[Message]) -> list[Message]:
    return [message for message in said if type(message) is kind]


def shot(range_mm: int, board_us: int = 0) -> Shot:
    return Shot(board_us, range_mm, 9, ShotStatus.OK)


def laser_tape(ranges_mm: tuple[int, ...] = (100, 200, 300)) -> Tape:
    tape = Tape("rangefinder").opens().arms(1000)
    tape.asks(1100, SetLaser(1), 0).says(1101, Ack(Result.OK), 0, to=SetLaser)
    for number, range_mm in enumerate(ranges_mm):
        at_ms = 1200 + 100 * number
        tape.asks(at_ms, Shoot(500), number).says(at_ms + 7, shot(range_mm, board_us=999), number)
        tape.says(at_ms + 50, status(BoardState.ARMED))
    return tape


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


def aim_report(pan: int, seq: int, motion: Motion) -> AimReport:
    return AimReport(0, pan, 0, seq, motion)


def head_tape() -> Tape:
    tape = Tape("pantilt").opens()
    tape.asks(500, ReadLimits(), 0).says(501, Limits(-9, 9, -5, 5), 0)
    tape.arms(600)
    for number, pan in enumerate((100, 200, 300)):
        at_ms, seq = 1000 + 300 * number, 40 + number
        tape.asks(at_ms, Aim(pan, 0, 900), seq).says(at_ms + 1, Ack(Result.OK), seq, to=Aim)
        tape.says(at_ms + 50, aim_report(pan - 50, seq, Motion.TURNING))
        tape.says(at_ms + 90, aim_report(pan + number, seq, Motion.DONE))
    return tape


def test_motion_done_carries_the_seq_of_the_living_aim() -> None:
    board = head_tape().board()
    host = Host(board, BoardKind.PANTILT)
    host.open()
    host.ask(Arm())
    host.wait(10)
    for number, pan in enumerate((100, 200, 300)):
        host.ask(Aim(pan, 0, 900))
        seq = host.seq
        reports = [message for message in host.wait(200) if isinstance(message, AimReport)]
        assert (reports[0].moving, reports[0].aim_seq) == (Motion.TURNING, seq)
        assert {(r.moving, r.aim_seq, r.pan_tenth_mrad) for r in reports[1:]} == {(Motion.DONE, seq, pan + number)}
        (readback,) = host.ask(ReadAim())
        assert readback == AimReadback(host.now_us, pan + number, 0, seq, Motion.DONE)
    assert board.mismatches == []
    assert board.finished


def test_whoever_asks_during_a_motion_hears_of_this_motion() -> None:
    tape = Tape("pantilt").opens().says(60, aim_report(0, 0, Motion.HALTED)).arms(600)
    tape.asks(1000, Aim(100, 0, 900), 0).says(1001, aim_report(0, 0, Motion.HALTED))  # sent before the Aim came
    tape.says(1002, Ack(Result.OK), 0, to=Aim).says(1050, aim_report(100, 0, Motion.DONE))
    host = Host(tape.board(), BoardKind.PANTILT)
    host.open()
    host.ask(Arm())
    host.wait(100)
    assert host.ask(ReadAim()) == [AimReadback(host.now_us, 0, 0, 0, Motion.HALTED)]
    host.ask(Aim(100, 0, 900))
    host.wait(5)
    assert host.ask(ReadAim()) == [AimReadback(host.now_us, 100, 0, 0, Motion.TURNING)]
    host.wait(50)
    assert host.ask(ReadAim()) == [AimReadback(host.now_us, 100, 0, 0, Motion.DONE)]


def test_limits_are_answered_whenever_they_are_asked_for() -> None:
    host = Host(head_tape().board(), BoardKind.PANTILT)
    host.open()
    for _ in range(3):
        assert host.ask(ReadLimits()) == [Limits(-9, 9, -5, 5)]


def odometry(counts: int, speed: int = 0) -> OdometryReport:
    return OdometryReport(0, counts, 0, speed, 0)


def drive_tape() -> Tape:
    """Two motions: the counts stand at 10 before, 20, 30 and 40 in the first, and so on."""
    tape = Tape("drive").opens().arms(100).says(150, odometry(10))
    for first, seq in ((20, 0), (50, 10)):
        at_ms = 100.0 * first
        tape.asks(at_ms, SetVelocity(300, 0, 400), seq).says(at_ms + 1, Ack(Result.OK), seq, to=SetVelocity)
        tape.says(at_ms + 50, odometry(first, 300))
        tape.asks(at_ms + 51, SetVelocity(200, 0, 400), seq + 1)
        tape.says(at_ms + 100, odometry(first + 10, 200))
        tape.asks(at_ms + 101, SetVelocity(0, 0, 400), seq + 2)
        tape.says(at_ms + 150, odometry(first + 20))
    return tape


def test_the_base_stands_until_it_is_set_in_motion_and_then_goes_where_it_went() -> None:
    board = drive_tape().board()
    host = Host(board, BoardKind.DRIVE)
    host.open()
    host.ask(Arm())
    counts: list[int] = []

    def listen(ms: float) -> None:
        counts.extend(message.translate_counts for message in host.wait(ms) if isinstance(message, OdometryReport))

    for _ in range(2):
        listen(500)
        assert set(counts[-5:]) == {counts[-1]}, "it stands"
        assert host.ask(SetVelocity(0, 0, 400)) == [Ack(Result.OK)], "to stand is no motion"
        listen(100)
        assert host.ask(SetVelocity(300, 0, 400)) == [Ack(Result.OK)]
        listen(60)
        assert host.ask(SetVelocity(222, 0, 400)) == [Ack(Result.OK)], "how it is renewed does not matter"
        listen(45)
        host.ask(SetVelocity(0, 0, 400))
        listen(100)
    assert list(dict.fromkeys(counts)) == [10, 20, 30, 40, 50, 60, 70]
    assert board.mismatches == []
    assert board.finished


def test_a_deviating_request_is_told_and_answered_as_recorded() -> None:
    board = head_tape().board()
    host = Host(board, BoardKind.PANTILT)
    host.open()
    host.ask(Arm())
    host.ask(Aim(111, 0, 900))
    (difference,) = board.mismatches
    expected, got = str(Aim(100, 0, 900)), str(Aim(111, 0, 900))
    assert str(difference) == f"1.000000 s pantilt: expected {expected}, got {got}"
    assert [m.pan_tenth_mrad for m in host.wait(95) if isinstance(m, AimReport)][-1] == 100


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
