"""Simulated robots: where their devices are, and a configuration to run a daemon on them."""

import json
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from robotd.cli.main import main
from robotd.config import load
from robotd.hardware.link.tap import Direction
from robotd.recording.comparison import Difference
from robotd.recording.entries import BytesEntry, RecordingHeader
from robotd.recording.recorder import Recorder
from robotd.sim.buildings.building import load_recorded_building
from robotd.sim.buildings.world import WORLDS_DIR, load_world
from robotd.sim.faults.fault_words import FAULTS, meaning_of
from robotd.sim.faults.plan import PlannedFault
from robotd.sim.load import load_robot
from tests.support.carmen_room import flaser


@pytest.fixture
def interrupted(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """A simulation that says where its devices are, and is then interrupted; returns what it was asked."""
    asked: list[dict[str, Any]] = []

    async def run(robot: Any, *, announce: Any, **options: Any) -> None:
        asked.append({"robot": robot, **options})
        announce({"drive": "/dev/pts/7", "pantilt": "/dev/pts/8", "rangefinder": "/dev/pts/9"})
        raise KeyboardInterrupt

    monkeypatch.setattr("robotd.cli.simulated.run_on_ptys", run)
    monkeypatch.setattr("robotd.cli.simulated.run_faulty_on_ptys", run)
    return asked


def test_a_simulation_says_where_its_devices_are(
    interrupted: list[dict[str, Any]], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main(["sim", "office", "--seed", "3", "--links", "here", "--truth", "t.jsonl"]) == 0
    assert [line.split() for line in capsys.readouterr().out.splitlines()] == [
        ["drive", "/dev/pts/7"],
        ["pantilt", "/dev/pts/8"],
        ["rangefinder", "/dev/pts/9"],
    ]
    assert interrupted[0]["directory"] == Path.cwd() / "here"
    assert interrupted[0]["truth_path"] == Path("t.jsonl")
    assert interrupted[0]["robot"].start == load_world("office").start_pose


def test_the_configuration_it_writes_is_one_to_run_on(
    interrupted: list[dict[str, Any]], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    file = tmp_path / "lab" / "robotd.toml"
    assert main(["sim", "laboratory", "--write-config", str(file), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["config"] == str(file)
    config = load(file)
    assert (config.drive.port, config.rangefinder.port) == ("/dev/pts/7", "/dev/pts/9")
    assert config.server.runtime_dir == str(tmp_path / "lab" / "run")
    assert config.maps.dir == str(tmp_path / "lab" / "maps")


def test_boards_may_run_the_firmware_in_c(
    interrupted: list[dict[str, Any]], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    if find_spec("robotd.sim.firmware._native") is not None:
        assert main(["sim", "office", "--boards", "c", "--pantilt", "ptu"]) == 0
        boards = [type(board).__name__ for board in interrupted[0]["robot"].boards.values()]
        assert boards == ["FirmwareBoard", "Paced", "FirmwareBoard"]
    monkeypatch.setattr("robotd.sim.emulators.catalogue.firmware", None)
    assert main(["sim", "office", "--boards", "c"]) == 78
    assert "there was no C compiler for the firmware when robotd was installed" in capsys.readouterr().err


def test_a_configuration_that_cannot_be_written_is_a_failure(
    interrupted: list[dict[str, Any]], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    (tmp_path / "robotd.toml").mkdir()
    assert main(["sim", "office", "--write-config", str(tmp_path / "robotd.toml")]) == 1
    assert "robotd.toml: is a directory; a configuration made by robotctl" in capsys.readouterr().err


def test_a_world_that_there_is_not_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sim", "offise"]) == 78
    assert capsys.readouterr().err.startswith("offise: no such world; known: corridor, laboratory, office")


def test_a_recorded_building_is_made_of_a_log(
    laser_data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "intel.building"
    log = laser_data / "intel" / "intel.corrected.log.gz"
    words = ["import", "carmen", str(log), "--out", str(out), "--limit", "6", "--json"]
    assert main(words) == 0
    assert json.loads(capsys.readouterr().out) == {
        "file": str(out),
        "stops": 3,
        "kept_out": 3,
        "poses": "corrected",
        "damaged_lines": 0,
    }
    robot = load_robot(str(out))
    assert len(robot.probes_m) == 3


def test_what_goes_wrong_is_planned_on_the_command_line(
    interrupted: list[dict[str, Any]], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sim", "office", "--faults", "drive:unplug@20s+3s", "--seed", "5"]) == 0
    assert interrupted[0]["plan"] == (PlannedFault("drive", "unplug", 20.0, 3.0),)
    assert interrupted[0]["seed"] == 5
    assert main(["sim", "office", "--faults", "drive:unplug@soon"]) == 78
    assert capsys.readouterr().err.splitlines()[-1].startswith("expected DEVICE:FAULT@START[+DURATION], as in drive")


def test_the_help_says_what_every_fault_does(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["sim", "--help"])
    said = " ".join(capsys.readouterr().out.split())
    assert all(f"{word} {meaning_of(word)}" in said for word in FAULTS)


def test_a_log_that_there_is_not_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["import", "carmen", str(tmp_path / "no.log"), "--out", str(tmp_path / "x")]) == 1
    assert len(capsys.readouterr().err.splitlines()) == 1


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    file = tmp_path / "a.mcap"
    recorder = Recorder(file, RecordingHeader("0.1.0", "[sweep]\nreadings = 24\n", 7, 0, 0))
    recorder.note(BytesEntry(1_000_000_000, "drive", Direction.TO_BOARD, b"abc"))
    recorder.close()
    return file


def test_a_fake_writes_the_configuration_of_the_recorded_robot(
    interrupted: list[dict[str, Any]], recording: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "again" / "robotd.toml"
    assert main(["fake", str(recording), "--write-config", str(file)]) == 0
    assert set(interrupted[0]["robot"].boards) == {"drive", "pantilt", "rangefinder"}
    config = load(file)
    assert (config.sweep.readings, config.pantilt.port) == (24, "/dev/pts/8")
    assert config.recording.dir == str(tmp_path / "again" / "recordings")
    assert "0 requests were not the recorded ones" in capsys.readouterr().out


def test_a_fake_that_was_asked_otherwise_is_exit_code_1(
    interrupted: list[dict[str, Any]],
    recording: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    different = (Difference(5, "drive", "Arm()", "Stop()"),)
    monkeypatch.setattr("robotd.cli.simulated.FakeRobot.mismatches", different)
    assert main(["fake", str(recording), "--json"]) == 1
    devices, end = map(json.loads, capsys.readouterr().out.splitlines())
    assert devices["devices"]["drive"] == "/dev/pts/7"
    assert end["mismatches"] == [{"time_ns": 5, "device": "drive", "expected": "Arm()", "actual": "Stop()"}]
    assert main(["fake", str(recording)]) == 1
    assert "1 requests were not the recorded ones" in capsys.readouterr().out


@pytest.mark.parametrize("words", [["demo", "room"], ["demo", "building", "LOG"]])
def test_a_demonstration_without_matplotlib_is_refused_before_it_begins(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "robotd.cli.pictures.sheet", None)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "LOG").write_text("\n".join(flaser()))
    assert main(words) == 1
    said = capsys.readouterr().err
    assert said.startswith(f"robotctl: {' '.join(words[:2])} needs matplotlib (")
    assert "install the extra plots, pip install 'robotd[plots]'" in said
    assert not (tmp_path / "demo").exists()


def test_a_world_without_places_to_be_found_at_makes_no_demonstration(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    world = tmp_path / "bare.toml"
    text = (WORLDS_DIR / "office.toml").read_text()
    world.write_text("\n".join(line for line in text.splitlines() if not line.startswith("probes_m")))
    assert main(["demo", "room", str(world), "--out", str(tmp_path / "demo")]) == 1
    assert "has no probes_m" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["--keep-out-every", "1"], "1 would keep every stop out of the map"),
        (["--limit", "0"], "must be at least 1, got 0"),
        (["--spacing-m", "0"], "must be positive"),
        (["--spacing-m", "nan"], "must be a finite number"),
        (["--fov-deg", "361"], "must be from 1 to 360"),
        (["--range-max", "-1"], "must be positive"),
    ],
)
def test_what_no_building_can_be_made_with_is_wrong_usage(
    words: list[str], complaint: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = tmp_path / "a.log"
    log.write_text("\n".join(flaser()))
    with pytest.raises(SystemExit) as left:
        main(["import", "carmen", str(log), "--out", str(tmp_path / "x"), *words])
    assert left.value.code == 2
    assert complaint in capsys.readouterr().err


def test_what_must_be_known_of_a_log_is_said_when_it_is_imported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = tmp_path / "a[1].log"
    whole = flaser(count=512)
    odometry = [f"ODOM {' '.join(line.split()[514:517])} 0 0 0 1 h 1" for line in whole]
    lines = [line for pair in zip(odometry, whole, strict=True) for line in pair]
    log.write_text("\n".join([*lines, "FLASER 512 1 2"]))
    assert main(["import", "carmen", str(log), "--out", str(tmp_path / "x")]) == 0
    said = capsys.readouterr().err.splitlines()
    assert [line.partition(": ")[2][:30] for line in said] == [
        "a damaged line was left out: l",
        "512 beams and no PARAM for the",
        "ITS POSES ARE RAW ODOMETRY (th",
    ]
    assert all(line.startswith(str(log)) for line in said)
    assert main(["eval", str(log), "--cases", "1"]) == 1
    assert capsys.readouterr().err.splitlines()[-1].endswith("--raw takes them all the same")
    assert main(["eval", str(log), "--cases", "1", "--raw", "--json"]) == 0
    report = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert (report["poses"], report["damaged_lines"]) == ("raw odometry", 1)
    assert main(["demo", "building", str(log), "--out", str(tmp_path / "demo")]) == 1
    assert not (tmp_path / "demo").exists()


def test_import_believes_no_range_beyond_what_it_is_told(tmp_path: Path) -> None:
    log = tmp_path / "a.log"
    log.write_text("\n".join(flaser()))
    assert main(["import", "carmen", str(log), "--out", str(tmp_path / "x"), "--range-max", "2"]) == 0
    building = load_recorded_building(tmp_path / "x")
    assert max(range_m for stop in building.stops for range_m in stop.ranges_m if range_m is not None) <= 2.0
    assert all(stop.missed for stop in building.stops)


@pytest.mark.slow
def test_a_whole_daemon_explores_an_office_and_is_held_against_who_knows_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sim", "office", "--explore", "--seeds", "1", "--json"]) == 0
    (one,) = json.loads(capsys.readouterr().out)
    assert one["ended_by_itself"]
    assert one["seen_share"] >= 0.98
    assert one["worst_m"] <= 0.15
    assert one["stops"] <= 8
    assert 1 <= one["tour_stops"] <= one["stops"]
