"""Requests that were refused are not recorded and need not be; those that failed halfway are, and replay."""

import asyncio
import contextlib
from pathlib import Path
from typing import Any

import pytest

from robotd.contract.missions import DriveTo, Localize, MapStart
from robotd.contract.modes import Mode
from robotd.contract.request import Request
from robotd.contract.requests import (
    REQUESTS,
    Arm,
    Clear,
    ListMaps,
    MapLoad,
    MapSave,
    PlanTo,
    RecordStart,
    RecordStop,
    Renew,
    Stop,
)
from robotd.core.errors import MapError, MissionError, RobotdError
from robotd.core.pose import IDENTITY
from robotd.recording.entries import CommandEntry
from robotd.recording.reader import read
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from tests.integration.conftest import Live
from tests.support.living import Living
from tests.support.own_boards import own_board
from tests.support.replayed import check, replayed

pytestmark = pytest.mark.slow


async def refuse_everything(it: Living) -> None:
    """Ask for what cannot be done now, in every way there is."""
    control = it.daemon.control
    for mission in (Localize(), DriveTo(1.0, 2.0), MapStart("a", ())):
        with pytest.raises(MissionError):
            control.start(mission, 1.0)
    with pytest.raises(MissionError):
        control.renew(17)
    with pytest.raises(MapError):
        await control.perform(MapLoad.of("nowhere", None, IDENTITY))
    with contextlib.suppress(RobotdError):
        await control.perform(MapSave())
    await control.perform(ListMaps())


async def test_ten_thousand_refusals_leave_nothing_in_the_journal(live: Live) -> None:
    robot = SimulatedRobot(load_world("office"), seed=4)
    async with live(robot, armed=False) as it:
        before = [entry for entry in it.journal.remembered if isinstance(entry, CommandEntry)]
        for _ in range(2000):
            await refuse_everything(it)
        assert [entry for entry in it.journal.remembered if isinstance(entry, CommandEntry)] == before


@pytest.mark.parametrize("kind", [kind for kind in REQUESTS.values() if kind.only_looks], ids=lambda kind: kind.cmd)
async def test_who_looks_without_end_leaves_nothing_in_the_journal(live: Live, kind: type[Request[Any]]) -> None:
    """Be it answered or refused: no client uses up the pre-roll, or fills a recording, by asking how things are."""
    robot = SimulatedRobot(load_world("office"), seed=4)
    async with live(robot, armed=False) as it:
        before = list(it.journal.remembered)
        for _ in range(1000):
            with contextlib.suppress(RobotdError, LookupError):  # hello is answered before it gets here
                await it.daemon.control.perform(kind(*LOOKS_AT.get(kind, ())))
        assert list(it.journal.remembered) == before


LOOKS_AT: dict[type[Request[Any]], tuple[Any, ...]] = {Renew: (1,), PlanTo: (1.0, 2.0)}


async def test_a_client_that_renews_without_end_leaves_nothing_in_the_journal_and_replays(
    live: Live, tmp_path: Path
) -> None:
    robot = SimulatedRobot(load_world("office"), seed=4)
    file = tmp_path / "recordings" / "renewed.mcap"
    async with live(robot) as it:
        control = it.daemon.control
        await control.perform(RecordStart(str(file)))
        mission_id = control.start(MapStart.of("office", (), robot.start), 0.5)
        for _ in range(20):
            for _ in range(500):
                control.renew(mission_id)
            await asyncio.sleep(0.1)
        await asyncio.sleep(3.0)  # and then it falls silent
        assert control.status.mode is Mode.DISARMED
        assert "its client fell silent" in control.status.reason
        await control.perform(RecordStop())
    check(replayed(file))
    assert [entry.name for entry in read(file).entries if isinstance(entry, CommandEntry)] == ["arm", "start"]


async def test_a_session_full_of_refusals_replays(live: Live, tmp_path: Path) -> None:
    robot = SimulatedRobot(load_world("office"), seed=4)
    async with live(robot, armed=False) as it:
        control = it.daemon.control
        await control.perform(RecordStart(str(tmp_path / "recordings" / "refused.mcap")))
        await refuse_everything(it)
        await control.perform(Arm())
        with pytest.raises(MissionError):
            await control.perform(Clear())
        await it.done(MapStart.of("office", (), robot.start))
        await control.perform(MapSave("kept"))
        await control.perform(Stop("enough"))
        await refuse_everything(it)
        await control.perform(Arm())
        await control.perform(MapLoad.of("kept", None, robot.start))
        await it.done(Localize())
        await control.perform(RecordStop())
    check(replayed(tmp_path / "recordings" / "refused.mcap"))
    recorded = [
        entry.name
        for entry in read(tmp_path / "recordings" / "refused.mcap").entries
        if isinstance(entry, CommandEntry)
    ]
    assert recorded == ["arm", "start", "stop", "arm", "use_map", "start"]


async def test_an_arming_that_fails_halfway_is_recorded_and_replays(live: Live, tmp_path: Path) -> None:
    robot = SimulatedRobot(load_world("office"), seed=4)
    async with live(robot, armed=False) as it:
        control = it.daemon.control
        await control.perform(RecordStart(str(tmp_path / "recordings" / "halfway.mcap")))
        own_board(robot, "pantilt").reboot(99)  # it is deaf for a second
        with pytest.raises(RobotdError):
            await control.perform(Arm())
        assert control.status.mode is Mode.DISARMED
        await asyncio.sleep(5.0)
        await control.perform(Arm())
        await it.done(MapStart.of("office", (), robot.start))
        await control.perform(RecordStop())
    recorded = [
        entry.name
        for entry in read(tmp_path / "recordings" / "halfway.mcap").entries
        if isinstance(entry, CommandEntry)
    ]
    assert recorded == ["arm", "arm", "start"]
    check(replayed(tmp_path / "recordings" / "halfway.mcap"))
