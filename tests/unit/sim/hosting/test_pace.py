"""Simulated time slows down when its process got no processor, and what lives by it does not notice."""

import asyncio
import contextlib
from collections.abc import AsyncIterator
from itertools import pairwise

import pytest

from firmware_proto.common import Arm, BoardKind, BoardState, Configure, Fault, Hello, Stop
from firmware_proto.drive_messages import OdometryReport, SetVelocity
from firmware_proto.framing import RawFrame, encode_frame
from firmware_proto.schema import Message
from robotd.core.clock import NS_PER_S
from robotd.hardware.devices.credible import LATE_S
from robotd.hardware.devices.settings import SilenceOptions
from robotd.hardware.transport.memory import memory_pair
from robotd.hardware.transport.transport import Transport
from robotd.hardware.wire.board import BoardWire
from robotd.sim.boards.drive_board import DriveBoard
from robotd.sim.buildings.world import load_world
from robotd.sim.hosting import pace
from robotd.sim.hosting.board_clock import BoardClock
from robotd.sim.hosting.host import serve
from robotd.sim.hosting.pace import (
    BEAT_NS,
    CATCHING_UP,
    HURRY_NS,
    LATE_NS,
    MOST_BEHIND_NS,
    READING_NS,
    SLOWED,
    TOO_LONG_NS,
    SlowedTime,
)
from robotd.sim.robot import SimulatedRobot


class Host:
    """The clock of a machine whose processes may get no processor."""

    def __init__(self) -> None:
        self.time_ns = 5 * NS_PER_S

    def now_ns(self) -> int:
        return self.time_ns


@pytest.fixture
def host(monkeypatch: pytest.MonkeyPatch) -> Host:
    it = Host()
    monkeypatch.setattr(pace, "now_ns", it.now_ns)
    return it


@pytest.fixture
def said() -> list[str]:
    return []


def _beat(time: SlowedTime) -> None:
    """Take one step of its beat."""
    step = time.beat().__await__()
    with pytest.raises(RuntimeError, match="no running event loop"):
        next(step)  # it would sleep now


def test_time_that_is_never_lost_is_the_hosts(host: Host, said: list[str]) -> None:
    time = SlowedTime(said.append)
    for _ in range(100):
        host.time_ns += BEAT_NS + LATE_NS
        assert time.now_ns() == host.time_ns
        assert time.wait_s(host.time_ns + NS_PER_S) == 1.0
        _beat(time)
    assert said == []


def test_time_lost_stands_still_and_is_made_up_for(host: Host, said: list[str]) -> None:
    time = SlowedTime(said.append)
    host.time_ns += BEAT_NS
    before_ns = time.now_ns()
    _beat(time)
    host.time_ns += BEAT_NS + MOST_BEHIND_NS
    assert time.now_ns() == before_ns + BEAT_NS
    assert time.wait_s(before_ns + BEAT_NS + NS_PER_S) == pytest.approx(1.0 / CATCHING_UP)
    seen_ns = [time.now_ns()]
    for _ in range(round(MOST_BEHIND_NS / BEAT_NS / (CATCHING_UP - 1.0))):
        assert seen_ns[-1] < host.time_ns
        _beat(time)
        host.time_ns += BEAT_NS
        seen_ns.append(time.now_ns())
    steps_ns = {later - earlier for earlier, later in pairwise(seen_ns)}
    assert steps_ns == {round(CATCHING_UP * BEAT_NS)}
    assert seen_ns[-1] == host.time_ns
    assert said == [SLOWED]


