"""What missions do with stops that cannot be reached, and what the journal's requests do when they are asked again."""

import asyncio
import json
from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pytest

from robotd.config import Config
from robotd.contract.answers import RecordingFile
from robotd.contract.events import MissionPhase, MissionProgress
from robotd.contract.map_import import MapImport, MapImported
from robotd.contract.missions import DriveTo, Legs, Localize, MapStart
from robotd.contract.modes import Mode
from robotd.contract.requests import (
    REQUESTS,
    Hello,
    ListMaps,
    ListRecordings,
    MapDelete,
    MapLoad,
    MapRename,
    MapSave,
    MapShow,
    RecordDelete,
    RecordStart,
    RecordStop,
)
from robotd.core.errors import MapError, MissionError, RecordingError, ServerError
from robotd.core.grid_bytes import unpacked_cells
from robotd.core.grid_spec import GridSpec
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.recording.entries import CommandEntry
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from tests.integration.conftest import Live
from tests.support.living import Living
from tests.support.own_boards import own_board

QUICK = replace(Config(), sweep=SweepSettings(readings=120))


def office(seed: int = 5) -> SimulatedRobot:
    return SimulatedRobot(load_world("office"), seed=seed)


def last_command(it: Living) -> CommandEntry:
    return [entry for entry in it.journal.remembered if isinstance(entry, CommandEntry)][-1]


async def test_a_stop_that_cannot_be_reached_is_left_out_and_named(live: Live) -> None:
    robot = office()
    async with live(robot, QUICK) as it:
        said = await it.done(MapStart.of("office", ((-3.0, -3.0), robot.stops_m[0]), robot.start))
        assert it.daemon.supervisor.whereabouts.map_in_use is not None
        generation = it.daemon.supervisor.whereabouts.map_in_use.generation
    progress = [event for event in said if isinstance(event, MissionProgress)]
    assert progress[-1].message.startswith("2 stops swept; not reached: stop 1: (-3.00, -3.00) m cannot be reached")
    assert [event.stop for event in progress if event.phase is MissionPhase.SWEEPING] == [0, 2]
    assert generation == 2


async def test_nobody_drives_on_a_map_on_which_the_robot_is_not(live: Live) -> None:
    robot = office()
    async with live(robot, QUICK) as it:
        await it.done(MapStart.of("office", (), robot.start))
        await it.daemon.control.perform(MapSave())
        await it.daemon.control.perform(MapLoad.of("office", None, None))
        _, end = await it.do(DriveTo(1.0, 1.0, Legs.STRAIGHT))
        assert "not localized on it" in end.message
        assert it.daemon.supervisor.mode is Mode.IDLE


async def test_stops_too_far_apart_for_one_map_are_refused_before_anything_moves(live: Live) -> None:
    async with live(office(), QUICK) as it:
        _, end = await it.do(MapStart("world", ((5000.0, 0.0),)))
        assert "does not fit on one map" in end.message
        assert it.daemon.supervisor.whereabouts.map_in_use is None


async def test_requests_are_noted_so_that_they_can_be_asked_again(live: Live) -> None:
    robot = office()
    async with live(robot, QUICK, armed=False) as it:
        control, supervisor = it.daemon.control, it.daemon.supervisor
        await control.repeat("arm", {})
        assert supervisor.mode is Mode.IDLE
        mission = MapStart.of("office", (), robot.start, Legs.STRAIGHT)
        mission_id = control.start(mission, 0.5)
        noted = last_command(it)
        await control.repeat("renew", {"mission_id": mission_id})
        await control.repeat("stop", {"reason": "enough"})
        assert supervisor.mode.value == "disarmed"
        assert supervisor.status.reason == "enough"
        await control.repeat("clear", {})
        await control.repeat("arm", {})
        await control.repeat(noted.name, noted.arguments)
        assert last_command(it).arguments == noted.arguments
        assert msgspec.convert(noted.arguments["mission"], MapStart) == mission
        with pytest.raises(RecordingError, match="unknown request 'fly'"):
            await control.repeat("fly", {})


async def test_a_map_taken_into_use_comes_whole_out_of_the_journal(live: Live) -> None:
    robot = office()
    async with live(robot, QUICK) as it:
        control, supervisor = it.daemon.control, it.daemon.supervisor
        await it.done(MapStart.of("office", (), robot.start))
        await control.perform(MapSave("kept"))
        await control.perform(MapLoad.of("kept", None, robot.start))
        loaded, tie, noted = supervisor.whereabouts.map_in_use, supervisor.whereabouts.tie, last_command(it)
        assert loaded is not None
        await control.repeat(noted.name, noted.arguments)
        again = supervisor.whereabouts.map_in_use
        assert again is not None
        assert again is not loaded
        assert (again.map_id, again.name) == (loaded.map_id, loaded.name)
        assert again.begun == loaded.begun
        assert again.begun.stops == 1
        assert supervisor.whereabouts.tie == tie is not None
        control.start(Localize(), 1000.0)
        with pytest.raises(MissionError, match="while a mission is under way"):
            await control.perform(MapLoad.of("kept", None, None))
        assert supervisor.whereabouts.map_in_use is again


async def test_every_request_has_somebody_who_carries_it_out(live: Live) -> None:
    async with live(office(), QUICK) as it:
        assert set(it.daemon.control._rows) == set(REQUESTS.values()) - {Hello}  # who answers is the server's to say


