"""The program: what it says when it cannot start, and that its last act is to stop the robot."""

import asyncio
import os
import signal
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import pytest

from firmware_proto.common import BoardState
from robotd.app import daemon as program
from robotd.app.compose import Daemon, compose
from robotd.app.daemon import main, run
from robotd.app.daemon_lock import lock_directory
from robotd.children.process import Process
from robotd.client import AsyncClient
from robotd.config import Config
from robotd.contract.device_status import LinkState
from robotd.contract.requests import Arm
from robotd.core.counted import Counted
from robotd.core.errors import ChildError, TransportError
from robotd.core.grid_spec import GridSpec
from robotd.front import supervised as front
from robotd.grid.occupancy import OccupancyGrid
from robotd.hardware.transport.transport import Connect, Transport
from robotd.head.compute import Compute
from robotd.head.head import Head
from robotd.maps.store import MapStore
from robotd.mission.whereabouts.keeping import Keeping
from robotd.mission.whereabouts.map_in_use import MapState
from robotd.recording.entries import CommandEntry
from robotd.recording.preroll import PrerollJournal
from robotd.recording.reader import read
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from robotd.sim.runtime import connectors
from tests.support.living import until_ready
from tests.support.own_boards import own_board
from tests.support.places import head_of, place_of
from tests.support.real_rig import child_of


@pytest.fixture(name="short")
def _short() -> Iterator[Path]:
    """A directory whose path leaves room for a socket's name."""
    with tempfile.TemporaryDirectory() as directory:
        yield Path(directory)


def config_in(directory: Path, *, from_start: bool = False) -> Config:
    config = Config()
    return replace(
        config,
        server=replace(config.server, runtime_dir=str(directory / "run")),
        maps=replace(config.maps, dir=str(directory / "maps")),
        recording=replace(config.recording, dir=str(directory / "recordings"), from_start=from_start),
    )


def file_of(directory: Path, *more: str) -> str:
    file = directory / "robotd.toml"
    lines = (f'server.runtime_dir = "{directory}/run"', f'recording.dir = "{directory}/recordings"', *more)
    file.write_text("\n".join(lines))
    return str(file)


