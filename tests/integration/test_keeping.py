"""A map that nobody saved is not lost, whatever comes next; and a replay of all that writes nothing."""

import asyncio
import contextlib
import errno
from collections.abc import AsyncIterator
from dataclasses import replace
from pathlib import Path

import pytest

from robotd.app.first_map import load_first_map
from robotd.app.replaying import replay_recording
from robotd.config import Config
from robotd.contract.events import MapChanged, MissionPhase, MissionProgress, Status
from robotd.contract.missions import Legs, Localize, MapStart, with_lease
from robotd.contract.requests import Arm, ListMaps, MapDiscard, MapLoad, MapSave, RecordStart, RecordStop, Stop
from robotd.core.clock import run_virtual
from robotd.core.errors import MapError, MissionError
from robotd.core.grid_spec import GridSpec
from robotd.grid.occupancy import OccupancyGrid
from robotd.head.jobs import Insert
from robotd.maps import atomic
from robotd.maps.store import MapStore
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from tests.integration.conftest import Live
from tests.support.living import LEASE_S, Living
from tests.support.places import head_of

QUICK = replace(Config(), sweep=SweepSettings(readings=120))


def office() -> SimulatedRobot:
    return SimulatedRobot(load_world("office"), seed=5)


@contextlib.asynccontextmanager
async def keeping(it: Living) -> AsyncIterator[None]:
    """Let the daemon keep maps by itself, as the program does."""
    task = asyncio.create_task(it.daemon.control.keeping.run())
    await asyncio.sleep(0)
    try:
        yield
    finally:
        task.cancel()
        await asyncio.wait((task,))


async def kept(it: Living) -> Status:
    """Return the status that says that the map is kept."""
    async with asyncio.timeout(5.0):
        async for event in it.events:
            if isinstance(event, Status) and event.map_kept_version is not None:
                return event
    raise AssertionError("a subscription never ends")


def digest_in_use(it: Living) -> str:
    assert it.daemon.supervisor.whereabouts.map_in_use is not None
    return it.daemon.supervisor.whereabouts.map_in_use.digest


