"""A conversation with an emulated board, over a line that loses, repeats, garbles and dies as it is told."""

import asyncio
import random
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress

import pytest

from firmware_proto.common import Ack, Arm, BoardKind, BoardState, BoardStatus, Disarm, Ping, Pong
from firmware_proto.drive_messages import SetVelocity
from firmware_proto.framing import RawFrame, encode_frame
from firmware_proto.pantilt_messages import Aim, Limits, ReadLimits
from firmware_proto.rangefinder_messages import SetLaser, Shoot, Shot
from firmware_proto.schema import REPLY, Message
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import DeviceError, LinkTimeout, RemoteProtocolError, TransportError
from robotd.hardware.link.clock_sync import ClockSync
from robotd.hardware.link.handshake import Terms, shake_hands
from robotd.hardware.link.round_trip import TIMEOUT_MAX_S
from robotd.hardware.link.session import TRIES, LinkCounters, Session
from robotd.hardware.link.tapped import TappedLine
from robotd.hardware.transport.memory import memory_pair
from robotd.hardware.wire.board import STOP_BYTES, BoardWire, Received
from robotd.sim.boards.emulated_board import Board, Outcome
from robotd.sim.buildings.world import load_world
from robotd.sim.physics.laser import LaserSettings
from robotd.sim.robot import SimSettings, SimulatedRobot
from robotd.sim.runtime import connectors
from tests.support.own_boards import own_board
from tests.support.taps import NoTap
from tests.unit.hardware.conftest import FaultyLine, lose, never, once

MS = 1_000_000


class Bench:
    """A session with one board of a simulated robot, and everything around it."""

    def __init__(self, robot: SimulatedRobot, kind: BoardKind, line: FaultyLine) -> None:
        self.device = kind.name.lower()
        self.board: Board = own_board(robot, self.device)
        self.clock = robot.clocks[self.device]
        self.line = line
        self.wire = BoardWire(kind)
        self.counters = LinkCounters()
        self.telemetry: list[Message] = []
        self.session = Session(
            self.device,
            TappedLine(self.device, line, NoTap()),
            self.wire,
            counters=self.counters,
            on_telemetry=self.telemetry.append,
            silence_s=1.0,
        )


@asynccontextmanager
async def bench(
    kind: BoardKind, *, noise: Callable[[], bytes] = bytes, sim: SimSettings | None = None
) -> AsyncIterator[Bench]:
    """Open a session and shake hands."""
    robot = SimulatedRobot(load_world("office"), seed=3, settings=sim)
    async with connectors(robot) as connect:
        line = FaultyLine(await connect[kind.name.lower()]())
        line.noise = noise
        bench = Bench(robot, kind, line)
        async with bench.session:
            await shake_hands(bench.session, Terms(kind, 40, 500), 0xC0FFEE, {})
            yield bench
        line.close()


@asynccontextmanager
async def serving(bench: Bench) -> AsyncIterator[None]:
    """Let telemetry flow meanwhile."""
    task = asyncio.create_task(bench.session.serve())
    try:
        yield
    finally:
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task


async def test_the_handshake_configures_the_board_and_finds_its_clock() -> None:
    async with bench(BoardKind.DRIVE) as b:
        assert b.board.state is BoardState.CONFIGURED
        assert b.session.boot_id == b.board._boot_id
        true_us = now_ns() // 1000
        assert abs(b.session.clock.host_ns(b.clock.board_us(true_us)) - true_us * 1000) < 1 * MS


async def test_a_board_that_does_not_give_our_time_back_is_refused() -> None:
    async with bench(BoardKind.DRIVE) as b:
        b.board._handlers[Ping] = lambda ping, seq: Pong(0, b.board._now_us)
        b.session.clock = ClockSync()
        await asyncio.sleep(5.0)  # our own time is past what a round trip may take
        with pytest.raises(RemoteProtocolError, match="no answer to a ping tells the board's time"):
            await shake_hands(b.session, Terms(BoardKind.DRIVE, 40, 500), 1, {})


