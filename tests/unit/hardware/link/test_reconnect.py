"""Keeping a link up, and refusing boards that are not the one we expect."""

import asyncio
import itertools
import random
import zlib
from collections.abc import Callable
from contextlib import suppress

import pytest

from firmware_proto.common import (
    Arm,
    BoardKind,
    BoardState,
    Configure,
    ConfigureReply,
    Hello,
    HelloReply,
    Identify,
    IdentifyReply,
)
from firmware_proto.dictionary import dictionary_for
from firmware_proto.framing import Deframer
from firmware_proto.schema import Message
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import TransportError
from robotd.hardware.link.handshake import Terms
from robotd.hardware.link.reconnect import Link
from robotd.hardware.link.session import LinkCounters, Session
from robotd.hardware.link.tap import Direction
from robotd.hardware.transport.memory import memory_pair
from robotd.hardware.transport.transport import Connect, Transport
from robotd.hardware.wire.board import STOP_BYTES, BoardWire
from robotd.sim.boards.emulated_board import Board
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from robotd.sim.runtime import connectors
from tests.support.own_boards import own_board


class Tape:
    """A tap that keeps everything."""

    def __init__(self) -> None:
        self.bytes_by_direction = {direction: bytearray() for direction in Direction}
        self.times_ns: list[int] = []
        self.ups: list[bool] = []

    def bytes_passed(self, device: str, direction: Direction, time_ns: int, data: bytes) -> None:
        self.bytes_by_direction[direction] += data
        self.times_ns.append(time_ns)

    def line_broke(self, device: str, time_ns: int, reason: str) -> None:
        pass

    def line_changed(self, device: str, time_ns: int, *, up: bool) -> None:
        self.ups.append(up)
        self.times_ns.append(time_ns)


class Diary:
    """A listener that keeps everything."""

    def __init__(self) -> None:
        self.entries: list[tuple[str, int]] = []
        self.reasons: list[str] = []
        self.session: Session | None = None
        self.telemetry_count = 0

    def link_opened(self) -> None:
        self.entries.append(("opened", now_ns()))

    def link_ready(self, session: Session) -> None:
        self.session = session
        self.entries.append(("ready", now_ns()))

    async def come_to_rest(self) -> None:
        self.entries.append(("rest asked", now_ns()))

    def link_lost(self, reason: str) -> None:
        self.session = None
        self.reasons.append(reason)
        self.entries.append(("lost", now_ns()))

    def telemetry(self, message: Message) -> None:
        self.telemetry_count += 1

    @property
    def words(self) -> list[str]:
        return [word for word, _ in self.entries]


def link_to(connect: Connect, tape: Tape | None = None, kind: BoardKind = BoardKind.DRIVE) -> Link:
    return Link(
        device="drive",
        terms=Terms(kind, 40, 500),
        connect=connect,
        tap=tape or Tape(),
        rng=random.Random(1),
        dictionaries={},
        wire=BoardWire(kind),
        counters=LinkCounters(),
        silence_s=1.0,
    )


async def run_for(link: Link, diary: Diary, seconds: float) -> None:
    task = asyncio.create_task(link.run(diary))
    await asyncio.sleep(seconds)
    task.cancel()
    with suppress(asyncio.CancelledError):
        await task


def robot() -> SimulatedRobot:
    return SimulatedRobot(load_world("office"), seed=3)


async def test_an_absent_device_is_tried_again_ever_less_often_up_to_five_seconds() -> None:
    tries_ns: list[int] = []

    async def connect() -> Transport:
        tries_ns.append(now_ns())
        raise TransportError("/dev/nowhere: no such device")

    diary = Diary()
    await run_for(link_to(connect), diary, 30.0)
    gaps_s = [(after - before) / NS_PER_S for before, after in itertools.pairwise(tries_ns)]
    assert gaps_s == pytest.approx([0.25, 0.5, 1.0, 2.0, 4.0, 5.0, 5.0, 5.0, 5.0], rel=1e-6)
    assert set(diary.reasons) == {"/dev/nowhere: no such device"}


async def test_an_unplugged_device_comes_back_disarmed_and_quickly_each_time() -> None:
    lines: list[Transport] = []
    robot_ = robot()
    async with connectors(robot_) as connect:

        async def connect_and_keep() -> Transport:
            lines.append(await connect["drive"]())
            return lines[-1]

        diary = Diary()
        task = asyncio.create_task(link_to(connect_and_keep).run(diary))
        for _ in range(4):
            await asyncio.sleep(1.0)
            assert diary.session is not None
            await diary.session.command(Arm())
            assert own_board(robot_, "drive").state is BoardState.ARMED
            lines[-1].close()
            await asyncio.sleep(0.6)
            assert own_board(robot_, "drive").state.name == "CONFIGURED"
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task
    assert diary.words[:6] == ["opened", "ready", "lost"] * 2


