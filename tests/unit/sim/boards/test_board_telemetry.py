"""What any emulated board says unasked, and when, by its own clock."""

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
    Ping,
    Pong,
)
from firmware_proto.rangefinder_messages import ShotStatus
from firmware_proto.schema import Message
from robotd.hardware.wire.board import BoardWire, Received
from robotd.sim.boards.rangefinder_board import RangefinderBoard
from robotd.sim.physics.plant import ShotAnswer
from tests.support.own_boards import KILL_BYTES

START_US = 1_000_000
PERIOD_US = 50_000


class Dark:
    """A laser that nobody uses: the common part of a board is all there is."""

    def switch(self, *, on: bool) -> None:
        pass

    def shoot(self, at_us: int) -> ShotAnswer:
        return ShotAnswer(ShotStatus.WEAK, 0.0, 0, 1000)


class Line:
    """A board and its host's wire."""

    def __init__(self, *requests: Message) -> None:
        self.board = RangefinderBoard(Dark(), boot_id=1)
        self.wire = BoardWire(BoardKind.RANGEFINDER)
        for request in requests:
            self.send(request)

    def send(self, request: Message, at_us: int = START_US) -> list[Received]:
        self.board.receive(self.wire.encode(request, 0), at_us)
        return self.heard()

    def wait(self, until_us: int) -> list[Received]:
        self.board.advance(until_us)
        return self.heard()

    def heard(self) -> list[Received]:
        return self.wire.feed(self.board.take_output())


def _configured() -> Line:
    return Line(Hello(1, 0, 1), Configure(50, 500))


def test_no_telemetry_before_configure() -> None:
    assert Line().wait(9_000_000) == []
    assert Line(Hello(1, 0, 1)).wait(9_000_000) == []


def test_a_new_hello_silences_telemetry() -> None:
    line = _configured()
    assert len(line.send(Hello(1, 0, 2))) == 1
    assert line.board.next_event_us is None
    assert line.wait(9_000_000) == []
    line.board.receive(KILL_BYTES, 9_000_000)
    assert [one.message for one in line.heard()] == [Ack(0)]


def test_a_new_session_counts_from_zero() -> None:
    line = _configured()
    line.wait(START_US + 5 * PERIOD_US)
    line.send(Hello(1, 0, 2), at_us=START_US + 5 * PERIOD_US)
    _, status = line.send(Configure(50, 500), at_us=START_US + 5 * PERIOD_US)
    assert status.seq == 0


def test_configure_is_followed_at_once_by_the_status_every_time() -> None:
    line = Line(Hello(1, 0, 1))
    for seq in (0, 1):
        line.board.receive(line.wire.encode(Configure(50, 500), seq), START_US)
        reply, status = line.heard()
        assert isinstance(reply.message, ConfigureReply)
        assert status.message == BoardStatus(START_US, BoardState.CONFIGURED, 0, 0, 0, 0)
        assert status.seq == seq


def test_telemetry_comes_in_its_period_with_its_own_times_and_counters() -> None:
    line = _configured()
    statuses = line.wait(START_US + 20 * PERIOD_US)
    assert [one.seq for one in statuses] == list(range(1, 21))
    times = [one.message.board_us for one in statuses if isinstance(one.message, BoardStatus)]
    assert times == [START_US + PERIOD_US * n for n in range(1, 21)]
    assert line.wire.counters.telemetry_gaps == 0


def test_the_telemetry_counter_wraps() -> None:
    line = Line(Hello(1, 0, 1), Configure(1, 500))
    statuses = line.wait(START_US + 65_537_000)
    assert [one.seq for one in statuses[-3:]] == [65535, 0, 1]
    assert line.wire.counters.telemetry_gaps == 0


def test_a_change_of_state_is_told_at_once_and_after_the_answer() -> None:
    line = _configured()
    answer, status = line.send(Arm())
    assert answer.message == Ack(0)
    assert status.message == BoardStatus(START_US, BoardState.ARMED, 0, 0, 0, 0)
    line.board.receive(KILL_BYTES, START_US + 5)
    _, status = line.heard()
    assert status.message == BoardStatus(START_US + 5, BoardState.FAULT, Fault.KILLED, 0, 0, 0)


def test_an_unchanged_state_is_not_told_again() -> None:
    line = _configured()
    assert len(line.send(Ping(1))) == 1


def test_what_is_said_does_not_depend_on_how_time_is_cut() -> None:
    said = []
    for step_us in (1000, 7000, 1_000_000):
        line = _configured()
        for at_us in range(START_US, START_US + 1_000_000, step_us):
            line.board.advance(at_us)
        line.board.advance(START_US + 1_000_000)
        said.append(line.board.take_output())
    assert said[0] == said[1] == said[2] != b""


def test_pong_gives_the_boards_own_time() -> None:
    (pong,) = Line().send(Ping(42), at_us=123_456_789)
    assert pong.message == Pong(42, 123_456_789)


def test_time_never_goes_back() -> None:
    line = Line()
    line.board.advance(5_000_000)
    (pong,) = line.send(Ping(1), at_us=4_000_000)
    assert pong.message == Pong(1, 5_000_000)


def test_a_board_says_when_it_wants_attention() -> None:
    assert Line().board.next_event_us is None
    assert Line(Hello(1, 0, 1)).board.next_event_us is None
    line = _configured()
    assert line.board.next_event_us == START_US + PERIOD_US
    line.wait(START_US + PERIOD_US)
    assert line.board.next_event_us == START_US + 2 * PERIOD_US
