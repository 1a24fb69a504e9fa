"""The front as a process: killed, stopped, of another version, not to be started; clients see a new session."""

import asyncio
import contextlib
import os
import signal
import sys
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from robotd.children.child import Child
from robotd.client import AsyncClient
from robotd.contract.events import MissionPhase
from robotd.contract.missions import Localize
from robotd.contract.requests import Renew
from robotd.core.counted import Counted
from robotd.core.errors import RobotdError
from robotd.front import supervised
from robotd.front.heart_side import HeartSide
from robotd.front.supervised import front_of
from robotd.server.settings import ServerSettings
from tests.unit.server.conftest import FakeControl

pytestmark = pytest.mark.real_clock
PATIENCE_S = 60.0


@dataclass
class Fronted:
    """A heart that is a fake, and its front that is real."""

    control: FakeControl
    child: Child
    halts: list[str] = field(default_factory=list)

    def pid(self) -> int:
        (found,) = (
            int(number)
            for number in Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()
            if b"robotd.front" in Path(f"/proc/{number}/cmdline").read_bytes()
        )
        return found


@contextlib.asynccontextmanager
async def fronted(runtime_dir: Path) -> AsyncIterator[Fronted]:
    control = FakeControl()
    side = HeartSide(control, ServerSettings(runtime_dir=str(runtime_dir)))
    halts: list[str] = []
    it = Fronted(control, front_of(side, halts.append, Counted()), halts)
    tasks = [asyncio.create_task(it.child.run()), asyncio.create_task(side.follow())]
    try:
        async with asyncio.timeout(PATIENCE_S):
            yield it
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        await control.close()


async def until(happens: Callable[[], object]) -> None:
    while not happens():  # noqa: ASYNC110  # nobody tells: it is in another process
        await asyncio.sleep(0.01)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
async def test_one_that_is_ended_or_stopped_is_followed_by_another(tmp_path: Path, number: signal.Signals) -> None:
    async with fronted(tmp_path) as it, AsyncClient(tmp_path, deadline_s=PATIENCE_S) as client:
        first = await client.hello()
        await client.arm()
        before = it.pid()
        os.kill(before, number)
        await until(lambda: not it.child.is_ready.is_set())
        await it.child.is_ready.wait()
        assert (await client.hello()).session != first.session
        assert (await client.status()).mode == "idle", "the heart did not notice otherwise"
        assert it.pid() != before
        assert it.halts == []


async def test_a_mission_whose_lease_is_long_outlives_the_front(tmp_path: Path) -> None:
    async with fronted(tmp_path) as it, AsyncClient(tmp_path, deadline_s=PATIENCE_S) as client:
        it.control.release.clear()
        await client.arm()
        mission_id = (await client.call(Localize(lease_s=10.0))).mission_id
        os.kill(it.pid(), signal.SIGKILL)
        await until(lambda: not it.child.is_ready.is_set())
        await it.child.is_ready.wait()
        now = (await client.call(Renew(mission_id))).mission
        assert now is not None
        assert not now.is_last, "it is under way, and has its lease renewed through the next front"
        it.control.release.set()
        await until(lambda: not it.control.is_busy)
        last = (await client.call(Renew(mission_id))).mission
        assert last is not None
        assert last.phase is MissionPhase.DONE


async def test_one_that_cannot_be_started_stops_the_robot_and_is_tried_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as broken:
        broken.setattr(sys, "executable", "/nowhere/python")
        async with fronted(tmp_path) as it:
            await until(lambda: len(it.halts) >= 2)
            assert "no client can be heard: it cannot be started" in it.halts[0]
            broken.undo()
            await it.child.is_ready.wait()
            async with AsyncClient(tmp_path) as client:
                await client.hello()


async def test_one_of_another_version_is_not_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(supervised, "__version__", "0.0.1")
    async with fronted(tmp_path) as it:
        await until(lambda: it.halts)
        assert "this is 0.0.1" in it.halts[0]
        assert not it.child.is_ready.is_set()


async def test_one_whose_sockets_cannot_be_had_is_tried_again(tmp_path: Path) -> None:
    (tmp_path / "state.sock").mkdir()
    async with fronted(tmp_path) as it:
        await until(lambda: it.halts)
        assert it.halts[0].startswith("no client can be heard: it ")
        (tmp_path / "state.sock").rmdir()
        await it.child.is_ready.wait()


async def test_clients_that_ask_while_there_is_none_get_no_answer_and_one_afterwards(tmp_path: Path) -> None:
    async with fronted(tmp_path) as it, AsyncClient(tmp_path, deadline_s=0.2) as client:
        await it.child.is_ready.wait()
        os.kill(it.pid(), signal.SIGSTOP)
        with pytest.raises(RobotdError, match="no answer"):
            await client.hello()
        await until(lambda: not it.child.is_ready.is_set())
        await it.child.is_ready.wait()
        async with AsyncClient(tmp_path, deadline_s=PATIENCE_S) as patient:
            await patient.hello()