def test_a_bad_configuration_is_told_line_by_line(short: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = file_of(short, "drive.colour = 1", "sweep.readings = -3")
    assert main(["--config", file]) == 78
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 2
    assert any(line.startswith(f"{file}:3") and "colour" in line for line in told)
    assert any(line.startswith(f"{file}:4") and "readings" in line for line in told)


def test_a_configuration_that_is_not_there_is_one_line(short: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--config", str(short / "none.toml")]) == 78
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_it_tells_its_version(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    assert capsys.readouterr().out.startswith("robotd ")


def test_a_second_daemon_says_so_and_leaves_the_lines_alone(
    short: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []

    async def connect() -> Transport:
        opened.append("a line")
        raise TransportError("nobody should come here")

    monkeypatch.setattr(
        program, "serial_connectors", lambda _: dict.fromkeys(("drive", "pantilt", "rangefinder"), connect)
    )
    file = file_of(short, "recording.from_start = true")
    with lock_directory(short / "run"):
        assert main(["--config", file]) == 1
    told = capfd.readouterr().err.splitlines()
    assert len(told) == 1
    assert "another robotd" in told[0]
    assert opened == []
    assert not (short / "recordings").exists()


def test_a_recording_that_cannot_be_made_is_told_in_a_line(short: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (short / "recordings").write_text("not a directory")
    assert main(["--config", file_of(short, "recording.from_start = true")]) == 1
    (told,) = [line for line in capfd.readouterr().err.splitlines() if "ERROR" in line]
    assert "cannot record" in told


class Captured:
    """Composes as the program does, on a simulated robot, and keeps the daemon for the test to look at."""

    def __init__(self, connects: dict[str, Connect], monkeypatch: pytest.MonkeyPatch) -> None:
        self._connects = connects
        self.composed: asyncio.Future[Daemon] = asyncio.get_running_loop().create_future()
        monkeypatch.setattr(program, "compose", self._compose)

    def _compose(
        self, config: Config, _: Mapping[str, Connect], head: Head, disk: Compute, journal: PrerollJournal
    ) -> Daemon:
        daemon = compose(config, self._connects, head, disk, journal)
        self.composed.set_result(daemon)
        return daemon


@pytest.mark.real_clock
async def test_sigterm_stops_the_robot_first_and_completes_the_recording(
    short: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = SimulatedRobot(load_world("office"), seed=1)
    async with connectors(robot) as connects:
        captured = Captured(connects, monkeypatch)
        running = asyncio.create_task(run(config_in(short, from_start=True)))
        daemon = await captured.composed
        await until_ready(daemon)
        await daemon.control.perform(Arm())
        assert {own_board(robot, name).state for name in robot.boards} == {BoardState.ARMED}
        os.kill(os.getpid(), signal.SIGTERM)
        await asyncio.wait_for(running, 5.0)
        await asyncio.sleep(0.05)
        assert BoardState.ARMED not in {own_board(robot, name).state for name in robot.boards}
    (recording,) = (short / "recordings").iterdir()
    recorded = read(recording)
    assert recorded.complete
    # Noted where the signal came, not when the daemon comes to its end: a step of a mission may be taken between.
    asked = [entry.name for entry in recorded.entries if isinstance(entry, CommandEntry)]
    assert asked == ["arm", "stop", "stop"]


@pytest.mark.real_clock
async def test_sigterm_in_the_first_moment_ends_it(short: Path) -> None:
    running = asyncio.create_task(run(config_in(short)))
    await asyncio.sleep(0)
    os.kill(os.getpid(), signal.SIGTERM)
    await asyncio.wait_for(running, 5.0)


@pytest.mark.real_clock
async def test_an_error_in_the_daemon_itself_stops_the_robot(short: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    robot = SimulatedRobot(load_world("office"), seed=1)
    async with connectors(robot) as connects:
        captured = Captured(connects, monkeypatch)
        running = asyncio.create_task(run(config_in(short)))
        daemon = await captured.composed
        await until_ready(daemon)
        await daemon.control.perform(Arm())

        def fail(*_: object) -> None:
            raise ValueError("a mistake of ours")

        monkeypatch.setattr(daemon.supervisor.whereabouts, "moved", fail)
        with pytest.raises(ExceptionGroup):
            await asyncio.wait_for(running, 5.0)
        assert daemon.control.status.reason.startswith("internal error: ")
        assert "a mistake of ours" in daemon.control.status.reason
        await asyncio.sleep(0.05)
        assert BoardState.ARMED not in {own_board(robot, name).state for name in robot.boards}


@pytest.mark.real_clock
async def test_a_map_that_nobody_saved_outlives_sigterm(short: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    robot = SimulatedRobot(load_world("office"), seed=1)
    grid = OccupancyGrid(GridSpec(0.1, 0.0, 0.0, (20, 30)))
    monkeypatch.setattr(Keeping, "run", lambda _: asyncio.Event().wait())  # the end itself must keep it
    async with connectors(robot) as connects:
        captured = Captured(connects, monkeypatch)
        running = asyncio.create_task(run(config_in(short)))
        daemon = await captured.composed
        await until_ready(daemon)
        place = await place_of(head_of(daemon), grid, "lab")
        place.settled = place.in_store = MapState(-1)
        daemon.supervisor.use(place)
        os.kill(os.getpid(), signal.SIGTERM)
        await asyncio.wait_for(running, 5.0)
    stored = MapStore(short / "maps").load("lab")
    loaded, entry = stored.grid, stored.entry
    assert (entry.is_unsaved, loaded.digest()) == (True, grid.digest())


@pytest.mark.real_clock
async def test_without_a_front_it_is_disarmed_says_so_tries_again_and_keeps_its_lines(
    short: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    starts, start_it = 0, front._start

    def start(runtime_dir: str, counted: Counted) -> Process:
        nonlocal starts
        starts += 1
        if starts in {2, 3, 4}:
            raise ChildError("it cannot be started: Cannot allocate memory")
        return start_it(runtime_dir, counted)

    robot = SimulatedRobot(load_world("office"), seed=1)
    monkeypatch.setattr(front, "_start", start)
    async with connectors(robot) as connects:
        captured = Captured(connects, monkeypatch)
        running = asyncio.create_task(run(config_in(short)))
        daemon = await captured.composed
        await until_ready(daemon)
        async with AsyncClient(short / "run", deadline_s=30.0) as client:
            first = (await client.hello()).session
            await client.arm()
            dying = child_of(os.getpid(), "robotd.front")
            assert dying is not None
            os.kill(dying, signal.SIGKILL)
            while (await client.hello()).session == first:
                """It is not the next one yet."""
            status = await client.status()
        assert (status.mode, starts) == ("disarmed", 5)
        assert "no client can be heard: it cannot be started: Cannot allocate memory" in status.reason
        assert [device.link for device in status.devices] == [LinkState.READY] * 3
        assert BoardState.ARMED not in {own_board(robot, name).state for name in robot.boards}
        os.kill(os.getpid(), signal.SIGTERM)
        await asyncio.wait_for(running, 5.0)
