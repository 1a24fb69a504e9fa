"""Whole sessions with a liar in them: they replay, and what a lie must not hide is seen in its time."""

import asyncio
import random
from dataclasses import replace
from pathlib import Path

import pytest

from firmware_proto.common import Pong
from firmware_proto.framing import Deframer, RawFrame, encode_frame
from robotd.app.replaying import replay_recording
from robotd.contract.events import Status
from robotd.core.clock import NS_PER_S, now_ns, run_virtual
from robotd.hardware.link.tap import Direction
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.faults.fault import Fault
from tests.studies.liars.block import READINGS, run_in
from tests.studies.liars.trial import come_to_rest, driving
from tests.support.bench import bench

HOUR_US = 3_600_000_000


@pytest.mark.parametrize("seed", [3, 8])
@pytest.mark.parametrize("state", ["idle", "map: sweep", "map: drive"])
@pytest.mark.parametrize("robot", ["own boards", "rflex, dynamixel, tfmini"])
def test_a_session_with_a_liar_replays(tmp_path: Path, robot: str, state: str, seed: int) -> None:
    (outcome,) = run_virtual(run_in(tmp_path, robot, state, range(seed, seed + 1)))
    assert not outcome.is_failure
    (recording,) = (tmp_path / "recordings").glob("*.mcap")
    assert replay_recording(recording).differences == ()


class OnePongLies(Fault):
    """The next answer to a ping tells the board's time wrongly, and no other."""

    def __init__(self, lie_us: int) -> None:
        super().__init__(random.Random(0))
        self._lie_us = lie_us
        self.has_lied = asyncio.Event()

    def changed(self, data: bytes, way: Direction) -> bytes:
        if way is Direction.TO_BOARD or self.has_lied.is_set():
            return data
        return b"".join(map(self._told, Deframer().feed(data)))

    def _told(self, frame: RawFrame) -> bytes:
        if frame.type == Pong.TYPE and not self.has_lied.is_set():
            self.has_lied.set()
            pong = Pong.from_payload(frame.payload)
            pong = replace(pong, board_us=max(0, pong.board_us + self._lie_us))
            frame = RawFrame(frame.type, frame.seq, pong.to_payload())
        return encode_frame(frame)


@pytest.mark.parametrize("lie_us", [HOUR_US, -HOUR_US])
async def test_a_blocked_base_is_noticed_in_time_though_a_pong_lies_by_an_hour(tmp_path: Path, lie_us: int) -> None:
    async with bench(tmp_path, Dialects(), READINGS) as it:
        await come_to_rest(it)
        await driving(it)
        liar = OnePongLies(lie_us)
        it.cables["drive"].set_fault(liar)
        await liar.has_lied.wait()
        it.robot._body.command = lambda speed_mps, turn_radps: None  # type: ignore[method-assign]  # its wheels are held
        it.robot._body.cut()
        began_ns = now_ns()
        it.events._items.clear()
        await it.until(lambda event: isinstance(event, Status) and event.mode != "driving")
        assert (now_ns() - began_ns) / NS_PER_S < 3.5
        assert "stalled" in it.daemon.control.status.reason