async def test_the_clock_stays_true_while_the_board_drifts() -> None:
    async with bench(BoardKind.DRIVE) as b, serving(b):
        assert b.clock.skew_ppb != 0
        await asyncio.sleep(60.0)
        true_us = now_ns() // 1000
        assert abs(b.session.clock.host_ns(b.clock.board_us(true_us)) - true_us * 1000) < 50_000


async def test_telemetry_is_handed_on_while_serving_and_not_before() -> None:
    async with bench(BoardKind.DRIVE) as b:
        await asyncio.sleep(0.2)
        assert b.telemetry == []
        async with serving(b):
            await asyncio.sleep(0.2)
        assert {type(message) for message in b.telemetry} >= {BoardStatus}


async def test_a_lost_request_is_repeated_with_the_same_seq_and_executed_once() -> None:
    async with bench(BoardKind.DRIVE) as b:
        b.line.to_board = lose(2, Arm.TYPE)
        await b.session.command(Arm())
        assert b.board.state is BoardState.ARMED
        assert len({frame.seq for frame in b.line.sent if frame.type == Arm.TYPE}) == 1
        assert (b.counters.retries, b.counters.timeouts) == (2, 0)


async def test_a_lost_reply_is_given_again_and_the_shot_is_taken_once() -> None:
    async with bench(BoardKind.RANGEFINDER) as b:
        await b.session.command(SetLaser(1))
        b.line.from_board = lose(1, Shot.TYPE)
        taken: list[int] = []
        shoot = b.board._handlers[Shoot]

        def counted(request: Shoot, seq: int) -> Outcome:
            taken.append(seq)
            return shoot(request, seq)

        b.board._handlers[Shoot] = counted
        shot = await b.session.ask(Shoot(100), Shot, takes_s=0.1)
        assert shot.range_mm > 0
        assert len(taken) == 1
        assert b.line.count(Shoot) == 2


async def test_a_measurement_that_takes_long_is_waited_for() -> None:
    slow = SimSettings(laser=LaserSettings(takes_us=700_000))
    async with bench(BoardKind.RANGEFINDER, sim=slow) as b, serving(b):
        await b.session.command(SetLaser(1))
        assert (await b.session.ask(Shoot(800), Shot, takes_s=0.8)).range_mm > 0
        b.line.from_board = lambda frame: frame.type != Shot.TYPE
        began_ns = now_ns()
        with pytest.raises(LinkTimeout):
            await b.session.ask(Shoot(800), Shot, takes_s=0.8)
        assert 0.8 < (now_ns() - began_ns) / NS_PER_S <= 0.8 + 3 * TIMEOUT_MAX_S


async def test_three_tries_without_an_answer_are_a_timeout_and_nothing_is_repeated_for_ever() -> None:
    async with bench(BoardKind.PANTILT) as b:
        b.line.to_board = never
        before = b.line.count(ReadLimits)
        with pytest.raises(LinkTimeout, match="pantilt: no answer to ReadLimits in 3 tries"):
            await b.session.ask(ReadLimits(), Limits)
        assert b.line.count(ReadLimits) - before == 3
        b.line.to_board = once
        assert (await b.session.ask(ReadLimits(), Limits)).pan_max_tenth_mrad > 0


@pytest.mark.parametrize(
    ("request_", "code"), [(Aim(0, 0, 100), "wrong_state"), (SetLaser(7), "unknown_type")], ids=["state", "unknown"]
)
async def test_a_refusal_is_a_device_error_with_the_result(request_: Message, code: str) -> None:
    async with bench(BoardKind.PANTILT) as b:
        with pytest.raises(DeviceError) as caught:
            await b.session.command(request_)
        assert (caught.value.device, caught.value.code) == ("pantilt", code)


async def test_repeated_replies_are_counted_and_change_nothing() -> None:
    async with bench(BoardKind.PANTILT) as b:
        b.line.from_board = lambda frame: 2
        first = await b.session.ask(ReadLimits(), Limits)
        assert await b.session.ask(ReadLimits(), Limits) == first
        await asyncio.sleep(0.01)
        assert b.counters.unmatched >= 2


