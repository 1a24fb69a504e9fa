"""What ``robotctl eval --slam`` promises: figures beside raw odometry, for people and for programs."""

import json
import math
from pathlib import Path

import pytest

from robotd.cli.main import main
from robotd.cli.surveys import relations_beside
from robotd.core.errors import RecordingError
from robotd.core.pose import Pose2
from robotd.sim.buildings.log_file import read_log
from tests.support.recorded_room import drive_lines


@pytest.fixture
def log_file(tmp_path: Path) -> Path:
    """A drive whose odometry turns half a degree too far at each scan, and true relations beside it."""
    lines = [line.removesuffix("1 host 1") + f"{at}.5 host {at}.5" for at, line in enumerate(drive_lines(120))]
    true = tmp_path / "true.log"
    true.write_text("\n".join(lines))
    poses = [scan.robot_pose for scan in read_log(true).scans]
    file = tmp_path / "room.raw.clf"
    file.write_text("\n".join(_drifting(lines, poses)))
    pairs = [(at, at + 35) for at in range(0, 80, 8)]
    steps = [(one, other, poses[one].inverse() @ poses[other]) for one, other in pairs]
    (tmp_path / "room.relations").write_text(
        "\n".join(f"{one}.5 {other}.5 {s.x_m} {s.y_m} 0 0 0 {s.heading_rad}" for one, other, s in steps)
    )
    return file


def _drifting(lines: list[str], poses: list[Pose2]) -> list[str]:
    drifted = poses[0]
    found = []
    for at, line in enumerate(lines):
        if at:
            drifted = drifted @ poses[at - 1].inverse() @ poses[at] @ Pose2(0.004, 0.0, math.radians(0.5))
        ranges, tail = line.split()[:92], f"{at}.5 host {at}.5"
        pose = f"{drifted.x_m:.4f} {drifted.y_m:.4f} {drifted.heading_rad:.5f}"
        found.append(" ".join([*ranges, pose, pose, tail]))
    return found


def test_it_maps_from_raw_odometry_and_tells_how_much_better_that_is(
    log_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "report.jsonl"
    assert main(["eval", "--slam", str(log_file), "--clear", "3", "--json", str(file)]) == 0
    said = capsys.readouterr().out
    parameters, report = [json.loads(line) for line in file.read_text().splitlines()]
    assert "survey" in parameters["parameters"]
    found = report["slam"]
    assert (found["scans"], found["relations"], found["unknown_relations"]) == (120, 10, 0)
    assert 5 <= found["stops"] < 60
    metres = {how: errors["metres"]["mean"] for how, errors in found["errors"].items()}
    assert metres["located"] < 0.05 < metres["raw odometry"]
    assert metres["front end alone"] < metres["raw odometry"]
    assert f"{metres['located']:.4f}" in said
    assert "raw odometry" in said
    assert "placed" in said


def test_a_log_without_relations_beside_it_is_refused(log_file: Path) -> None:
    assert relations_beside(log_file) == log_file.with_name("room.relations")
    log_file.with_name("room.relations").unlink()
    with pytest.raises(RecordingError, match=r"looked for room\.relations"):
        relations_beside(log_file)