@pytest.mark.parametrize("lost_s", [0.4, 0.5, 1.0, 3.0, 10.0])
def test_much_time_lost_is_made_up_for_as_soon_as_what_waited_was_read(
    host: Host, said: list[str], lost_s: float
) -> None:
    time = SlowedTime(said.append)
    before_ns = time.now_ns()
    host.time_ns += BEAT_NS + round(lost_s * NS_PER_S)
    assert time.now_ns() == before_ns + BEAT_NS
    woken_ns, seen_ns = host.time_ns, [(host.time_ns, before_ns + BEAT_NS)]
    while host.time_ns < woken_ns + NS_PER_S:
        _beat(time)
        host.time_ns += BEAT_NS
        seen_ns.append((host.time_ns, time.now_ns()))
    read_ns = [
        later - earlier for (at, earlier), (_, later) in pairwise(seen_ns) if at + BEAT_NS < woken_ns + READING_NS
    ]
    assert read_ns
    assert set(read_ns) == {round(CATCHING_UP * BEAT_NS)}
    behind_s = {(at - woken_ns) // BEAT_NS: (at - seen) / NS_PER_S for at, seen in seen_ns}
    assert behind_s[2 * TOO_LONG_NS // BEAT_NS] < LATE_S, "a daemon would take it for a liar"
    most_ns = max(later - earlier for (_, earlier), (_, later) in pairwise(seen_ns))
    assert most_ns <= BEAT_NS * (CATCHING_UP + lost_s * NS_PER_S / HURRY_NS), "it hurries, and does not leap"


@pytest.mark.parametrize("first_s", [0.1, 3.5])
@pytest.mark.parametrize("look_ms", [80, 150, 300])
def test_time_that_is_lost_all_the_time_falls_no_farther_behind_than_a_daemon_believes(
    host: Host, said: list[str], look_ms: int, first_s: float
) -> None:
    time, late_since_ns = SlowedTime(said.append), None
    host.time_ns += round(first_s * NS_PER_S)
    for _ in range(100):
        host.time_ns += look_ms * 1_000_000
        is_late = host.time_ns - time.now_ns() > LATE_S * NS_PER_S
        late_since_ns = (late_since_ns or host.time_ns) if is_late else None
        assert late_since_ns is None or host.time_ns - late_since_ns < SilenceOptions().silence_s * NS_PER_S


def test_time_never_runs_backwards_however_it_is_asked(host: Host, said: list[str]) -> None:
    time, last_ns = SlowedTime(said.append), 0
    for step_ms in (0, 1, 69, 71, 500, 0, 3, 90, 2000, 20, 20, 70, 1, 71, 0):
        host.time_ns += step_ms * 1_000_000
        assert last_ns <= time.now_ns() <= host.time_ns
        last_ns = time.now_ns()


@pytest.mark.parametrize("frozen_s", [0.3, 0.45, 0.5, 0.7, 1.0, 5.0])
async def test_a_deadman_does_not_run_out_while_the_simulator_stands_still(
    host: Host, said: list[str], frozen_s: float
) -> None:
    """What waits on the line is read first: a set-point, or the stop of a daemon that heard nothing for too long."""
    async with _driven(host, SlowedTime(said.append)) as base:
        await base.freeze(frozen_s)
        await base.run(2.0)
        assert base.board.faults is Fault.NONE
        assert base.board.state is (BoardState.CONFIGURED if frozen_s > base.SILENCE_S else BoardState.ARMED)


@pytest.mark.parametrize("frozen_s", [0.1, 0.3, 0.45])
async def test_a_deadman_does_not_run_out_while_it_stands_still_again_and_again(
    host: Host, said: list[str], frozen_s: float
) -> None:
    async with _driven(host, SlowedTime(said.append)) as base:
        for _ in range(20):
            await base.freeze(frozen_s)
            await base.run(0.12)
        assert (base.board.state, base.board.faults) == (BoardState.ARMED, Fault.NONE)


async def test_the_hosts_own_time_would_have_let_it_run_out(host: Host) -> None:
    async with _driven(host, pace.HostTime()) as base:
        await base.freeze(0.45)
        await base.run(0.1)
        assert (base.board.state, base.board.faults) == (BoardState.FAULT, Fault.DEADMAN)


async def test_a_daemon_that_is_gone_lets_it_run_out(host: Host, said: list[str]) -> None:
    async with _driven(host, SlowedTime(said.append)) as base:
        base.is_gone = True
        await base.run(0.5)
        assert (base.board.state, base.board.faults) == (BoardState.FAULT, Fault.DEADMAN)


class _Driven:
    """A simulated base whose process can be frozen, and a daemon that is well: it answers odometry with set-points."""

    SILENCE_S = 0.5
    TTL_MS = 400

    def __init__(self, host: Host, board: DriveBoard, line: Transport) -> None:
        self.board = board
        self.is_gone = False
        self._host = host
        self._line = line
        self._wire = BoardWire(BoardKind.DRIVE)
        self._seq = 10

    async def begin(self) -> None:
        for seq, message in enumerate((Hello(1, 0, 7), Configure(40, 500), Arm(), SetVelocity(100, 0, self.TTL_MS))):
            _write(self._line, message, seq)
            await self.run(0.02)
        assert self.board.state is BoardState.ARMED

    async def freeze(self, seconds: float) -> None:
        """Let the daemon live on alone: half a second after the last word it says stop."""
        self._host.time_ns += round(seconds * NS_PER_S)
        if seconds > self.SILENCE_S:
            _write(self._line, Stop(), 9)
            self.is_gone = True

    async def run(self, seconds: float) -> None:
        for _ in range(round(seconds / 0.01)):
            self._host.time_ns += NS_PER_S // 100
            await asyncio.sleep(0.01)

    async def answer(self) -> None:
        while True:
            heard = self._wire.feed(await self._line.read())
            if any(isinstance(one.message, OdometryReport) for one in heard) and not self.is_gone:
                self._seq += 1
                _write(self._line, SetVelocity(100, 0, self.TTL_MS), self._seq)


@contextlib.asynccontextmanager
async def _driven(host: Host, time: pace.Time) -> AsyncIterator[_Driven]:
    board = SimulatedRobot(load_world("office"), 1).boards["drive"]
    assert isinstance(board, DriveBoard)
    near, far = memory_pair("drive")
    lines = asyncio.Queue[Transport]()
    lines.put_nowait(far)
    base = _Driven(host, board, near)
    living = asyncio.gather(serve(board, BoardClock(), lines, time=time), time.beat(), base.answer())
    try:
        await base.begin()
        yield base
    finally:
        living.cancel()
        await asyncio.gather(living, return_exceptions=True)
        near.close()


def _write(line: Transport, message: Message, seq: int) -> None:
    line.write(encode_frame(RawFrame(message.TYPE, seq, message.to_payload())))
