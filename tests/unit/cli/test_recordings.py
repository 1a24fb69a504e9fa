"""``record info`` says what a file holds; ``replay`` says whether the same bytes gave the same results."""

import json
from dataclasses import dataclass
from pathlib import Path

import pytest

from robotd.cli.main import main
from robotd.core.errors import RecordingError
from robotd.hardware.link.tap import Direction
from robotd.recording.comparison import Difference
from robotd.recording.entries import BytesEntry, RecordingHeader, ResultEntry
from robotd.recording.recorder import Recorder


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    file = tmp_path / "a.mcap"
    recorder = Recorder(file, RecordingHeader("0.1.0", "", 7, 1_700_000_000_000_000_000, 0))
    recorder.note(BytesEntry(1_000_000_000, "drive", Direction.TO_BOARD, b"abc"))
    recorder.note(BytesEntry(1_500_000_000, "pantilt", Direction.FROM_BOARD, b"defg"))
    recorder.note(ResultEntry(2_500_000_000, "sweep", {}, "d"))
    recorder.close()
    return file


def test_a_recording_is_described(recording: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["record", "info", str(recording)]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert said == (
        "made by robotd 0.1.0 began 2023-11-14 22:13:20 UTC lasts 2.5 s "
        "holds 3 entries, 7 bytes of drive, pantilt results 1 whole yes"
    )
    assert main(["record", "info", str(recording), "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert (facts["duration_s"], facts["devices"], facts["damage"]) == (2.5, ["drive", "pantilt"], None)


def test_a_recording_that_was_cut_is_described_and_exit_code_1(
    recording: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording.write_bytes(recording.read_bytes()[:-40])
    assert main(["record", "info", str(recording)]) == 1
    assert "a.mcap: damaged: " in capsys.readouterr().err


def test_what_is_no_recording_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "b.mcap").write_bytes(b"hello")
    for verb in (["record", "info"], ["replay"]):
        assert main([*verb, str(tmp_path / "b.mcap")]) == 1
        assert len(capsys.readouterr().err.splitlines()) == 1


@pytest.fixture
def here(recording: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Work where the recording is: ``a.mcap``."""
    monkeypatch.chdir(recording.parent)


@dataclass(frozen=True)
class Report:
    digest: str = "ab12"
    recorded_digest: str = "ab12"
    results: int = 3
    differences: tuple[Difference, ...] = ()
    complete: bool = True
    duration_s: float = 12.5
    recorded_by: str = "0.2.0"
    replayed_by: str = "0.2.0"


@pytest.mark.usefixtures("here")
def test_a_replay_that_gave_the_same_is_exit_code_0(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("robotd.app.replaying.replay_recording", lambda path: Report())
    assert main(["replay", "a.mcap"]) == 0
    assert capsys.readouterr().out == "3 results in 12.5 s of recording: the same\ndigest ab12\n"
    assert main(["replay", "a.mcap", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {
        "digest": "ab12",
        "recorded_digest": "ab12",
        "results": 3,
        "differences": [],
        "complete": True,
        "duration_s": 12.5,
        "recorded_by": "0.2.0",
        "replayed_by": "0.2.0",
        "file": "a.mcap",
        "same": True,
    }


@pytest.mark.usefixtures("here")
def test_a_replay_that_differs_shows_where_and_is_exit_code_1(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    difference = Difference(1_250_000_000, "drive", "Arm()", "nothing")
    monkeypatch.setattr(
        "robotd.app.replaying.replay_recording", lambda path: Report(differences=(difference,), complete=False)
    )
    assert main(["replay", "a.mcap"]) == 1
    first, verdict, _ = capsys.readouterr().out.splitlines()
    assert first == "1.250000 s drive: expected Arm(), got nothing"
    assert verdict.endswith("1 difference, up to where the recording is damaged")
    assert main(["replay", "a.mcap", "--json"]) == 1
    document = json.loads(capsys.readouterr().out)
    assert document["same"] is False
    assert document["differences"] == [
        {"time_ns": 1_250_000_000, "device": "drive", "expected": "Arm()", "actual": "nothing"}
    ]


@pytest.mark.usefixtures("here")
def test_a_replay_of_another_version_that_differs_names_both(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    difference = Difference(1_250_000_000, "drive", "Arm()", "nothing")
    for differences, is_told in (((), False), ((difference,), True)):
        report = Report(differences=differences, recorded_by="0.1.0")
        monkeypatch.setattr("robotd.app.replaying.replay_recording", lambda path, report=report: report)
        assert main(["replay", "a.mcap"]) == int(is_told)
        said = " ".join(capsys.readouterr().out.split())
        assert ("recorded by robotd 0.1.0, replayed by robotd 0.2.0: between versions planned ways" in said) == is_told


@pytest.mark.usefixtures("here")
def test_a_replay_that_cannot_go_on_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(path: Path) -> Report:
        raise RecordingError("it holds nothing")

    monkeypatch.setattr("robotd.app.replaying.replay_recording", fail)
    assert main(["replay", "a.mcap"]) == 1
    assert capsys.readouterr().err == "robotctl: it holds nothing\n"