async def test_an_old_reply_is_not_taken_for_a_new_one() -> None:
    async with bench(BoardKind.DRIVE) as b:
        kept: list[RawFrame] = []

        def keep(frame: RawFrame) -> int:
            kept.append(frame)
            return 0

        b.line.from_board = keep
        with pytest.raises(LinkTimeout):
            await b.session.ask(Ping(1), Pong)
        b.line.from_board = once
        b.line.noise = lambda: encode_frame(kept[0])
        assert (await b.session.ask(Ping(2), Pong)).host_us == 2


async def test_garbage_between_the_frames_is_counted_and_survived() -> None:
    randomness = random.Random(5)
    async with bench(BoardKind.DRIVE, noise=lambda: randomness.randbytes(20)) as b:
        for _ in range(20):
            await b.session.command(Arm())
            await b.session.command(Disarm())
        counters = b.wire.counters
        assert counters.crc_errors + counters.cobs_errors + counters.length_errors > 20


async def test_a_request_ends_at_once_when_the_line_is_lost() -> None:
    async with bench(BoardKind.DRIVE) as b:
        b.line.from_board = never
        asking = asyncio.create_task(b.session.command(Arm()))
        await asyncio.sleep(0.005)
        lost_ns = now_ns()
        b.line.close()
        with pytest.raises(TransportError, match="closed"):
            await asking
        assert now_ns() - lost_ns < 5 * MS
        with pytest.raises(TransportError):
            b.session.post(SetVelocity(0, 0, 100))


async def test_requests_wait_for_each_other() -> None:
    async with bench(BoardKind.DRIVE) as b:
        await asyncio.gather(*(b.session.command(Arm()) for _ in range(5)), b.session.command(Disarm()))
        assert b.board.state is BoardState.CONFIGURED
        assert b.counters.retries == 0


async def test_set_points_are_never_repeated_and_refusals_are_counted() -> None:
    async with bench(BoardKind.DRIVE) as b:
        b.line.to_board = lose(1, SetVelocity.TYPE)
        for speed in (100, 200, 300):
            b.session.post(SetVelocity(speed, 0, 200))
        await asyncio.sleep(0.5)
        sent = [frame.seq for frame in b.line.sent if frame.type == SetVelocity.TYPE]
        assert sent == [0, 1, 2]
        assert b.counters.refused == 2


def fill(session: Session) -> None:
    for _ in range(10_000):
        session.post(SetVelocity(300, 0, 500))


async def test_stop_overtakes_what_waits_on_a_stuck_line() -> None:
    near, far = memory_pair()
    line = TappedLine("drive", near, NoTap())
    session = Session(
        "drive",
        line,
        BoardWire(BoardKind.DRIVE),
        counters=LinkCounters(),
        on_telemetry=lambda message: None,
        silence_s=1.0,
    )
    async with session:
        with pytest.raises(TransportError, match="stuck"):
            fill(session)
        session.stop_now()
        received = b""
        while STOP_BYTES not in received:
            received += await far.read()
        assert len(received) < 8192 + len(STOP_BYTES)
    far.close()
    line.close()


async def test_stop_brings_the_board_to_rest_and_no_repeat_of_an_arm_comes_after_it() -> None:
    async with bench(BoardKind.DRIVE) as b:
        b.line.from_board = lambda frame: frame.type != Arm.TYPE | REPLY
        arming = asyncio.create_task(b.session.command(Arm()))
        await asyncio.sleep(0.01)
        before = b.board.state
        b.session.stop_now()
        with pytest.raises(DeviceError, match="stopped"):
            await arming
        await asyncio.sleep(1.0)
        assert (before, b.board.state) == (BoardState.ARMED, BoardState.CONFIGURED)
        assert b.line.count(Arm) == 1


async def test_an_arm_that_waits_for_its_turn_is_given_up_by_a_stop() -> None:
    async with bench(BoardKind.DRIVE) as b:
        b.line.from_board = lambda frame: frame.type != Disarm.TYPE | REPLY
        asked = asyncio.gather(b.session.command(Disarm()), b.session.command(Arm()), return_exceptions=True)
        await asyncio.sleep(0.01)
        b.session.stop_now()
        timeout, stopped = await asked
        assert isinstance(timeout, LinkTimeout)
        assert isinstance(stopped, DeviceError)
        assert stopped.code == "stopped"
        assert b.line.count(Arm) == 0


