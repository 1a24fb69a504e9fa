"""Recordings of one board, spoken as a test writes them, and the living host that a fake board answers."""

from firmware_proto.common import (
    Ack,
    Arm,
    BoardKind,
    BoardState,
    BoardStatus,
    Configure,
    ConfigureReply,
    Fault,
    Hello,
    HelloReply,
    Result,
)
from firmware_proto.dictionary import answers_for
from firmware_proto.drive_messages import OdometryReport, SetVelocity
from firmware_proto.framing import Deframer, RawFrame, encode_frame
from firmware_proto.pantilt_messages import Aim, AimReport, Limits, Motion, ReadLimits
from firmware_proto.rangefinder_messages import SetLaser, Shoot, Shot, ShotStatus
from firmware_proto.schema import REPLY, Message
from robotd.hardware.link.tap import Direction
from robotd.recording.entries import BytesEntry, Entry, LineEntry, RecordingHeader
from robotd.recording.reader import Recording
from robotd.sim.fakes.fake_boards import FakeBoard

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
