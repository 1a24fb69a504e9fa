"""Simulated time slows down when its process got no processor, and what lives by it does not notice."""

import asyncio
from itertools import pairwise

import pytest

from firmware_proto.common import Arm, BoardState, Configure, Fault, Hello
from firmware_proto.drive import SetVelocity
from firmware_proto.framing import RawFrame, encode_frame
from firmware_proto.schema import Message
from robotd.core.clock import NS_PER_S
from robotd.hardware.transport.memory import memory_pair
from robotd.hardware.transport.transport import Transport
from robotd.sim.boards.drive import DriveBoard
from robotd.sim.buildings.world import load_world
from robotd.sim.hosting import pace
from robotd.sim.hosting.board_clock import BoardClock
from robotd.sim.hosting.host import serve
from robotd.sim.hosting.pace import BEAT_NS, CATCHING_UP, LATE_NS, MOST_BEHIND_NS, SLOWED, SlowedTime
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


def test_time_falls_no_further_behind_than_a_daemon_believes(host: Host, said: list[str]) -> None:
    time = SlowedTime(said.append)
    host.time_ns += 2 * NS_PER_S
    assert time.now_ns() == host.time_ns - MOST_BEHIND_NS


def test_time_never_runs_backwards_however_it_is_asked(host: Host, said: list[str]) -> None:
    time, last_ns = SlowedTime(said.append), 0
    for step_ms in (0, 1, 69, 71, 500, 0, 3, 90, 2000, 20, 20, 70, 1, 71, 0):
        host.time_ns += step_ms * 1_000_000
        assert last_ns <= time.now_ns() <= host.time_ns
        last_ns = time.now_ns()


async def test_a_deadman_does_not_run_out_while_the_simulator_stands_still(host: Host, said: list[str]) -> None:
    """The set-point that waits on the line is read before its predecessor has run out."""
    assert await _life_with_a_freeze(host, SlowedTime(said.append)) == (BoardState.ARMED, Fault.NONE)


async def test_the_hosts_own_time_would_have_let_it_run_out(host: Host) -> None:
    assert await _life_with_a_freeze(host, pace.HostTime()) == (BoardState.FAULT, Fault.DEADMAN)


async def _life_with_a_freeze(host: Host, time: pace.Time) -> tuple[BoardState, Fault]:
    robot = SimulatedRobot(load_world("office"), 1)
    board = robot.boards["drive"]
    assert isinstance(board, DriveBoard)
    near, far = memory_pair("drive")
    lines = asyncio.Queue[Transport]()
    lines.put_nowait(far)
    living = asyncio.create_task(serve(board, BoardClock(), lines, time=time))
    forward = SetVelocity(100, 0, 400)
    for seq, message in enumerate((Hello(1, 0, 7), Configure(50, 500), Arm(), forward)):
        _write(near, message, seq)
        await asyncio.sleep(0)
    await asyncio.sleep(0.01)
    assert board.state is BoardState.ARMED
    host.time_ns += NS_PER_S // 2
    _write(near, forward, 5)
    await asyncio.sleep(0.06)
    host.time_ns += 1
    await asyncio.sleep(0.06)
    living.cancel()
    await asyncio.gather(living, return_exceptions=True)
    near.close()
    return board.state, board.faults


def _write(line: Transport, message: Message, seq: int) -> None:
    line.write(encode_frame(RawFrame(message.TYPE, seq, message.to_payload())))