async def test_stop_on_a_dead_line_raises_nothing() -> None:
    async with bench(BoardKind.DRIVE) as b:
        b.line.close()
        b.session.stop_now()


async def test_a_silent_board_ends_the_session_after_a_second() -> None:
    async with bench(BoardKind.DRIVE) as b:
        b.line.from_board = never
        began_ns = now_ns()
        with pytest.raises(LinkTimeout, match="silent for 1 s"):
            await b.session.serve()
        assert abs(now_ns() - began_ns - NS_PER_S) < 50 * MS


async def test_a_board_that_restarts_voids_the_session_though_it_answers_pings() -> None:
    async with bench(BoardKind.DRIVE) as b:
        task = asyncio.create_task(b.session.serve())
        await asyncio.sleep(3.0)
        b.board.reboot(boot_id=99)
        with pytest.raises(LinkTimeout, match="silent"):
            async with asyncio.timeout(1.2):
                await task


@pytest.mark.parametrize(
    "status",
    [BoardStatus(10**12, BoardState.BOOT, 0, 0, 0, 0), BoardStatus(0, BoardState.CONFIGURED, 0, 0, 0, 0)],
    ids=["not configured", "clock went back"],
)
async def test_a_board_in_a_state_that_is_not_ours_voids_the_session(status: BoardStatus) -> None:
    async with bench(BoardKind.DRIVE) as b:
        task = asyncio.create_task(b.session.serve())
        await asyncio.sleep(0.1)
        b.line.noise = lambda: encode_frame(RawFrame(BoardStatus.TYPE, 7, status.to_payload()))
        with pytest.raises(RemoteProtocolError, match="restarted"):
            await task


async def test_a_result_that_we_do_not_know_is_named_by_its_number() -> None:
    async with bench(BoardKind.DRIVE) as b:
        b.line.from_board = never
        arming = asyncio.create_task(b.session.command(Arm()))
        await asyncio.sleep(0.01)
        b.session._take(Received(Arm.TYPE | REPLY, 0, Ack(77)), now_ns())
        with pytest.raises(DeviceError, match="result_77"):
            await arming


async def test_a_request_is_repeated_for_as_long_as_a_board_may_be_late_though_its_telemetry_comes() -> None:
    async with bench(BoardKind.PANTILT) as b:
        serving = asyncio.create_task(b.session.serve())
        await asyncio.sleep(0.1)
        b.line.from_board = lambda frame: frame.type != Limits.TYPE
        asking = asyncio.create_task(b.session.ask(ReadLimits(), Limits))
        await asyncio.sleep(0.7)
        assert not asking.done()
        b.line.from_board = lambda _frame: True
        assert isinstance(await asking, Limits)
        assert b.counters.retries >= TRIES
        b.line.from_board = lambda frame: frame.type != Limits.TYPE
        began_ns = now_ns()
        with pytest.raises(LinkTimeout, match="no answer to ReadLimits"):
            await b.session.ask(ReadLimits(), Limits)
        assert 1.0 <= (now_ns() - began_ns) / NS_PER_S <= TRIES * TIMEOUT_MAX_S
        assert b.counters.timeouts == 1
        assert not serving.done()
        serving.cancel()
        await asyncio.wait({serving})


async def test_a_request_on_a_line_on_which_nothing_is_heard_is_repeated_until_it_is_lost() -> None:
    async with bench(BoardKind.PANTILT) as b:
        serving = asyncio.create_task(b.session.serve())
        await asyncio.sleep(0.1)
        heard, b.line.from_board = b.line.from_board, never
        asking = asyncio.create_task(b.session.ask(ReadLimits(), Limits))
        await asyncio.sleep(0.85)
        assert not asking.done()
        b.line.from_board = heard
        assert isinstance(await asking, Limits)
        assert b.counters.retries > TRIES
        assert b.counters.timeouts == 0
        b.line.from_board = never
        with pytest.raises(TransportError, match="silent for 1 s"):
            await b.session.ask(ReadLimits(), Limits)
        with pytest.raises(LinkTimeout, match="silent for 1 s"):
            await serving