async def test_a_map_that_cannot_be_saved_is_not_one_that_is_not_there(
    live: Live, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise MapError("cannot save map office: No space left on device")

    robot = office()
    async with live(robot, QUICK) as it:
        await it.done(MapStart.of("office", (), robot.start))
        monkeypatch.setattr(it.daemon.control._archive, "save", full)
        with pytest.raises(MissionError, match="No space left"):
            await it.daemon.control.perform(MapSave())


async def test_what_is_not_there_is_refused(live: Live, tmp_path: Path) -> None:
    (tmp_path / "recordings").mkdir()
    (tmp_path / "recordings" / "file").write_text("")
    async with live(office(), QUICK) as it:
        control = it.daemon.control
        with pytest.raises(MapError, match="no map is in use"):
            await control.perform(MapSave())
        with pytest.raises(MapError, match="no map is in use"):
            await control.perform(MapShow())
        with pytest.raises(MapError):
            await control.perform(MapLoad.of("nowhere", None, None))
        with pytest.raises(RecordingError, match="cannot record"):
            await control.perform(RecordStart("file/below/a.mcap"))
        for hidden in ("maps/lab/9", "maps/.tmp-lab-11", "elsewhere.mcap"):
            with pytest.raises(RecordingError, match="recordings go below"):
                await control.perform(RecordStart(str(tmp_path / hidden)))
            assert not (tmp_path / hidden).exists()
        assert control.status.recording is None
        assert await control.perform(RecordStop()) == RecordingFile(None)
        assert await control.perform(RecordStart())
        with pytest.raises(RecordingError, match="already recording"):
            await control.perform(RecordStart())
        assert await control.perform(RecordStop())


async def test_a_board_that_restarts_while_mapping_ends_the_mission_and_leaves_no_jump(live: Live) -> None:
    robot = office()
    async with live(robot, QUICK) as it:
        control, drive = it.daemon.control, it.daemon.robot.drive
        control.start(MapStart.of("office", robot.stops_m, robot.start, Legs.STRAIGHT), 1000.0)
        async for event in it.events:
            if isinstance(event, MissionProgress) and event.phase is MissionPhase.DRIVING:
                break
        await asyncio.sleep(1.0)
        before = drive.odometry.latest
        own_board(robot, "drive").reboot(99)
        await asyncio.sleep(4.0)
        after = drive.odometry.latest
        assert before is not None
        assert after is not None
        assert after.time_ns > before.time_ns
        assert after.in_odom.distance_m(before.in_odom) < 0.1
        assert it.daemon.supervisor.mode is Mode.DISARMED
        assert not it.daemon.robot.absent


async def test_stored_maps_are_renamed_and_deleted_but_never_the_one_in_use(live: Live) -> None:
    async with live(office(), QUICK) as it:
        control = it.daemon.control
        await it.done(MapStart.of("office", (), it.robot.start))
        await control.perform(MapSave())
        await control.perform(MapSave("old"))
        for request in (MapDelete("office"), MapRename("office", "lab")):
            with pytest.raises(MissionError, match="map office is in use"):
                await control.perform(request)
        await control.perform(MapRename("old", "lab"))
        assert [entry.name for entry in (await control.perform(ListMaps())).maps] == ["lab", "office"]
        with pytest.raises(MapError, match="no version 7"):
            await control.perform(MapDelete("lab", 7))
        await control.perform(MapDelete("lab"))
        assert [entry.name for entry in (await control.perform(ListMaps())).maps] == ["office"]
        with pytest.raises(MapError, match="there is no map 'lab'"):
            await control.perform(MapDelete("lab"))


async def test_a_map_is_brought_in_parts_stored_and_not_taken_into_use(live: Live, tmp_path: Path) -> None:
    spec, noise = GridSpec(0.05, -2.0, 1.0, (200, 250)), np.random.default_rng(3)
    cells = noise.integers(0, 256, spec.shape, dtype=np.uint8)
    async with live(office(), QUICK) as it:
        control = it.daemon.control
        first, second = MapImport.parts("lab", spec, cells, "lab.yaml")
        with pytest.raises(ServerError, match="bad_argument: map_import lab: the parts before this one are gone"):
            await control.perform(second)
        assert await control.perform(first) == MapImported(len(first.part), None)
        told = await control.perform(second)
        assert told.map is not None
        assert (told.received_bytes, told.map.name, told.map.version) == (first.size_bytes, "lab", 1)
        shown = await control.perform(MapShow("lab"))
        assert shown.packed is not None
        assert unpacked_cells(shown.packed, shown.spec).tolist() == cells.tolist()
        assert it.daemon.supervisor.whereabouts.map_in_use is None
        manifest = json.loads((tmp_path / "maps" / "lab" / "1" / "manifest.json").read_text())
        assert manifest["metadata"] == {"imported_from": "lab.yaml"}
        # Only small letters apart: on some disks it would be the same map.
        (last,) = MapImport.parts("Lab", spec, np.zeros(spec.shape, np.uint8))
        with pytest.raises(MissionError, match="lab"):
            await control.perform(last)


async def test_recordings_are_listed_and_deleted_but_not_the_one_under_way(live: Live) -> None:
    async with live(office(), QUICK) as it:
        control = it.daemon.control
        await control.perform(RecordStart("monday.mcap"))
        (one,) = (await control.perform(ListRecordings())).recordings
        assert (one.path, one.is_open) == ("monday.mcap", True)
        with pytest.raises(RecordingError, match="being recorded"):
            await control.perform(RecordDelete("monday.mcap"))
        await control.perform(RecordStop())
        await control.perform(RecordDelete("monday.mcap"))
        assert (await control.perform(ListRecordings())).recordings == ()
