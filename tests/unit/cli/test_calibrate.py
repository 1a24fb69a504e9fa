"""``calibrate`` from the command line: who is asked what, what is written, and what ends it."""

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robotd.calibration.found import Calibration, Found, Procedure, Residuals, Seen, Step
from robotd.cli.guide import guided
from robotd.cli.main import main
from robotd.config import Config, effective_text, load
from robotd.contract.events import MissionPhase, MissionProgress, SweepDone
from robotd.contract.missions import DriveStraight, Mission, Scan
from robotd.core.errors import RequestTimeout
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry
from robotd.core.reading import Sweep
from tests.unit.cli.conftest import STATUS

FOUND = Calibration(
    (
        Found("drive", "counts_per_m", "1/m", 27_231.456_78, 12.0, 25_000.0),
        Found("drive", "counts_per_rad", "1/rad", 4_094.0, 1.0, 4_400.0),
    ),
    (Residuals("straight legs", "m", np.array([0.001, -0.002])), Residuals("turns", "rad", np.zeros(2))),
)


@pytest.fixture
def robot(client: Any, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A robot that is idle, and whose calibration comes to what was FOUND."""
    monkeypatch.setattr("robotd.cli.verbs.calibrate.connect", lambda arguments: client)
    monkeypatch.setattr("robotd.cli.verbs.calibrate.guided", lambda *_: FOUND)
    monkeypatch.setattr(client, "config", lambda: effective_text(Config()), raising=False)
    return client


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "robotd.toml"
    path.write_text("# Our robot.\n[drive]\ncounts_per_m = 25000.0  # by chalk\ncounts_per_rad = 4400.0\n")
    return path


@pytest.mark.parametrize("what", [["odometry"], ["heading"], ["head"], ["range", "--wall", "1.5"]])
def test_what_was_found_is_shown_and_written_with_yes(
    robot: Any, file: Path, what: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    png = file.with_name("left.png")
    assert main(["calibrate", *what, "--yes", "--config", str(file), "--png", str(png)]) == 0
    config = load(file)
    assert (config.drive.counts_per_m, config.drive.counts_per_rad) == (27_231.46, 4_094.0)
    assert "# counts_per_m = 25000.0  # by chalk  # before it was calibrated" in file.read_text()
    assert png.read_bytes().startswith(b"\x89PNG")
    said = capsys.readouterr().out
    assert "drive.counts_per_m    25000  27231.46  12" in said
    assert "straight legs: -2.00 |" in said


def test_where_nobody_can_be_asked_nothing_begins(robot: Any, file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = file.read_text()
    assert main(["calibrate", "odometry", "--config", str(file)]) == 1
    assert "it drives 1.5 m ahead and back, twice" in capsys.readouterr().err
    assert file.read_text() == before


@pytest.mark.parametrize(("answers", "is_written"), [(["y\n", "y\n"], True), (["y\n", "n\n"], False), (["\n"], False)])
def test_somebody_is_asked_before_it_moves_and_before_it_writes(
    robot: Any, file: Path, monkeypatch: pytest.MonkeyPatch, answers: list[str], is_written: bool
) -> None:
    stdin = iter(answers)
    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    monkeypatch.setattr("sys.stdin.readline", lambda: next(stdin))
    before = file.read_text()
    assert main(["calibrate", "head", "--config", str(file)]) == 0
    assert (file.read_text() != before) == is_written
    assert list(stdin) == []


def test_a_robot_that_is_not_armed_is_not_calibrated(
    robot: Any, file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(robot, "status", lambda: replace(STATUS, mode="disarmed"))
    assert main(["calibrate", "heading", "--yes", "--config", str(file)]) == 1
    assert "robotctl arm" in capsys.readouterr().err


def test_json_is_what_was_found(robot: Any, file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["calibrate", "head", "--yes", "--json", "--config", str(file)]) == 0
    assert [one["key"] for one in json.loads(capsys.readouterr().out)] == ["counts_per_m", "counts_per_rad"]


def test_an_interrupt_stops_the_robot(robot: Any, file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> Calibration:
        raise KeyboardInterrupt

    monkeypatch.setattr("robotd.cli.verbs.calibrate.guided", interrupted)
    assert main(["calibrate", "head", "--yes", "--config", str(file)]) == 130
    assert ("stop", "interrupted at the command line") in robot.asked


def test_a_procedure_is_sent_what_was_seen(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """The counts are those of odometry measured after the mission's end, not the last that was told before."""
    seen: list[Seen] = []

    def procedure() -> Procedure:
        seen.append((yield Step(DriveStraight(1.0), "drive")))
        seen.append((yield Step(Scan(), "look")))
        return FOUND

    sweep = Sweep(3, IDENTITY, ())

    def run(mission: Mission) -> Iterator[Any]:
        client.asked.append(mission)
        if isinstance(mission, Scan):
            yield SweepDone(5, sweep)
        yield MissionProgress(6, 7, "any", MissionPhase.DONE, 1, 1, "done")

    monkeypatch.setattr(client, "run_mission", run)
    told: list[str] = []
    client.published = [Odometry(5, IDENTITY, STANDSTILL, (1, 1)), Odometry(7, IDENTITY, STANDSTILL, (27_300, -2))]
    assert guided(client, procedure(), told.append) is FOUND
    assert seen == [Seen((27_300, -2), None), Seen((27_300, -2), sweep)]
    assert told == ["1: drive", "2: look"]
    client.published = []
    with pytest.raises(RequestTimeout, match="no odometry"):
        guided(client, procedure(), told.append)