async def test_the_tap_sees_every_byte_and_every_line_with_times_that_never_go_back() -> None:
    tape, diary = Tape(), Diary()
    async with connectors(robot()) as connect:
        await run_for(link_to(connect["drive"], tape), diary, 1.0)
    to_board = Deframer().feed(bytes(tape.bytes_by_direction[Direction.TO_BOARD]))
    from_board = Deframer().feed(bytes(tape.bytes_by_direction[Direction.FROM_BOARD]))
    assert to_board[0].type == Hello.TYPE
    assert from_board[0].type == HelloReply.TYPE
    assert tape.ups == [True, False]
    assert tape.times_ns == sorted(tape.times_ns)
    assert diary.telemetry_count > 20


async def test_the_last_word_of_a_session_is_stop_and_none_ever_arms() -> None:
    tape = Tape()
    async with connectors(robot()) as connect:
        await run_for(link_to(connect["drive"], tape), Diary(), 1.0)
    sent = bytes(tape.bytes_by_direction[Direction.TO_BOARD])
    assert sent.endswith(STOP_BYTES)
    assert Arm.TYPE not in {frame.type for frame in Deframer().feed(sent)}


async def test_the_dictionary_is_read_once_however_often_the_link_is_lost() -> None:
    tape, diary = Tape(), Diary()
    async with connectors(robot()) as connect:
        link = link_to(connect["drive"], tape)
        for _ in range(3):
            await run_for(link, diary, 0.5)
    asked = Deframer().feed(bytes(tape.bytes_by_direction[Direction.TO_BOARD]))
    pieces = -(-len(dictionary_for(BoardKind.DRIVE)) // 64)
    assert sum(frame.type == Identify.TYPE for frame in asked) == pieces
    assert list(link.dictionaries) == [zlib.crc32(dictionary_for(BoardKind.DRIVE))]
    assert link.counters.sessions == 3


async def test_a_board_that_boots_slowly_is_waited_for_on_the_same_line() -> None:
    robot_ = robot()
    board, opened = own_board(robot_, "drive"), 0
    receive = board.receive

    async with connectors(robot_) as connect:

        async def connect_and_count() -> Transport:
            nonlocal opened
            opened += 1
            return await connect["drive"]()

        board.receive = lambda data, now_us: None  # type: ignore[method-assign]  # a boot loader hears nothing
        diary = Diary()
        task = asyncio.create_task(link_to(connect_and_count).run(diary))
        await asyncio.sleep(2.0)
        board.receive = receive  # type: ignore[method-assign]  # the boot loader is done
        await asyncio.sleep(1.5)
        assert diary.words == ["opened", "ready"]
        assert opened == 1
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task


def speak(**changes: int) -> Callable[[Board], None]:
    """Let a board's HELLO say something else."""

    def spoil(board: Board) -> None:
        hello = board._handlers[Hello]

        def changed(request: Hello, seq: int) -> Message:
            reply = hello(request, seq)
            assert isinstance(reply, HelloReply)
            fields = {name: getattr(reply, name) for name in HelloReply.__slots__}
            return HelloReply(**{**fields, **changes})

        board._handlers[Hello] = changed

    return spoil


def have_another_dictionary(board: Board) -> None:
    text = zlib.decompress(board._dictionary).replace(b'"code":"h"', b'"code":"i"')
    board._dictionary = zlib.compress(text)


def have_no_dictionary(board: Board) -> None:
    board._dictionary = b"nothing that zlib knows"


def give_other_pieces(board: Board) -> None:
    board._handlers[Identify] = lambda request, seq: IdentifyReply(request.offset + 1, bytes(64))


def take_over_another_configuration(board: Board) -> None:
    board._handlers[Configure] = lambda request, seq: ConfigureReply(0, 1)


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        (speak(major=2), "the board speaks protocol 2.0, we speak 1.0"),
        (speak(nonce=1), "answered another HELLO than ours"),
        (speak(dictionary_crc32=1), "its dictionary does not fit its checksum"),
        (have_another_dictionary, "SetVelocity has fields"),
        (have_no_dictionary, "the dictionary is damaged"),
        (give_other_pieces, "another piece of its dictionary"),
        (take_over_another_configuration, "another configuration than ours"),
    ],
)
async def test_a_board_that_is_not_what_we_expect_is_refused_and_named(
    spoil: Callable[[Board], None], reason: str
) -> None:
    robot_ = robot()
    spoil(own_board(robot_, "drive"))
    diary = Diary()
    async with connectors(robot_) as connect:
        await run_for(link_to(connect["drive"]), diary, 2.0)
    assert "ready" not in diary.words
    assert reason in diary.reasons[0]
    assert diary.words.count("opened") > 1


async def test_another_device_on_the_port_is_refused_and_named() -> None:
    diary = Diary()
    async with connectors(robot()) as connect:
        await run_for(link_to(connect["pantilt"]), diary, 1.0)
    assert diary.reasons[0].startswith("drive: the board is a pantilt, not a drive")
    assert "ready" not in diary.words


async def test_a_link_that_ends_before_the_board_answered_says_stop_all_the_same() -> None:
    near, far = memory_pair()

    async def connect() -> Transport:
        return near

    tape = Tape()
    await run_for(link_to(connect, tape), Diary(), 0.2)
    far.close()
    assert bytes(tape.bytes_by_direction[Direction.TO_BOARD]).endswith(STOP_BYTES)