def fill(disk: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    disk.setattr(atomic, "write_synced", refuse)


async def test_a_finished_map_is_kept_said_and_becomes_a_saved_one(
    live: Live, caplog: pytest.LogCaptureFixture
) -> None:
    robot = office()
    caplog.set_level("INFO")
    async with live(robot, QUICK) as it, keeping(it):
        said = await it.done(MapStart.of("office", (), robot.start))
        assert [event.message for event in said if isinstance(event, MissionProgress)][-1] == (
            "1 stops swept; the map office is not saved yet: robotctl map save"
        )
        status = await kept(it)
        assert (status.map_unsaved, status.map_kept_version) == (True, 1)
        assert "kept as version 1: robotctl map save" in caplog.text
        (entry,) = (await it.daemon.control.perform(ListMaps())).maps
        assert (entry.unsaved, entry.digest) == (True, digest_in_use(it))
        saved = await it.daemon.control.perform(MapSave())
        assert (saved.version, saved.unsaved) == (1, False)
        assert (await it.daemon.control.perform(ListMaps())).maps == (saved,)
        status = it.daemon.control.status
        assert (status.map_unsaved, status.map_kept_version) == (False, None)


async def test_mapping_stopped_after_two_of_five_stops_is_kept(live: Live) -> None:
    robot = office()
    async with live(robot, QUICK) as it, keeping(it):
        it.daemon.control.start(MapStart.of("office", robot.stops_m[:4], robot.start), LEASE_S)
        sweeps = 0
        async for event in it.events:
            sweeps += isinstance(event, MissionProgress) and event.phase is MissionPhase.DRIVING
            if sweeps == 2:
                break
        await it.daemon.control.perform(Stop("enough"))
        status = await kept(it)
        assert status.map_kept_version == 2  # one after each stop, in the place of the one before
        assert it.daemon.supervisor.whereabouts.map_in_use is not None
        assert it.daemon.supervisor.whereabouts.map_in_use.generation == 2
        stored = MapStore(it.daemon.control._archive.root).load("office")
        grid, entry = stored.grid, stored.entry
        assert (entry.metadata["generation"], grid.digest()) == (2, digest_in_use(it))
        assert stored.stops is not None
        assert entry.stops == len(stored.stops.stops) == it.daemon.supervisor.whereabouts.map_in_use.stops == 2


async def test_a_map_that_is_loaded_takes_its_stops_along(live: Live) -> None:
    robot = office()
    async with live(robot, QUICK) as it:
        control = it.daemon.control
        await it.done(MapStart.of("office", robot.stops_m[:1], robot.start))
        await control.perform(MapSave())
        made = MapStore(control._archive.root).load("office").stops
        assert made is not None
        await control.perform(MapLoad.of("office", None, robot.start))
        place = it.daemon.supervisor.whereabouts.map_in_use
        assert place is not None
        assert place.stops == len(made.stops) == 2
        place.take(await head_of(it.daemon).ask(Insert(place.ref, made.stops[0].sweep, robot.start)))
        await control.perform(MapSave("hall"))
        stored = MapStore(control._archive.root).load("hall")
        assert stored.entry.stops == 3
        assert stored.stops is not None
        assert stored.stops.stops[:2] == made.stops
        assert stored.grid.digest() == digest_in_use(it)


async def test_a_kill_at_any_step_of_mapping_costs_no_more_than_one_stop(live: Live) -> None:
    robot = office()
    stops_m = tuple((robot.start.x_m + 0.02 * number, robot.start.y_m) for number in range(1, 6))
    coarse = replace(Config(), sweep=SweepSettings(readings=24))
    async with live(robot, coarse) as it, keeping(it):
        root = it.daemon.control._archive.root
        it.daemon.control.start(MapStart.of("office", stops_m, robot.start, Legs.STRAIGHT), LEASE_S)
        seen = set[int]()
        async for event in it.events:
            place = it.daemon.supervisor.whereabouts.map_in_use
            if place is not None and isinstance(event, MissionProgress | MapChanged):
                seen.add(on_disk := _generation_on_disk(root))
                assert place.generation - on_disk <= 1
            if isinstance(event, MissionProgress) and event.is_last:
                break
        await asyncio.sleep(1.0)
        assert seen >= {0, 1, 2, 3, 4, 5}
        assert [(one.unsaved, one.digest) for one in (await it.daemon.control.perform(ListMaps())).maps] == [
            (True, digest_in_use(it))
        ]
        saved = await it.daemon.control.perform(MapSave("hall"))
        assert (await it.daemon.control.perform(ListMaps())).maps == (saved,)


def _generation_on_disk(root: Path) -> int:
    """Return how many sweeps are in the map that a daemon would find there that begins now."""
    try:
        entry = MapStore(root).load("office").entry
    except MapError:
        return 0
    return int(entry.metadata["generation"])


async def test_a_map_of_which_nothing_was_seen_is_not_kept(live: Live) -> None:
    robot = office()
    async with live(robot, QUICK) as it, keeping(it):
        it.daemon.control.start(MapStart.of("office", (), robot.start), LEASE_S)
        await asyncio.sleep(0.1)
        await it.daemon.control.perform(Stop("at once"))
        await asyncio.sleep(2.0)
        assert not it.daemon.control.status.map_unsaved
        assert (await it.daemon.control.perform(ListMaps())).maps == ()


async def test_starting_another_map_and_loading_one_keep_it_first(live: Live) -> None:
    robot = office()
    async with live(robot, QUICK) as it:  # nobody keeps it before
        control = it.daemon.control
        await it.done(MapStart.of("first", (), robot.start))
        first = digest_in_use(it)
        await control.perform(with_lease(MapStart.of("second", (), robot.start), LEASE_S))
        async for event in it.events:
            if isinstance(event, MissionProgress) and event.is_last:
                break
        second = digest_in_use(it)
        loaded = await control.perform(MapLoad.of("first", None, robot.start))
        assert [(one.name, one.digest, one.unsaved) for one in (await control.perform(ListMaps())).maps] == [
            ("first", first, True),
            ("second", second, True),
        ]
        assert (loaded.digest, digest_in_use(it)) == (first, first)
        assert (control.status.map_unsaved, control.status.map_kept_version) == (True, 1)
        assert not (await control.perform(MapSave())).unsaved


async def test_what_the_full_disk_refuses_is_dropped_only_when_it_was_given_up(
    live: Live, caplog: pytest.LogCaptureFixture
) -> None:
    robot = office()
    async with live(robot, QUICK) as it, keeping(it):
        control = it.daemon.control
        await it.done(MapStart.of("old", (), robot.start))
        await control.perform(MapSave())
        with pytest.MonkeyPatch.context() as disk:
            fill(disk)
            await it.done(MapStart.of("new", (), robot.start))
            await asyncio.sleep(5.0)
            said = [line.getMessage() for line in caplog.records if "memory alone" in line.getMessage()]
            assert said == ["the unsaved map new is in memory alone: cannot save map new: No space left on device"]
            new = digest_in_use(it)
            with pytest.raises(MissionError, match=r"map new would be lost.*No space.*robotctl map discard"):
                await control.perform(with_lease(MapStart.of("newer", (), robot.start), LEASE_S))
            with pytest.raises(MissionError, match="map new would be lost"):
                await control.perform(MapLoad.of("old", None, None))
            assert (control.status.map_unsaved, control.status.map_kept_version) == (True, None)
            assert digest_in_use(it) == new
            await control.perform(MapDiscard())
            assert not control.status.map_unsaved
            await control.perform(MapLoad.of("old", None, None))
        assert [entry.name for entry in (await control.perform(ListMaps())).maps] == ["old"]


async def test_a_stop_while_the_map_is_being_kept_wins_over_the_start(
    live: Live, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = office()
    async with live(robot, QUICK) as it:
        control = it.daemon.control
        await it.done(MapStart.of("first", (), robot.start))
        slow, keep = asyncio.Event(), control.keeping.keep

        async def slowly() -> str | None:
            await slow.wait()
            return await keep()

        monkeypatch.setattr(control.keeping, "keep", slowly)
        starting = asyncio.create_task(control.perform(with_lease(MapStart.of("second", (), robot.start), LEASE_S)))
        await asyncio.sleep(0.1)
        await control.perform(Stop("a person"))
        await control.perform(Arm())
        slow.set()
        with pytest.raises(MissionError, match="stopped while"):
            await starting


@pytest.mark.slow
def test_a_session_in_which_maps_were_kept_replays_bit_for_bit_and_writes_nothing(live: Live, tmp_path: Path) -> None:
    async def session() -> None:
        robot = office()
        async with live(robot, armed=False) as it, keeping(it):
            control = it.daemon.control
            await control.perform(RecordStart(str(tmp_path / "recordings" / "kept.mcap")))
            await control.perform(Arm())
            await it.done(MapStart.of("first", (), robot.start))
            await kept(it)
            await it.done(MapStart.of("second", (), robot.start))
            await control.perform(MapLoad.of("first", None, robot.start))
            await it.done(Localize())
            await control.perform(RecordStop())

    run_virtual(session())
    files = sorted((tmp_path / "maps").rglob("*"))
    assert len(files) > 5
    report = replay_recording(tmp_path / "recordings" / "kept.mcap")
    assert report.differences == ()
    assert report.results > 5
    assert sorted((tmp_path / "maps").rglob("*")) == files


@pytest.mark.parametrize(
    ("wanted", "in_use", "said"),
    [
        ("", None, ""),
        ("hall", "hall", ""),
        ("last", "lab", ""),
        ("cellar", None, "maps.load = 'cellar': there is no map 'cellar'"),
    ],
)
async def test_a_daemon_takes_the_map_into_use_that_it_is_told(
    wanted: str, in_use: str | None, said: str, live: Live, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    store = MapStore(tmp_path / "maps")
    for at, (name, metadata) in enumerate((("hall", {}), ("lab", {}), ("draft", {"unsaved": True})), start=1):
        store.save(name, OccupancyGrid(GridSpec(0.05, 0.0, 0.0, (8, at))), metadata=metadata, created_unix_ns=at)
    async with live(office(), QUICK) as it:
        await load_first_map(it.daemon, wanted)
        place = it.daemon.supervisor.whereabouts.map_in_use
        assert (place.name if place else None) == in_use
    assert said in caplog.text


async def test_a_daemon_without_any_saved_map_says_so_and_goes_on(live: Live, caplog: pytest.LogCaptureFixture) -> None:
    async with live(office(), QUICK) as it:
        await load_first_map(it.daemon, "last")
    assert "no map was saved yet" in caplog.text
