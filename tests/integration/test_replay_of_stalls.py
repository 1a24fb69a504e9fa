"""A stall is replayed where it happened, whatever the daemon was at."""

import asyncio
from pathlib import Path

import pytest

from robotd.app.replaying import replay_recording
from robotd.app.stall_guard import STALL_S
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm, Clear, RecordStop
from robotd.core.clock import now_ns, run_virtual
from robotd.core.errors import RobotdError
from robotd.mission.safety.hold import Stall
from robotd.recording.entries import CauseEntry
from robotd.recording.reader import read
from robotd.sim.emulators.catalogue import Dialects
from tests.support.bench import Bench, bench
from tests.support.states import STATES

pytestmark = pytest.mark.slow


async def stall_in(state: str, directory: Path) -> None:
    """Record a session that stalls in a state, is stalled again, and is cleared or armed afterwards."""
    async with bench(directory, Dialects(), readings=24) as it:
        await STATES[state](it)
        for pause_s in (0.013, 0.4):
            await asyncio.sleep(pause_s)
            it.daemon.robot.stop_past_loop()  # as the guard's thread does
            it.daemon.causes.stalled(Stall(now_ns(), STALL_S, True, "the log"))
        await asyncio.sleep(1.0)
        await _bring_back(it)
        await asyncio.sleep(0.2)
        await it.daemon.control.perform(RecordStop())  # before the lines are taken down, which is another matter


async def _bring_back(it: Bench) -> None:
    if it.mode is Mode.FAULT:
        await it.daemon.control.perform(Clear())
    if it.mode is Mode.DISARMED:
        try:
            await it.daemon.control.perform(Arm())
        except RobotdError:
            return


@pytest.mark.parametrize("state", STATES)
def test_a_stall_in_each_state_replays(state: str, tmp_path: Path) -> None:
    run_virtual(stall_in(state, tmp_path))
    (file,) = (tmp_path / "recordings").glob("*.mcap")
    assert [e.name for e in read(file).entries if isinstance(e, CauseEntry)].count("stall") == 2
    report = replay_recording(file)
    assert report.differences == ()
    assert report.complete
    assert report.digest == report.recorded_digest
