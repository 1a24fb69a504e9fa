"""What ``robotctl eval`` promises: shares that add up, a line for each result, and nothing lost to Ctrl-C."""

import bz2
import gzip
import json
import re
import sys
from pathlib import Path
from typing import Any

import pytest
from matplotlib.image import imread

from robotd.cli.eval_lines import answered_before
from robotd.cli.main import main
from robotd.evaluation.division import Query
from robotd.evaluation.map_recipe import MapRecipe
from robotd.evaluation.result import CaseResult
from robotd.evaluation.seeking import Seeking
from tests.support.recorded_room import drive_lines


@pytest.fixture(scope="session")
def log_text() -> str:
    return "\n".join(drive_lines(60))


@pytest.fixture
def log_file(tmp_path: Path, log_text: str) -> Path:
    file = tmp_path / "room.log"
    file.write_text(log_text)
    return file


def documents(text: str) -> tuple[Any, list[Any], list[Any]]:
    """Return the parameters, the results and the reports of logs among JSON lines."""
    first, *lines = [json.loads(line) for line in text.splitlines()]
    return first["parameters"], [line for line in lines if "scan" in line], [line for line in lines if "scans" in line]


def timeless(file: Path) -> list[Any]:
    """Return all documents of a file of lines without what is measured by a clock."""
    lines = [json.loads(line) for line in file.read_text().splitlines()]
    return [{key: value for key, value in line.items() if key not in {"cpu_s", "wall_s"}} for line in lines]


def run_eval(*words: str | Path) -> int:
    return main(["eval", *map(str, words), "--range-max", "4", "--clear", "3"])


def test_shares_add_up_and_a_room_without_symmetry_is_recognized(
    log_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "report.json"
    assert run_eval(log_file, "--cases", "6", "--json", file) == 0
    said = capsys.readouterr().out
    parameters, results, [report] = documents(file.read_text())
    assert (report["cases"], report["asked"], report["interrupted"], report["map_scans"]) == (6, 6, False, 30)
    shares = [report[name] for name in ("right", "wrong_and_sure", "ambiguous", "lost")]
    assert sum(shares) == pytest.approx(1.0)
    assert report["right"] >= 0.5
    assert report["wrong_and_sure"] == 0.0
    assert report["ambiguous_with_truth"] == report["ambiguous"]
    assert report["error_m"]["p50"] < 0.1
    assert report["cpu_s"]["p50"] > 0.0
    assert re.search(rf"right +{100 * report['right']:.1f} %", said)
    assert parameters["grid"]["resolution_m"] == [0.05]
    assert len(results) == 6


@pytest.mark.usefixtures("no_tracker_is_left")
def test_every_way_to_ask_is_a_line_of_the_table(
    log_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, other = tmp_path / "report.jsonl", tmp_path / "other.log"
    other.write_bytes(log_file.read_bytes())
    words = ["--protocol", "half", "--protocol", f"other={other}", "--protocol", "degrade=trinary"]
    assert (
        run_eval(log_file, *words, "--resolution", "0.05", "0.1", "--cases", "1", "--workers", "2", "--json", file) == 0
    )
    _, results, reports = documents(file.read_text())
    asked = [(report["protocol"], report["map"]["resolution_m"]) for report in reports]
    names = ["half", "other=other.log", "degrade=trinary"]
    assert asked == [(name, side_m) for name in names for side_m in (0.05, 0.1)]
    assert len({(result["protocol"], result["settings"]) for result in results}) == 6
    said = capsys.readouterr().out
    assert "room.log other=other.log 100 mm" in said
    assert "belief said" in said


def test_a_protocol_that_is_none_is_wrong_usage(log_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["eval", str(log_file), "--protocol", "degrade=melted"])
    assert "expected one of interleaved, half, other=LOG, degrade=thicker-1" in capsys.readouterr().err


@pytest.mark.parametrize("compress", [gzip.compress, bz2.compress])
def test_the_same_cases_give_the_same_answers_whatever_the_compression(
    log_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], compress: Any
) -> None:
    packed = tmp_path / "room.log.packed"
    packed.write_bytes(compress(log_file.read_bytes()))
    assert run_eval(log_file, packed, "--cases", "2", "--json") == 0
    _, results, _ = documents(capsys.readouterr().out)
    told = [{k: v for k, v in case.items() if k not in {"cpu_s", "wall_s", "log"}} for case in results]
    assert told[:2] == told[2:]


def test_each_failure_has_its_picture(log_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config = tmp_path / "robotd.toml"
    config.write_text("[localization]\nlocalized_share = 1.0\nreadings_min = 200\n")
    assert run_eval(log_file, "--cases", "2", "--config", config, "--pictures", tmp_path / "failures") == 0
    assert re.search(r"lost +100.0 %", capsys.readouterr().out)
    files = sorted((tmp_path / "failures").glob("room-*-lost.png"))
    assert len(files) == 2
    assert imread(files[0]).shape[0] > 300


def test_pictures_without_matplotlib_are_refused_before_any_work(
    log_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delitem(sys.modules, "robotd.cli.pictures.failures", raising=False)
    monkeypatch.delitem(sys.modules, "robotd.cli.pictures.sheet", raising=False)
    monkeypatch.setitem(sys.modules, "matplotlib.axes", None)
    monkeypatch.setattr(Seeking, "__call__", None)
    assert run_eval(log_file, "--pictures", tmp_path) == 1
    assert "--pictures needs matplotlib" in capsys.readouterr().err


def test_ctrl_c_keeps_what_was_done(
    log_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = Seeking.__call__
    answered: list[Query] = []

    def interrupted(self: Seeking, query: Query) -> CaseResult:
        if answered:
            raise KeyboardInterrupt
        answered.append(query)
        return whole(self, query)

    monkeypatch.setattr(Seeking, "__call__", interrupted)
    file = tmp_path / "report.json"
    assert run_eval(log_file, log_file, "--cases", "5", "--json", file) == 130
    assert "interrupted after 1 of 5 cases" in capsys.readouterr().out
    _, results, [report] = documents(file.read_text())
    assert (len(results), report["cases"], report["interrupted"]) == (1, 1, True)


def test_a_run_that_was_ended_goes_on_where_it_was(
    log_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Ended by a kill: what it had written lies beside the file, and its last line is cut off."""
    whole, file = tmp_path / "whole.jsonl", tmp_path / "report.jsonl"
    assert run_eval(log_file, "--cases", "4", "--json", whole) == 0
    first, *lines = whole.read_text().splitlines(keepends=True)
    Path(f"{file}.part").write_text(first + "".join(lines[:2]) + lines[2][:40])
    asked: list[int] = []
    answer = Seeking.__call__

    def counted(self: Seeking, query: Query) -> CaseResult:
        asked.append(query.number)
        return answer(self, query)

    monkeypatch.setattr(Seeking, "__call__", counted)
    assert run_eval(log_file, "--cases", "4", "--json", file, "--resume") == 0
    assert asked == [result["scan"] for result in documents(whole.read_text())[1][2:]]
    assert timeless(file) == timeless(whole)
    # What is whole is told again, and neither asked nor mapped; a kill at once loses nothing, for it is in the file.
    asked.clear()
    monkeypatch.setattr(MapRecipe, "made", None)
    before = file.read_text()
    Path(f"{file}.part").write_text(before[:10])
    assert answered_before(file).results.keys() == answered_before(whole).results.keys()
    assert run_eval(log_file, "--cases", "4", "--json", file, "--resume") == 0
    assert (asked, file.read_text()) == ([], before)
    monkeypatch.undo()
    monkeypatch.setattr(Seeking, "__call__", counted)
    # Of another program no answer is taken over, and without a file there is nothing to go on with.
    file.write_text(file.read_text().replace('"commit": "', '"commit": "another'))
    asked.clear()
    assert run_eval(log_file, "--cases", "4", "--json", file, "--resume") == 0
    assert len(asked) == 4
    assert run_eval(log_file, "--cases", "4", "--resume") == 1
    assert "name it by --json" in capsys.readouterr().err


def test_a_damaged_log_is_named_with_line_and_expectation_before_any_work(
    log_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(Seeking, "__call__", None)
    bad = tmp_path / "bad.log"
    bad.write_text("# a log\nFLASER 3 1.0 x 1.0 0 0 0 0 0 0 1 h 1\n")
    assert run_eval(log_file, bad) == 1
    said = capsys.readouterr().err
    assert "bad.log: there is no whole scan in it; the only damaged line is line 2: FLASER: 'x' is no number" in said
    assert "expected n r_1 .. r_n laser_x" in said


def test_a_log_with_one_scan_makes_a_map_and_no_case(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "one.log"
    file.write_text("FLASER 4 1 1 1 1 0 0 0 0 0 0 1 h 1\n")
    assert run_eval(file, "--json") == 0
    _, _, [report] = documents(capsys.readouterr().out)
    assert (report["map_scans"], report["cases"], report["error_m"]) == (1, 0, None)


def test_a_log_is_never_overwritten_by_the_report(log_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = log_file.read_bytes()
    assert main(["eval", str(log_file), "--json", str(log_file)]) == 1
    assert "is not a file of JSON lines of eval; it is left as it is" in capsys.readouterr().err
    assert log_file.read_bytes() == before


@pytest.mark.parametrize(
    ("option", "value", "complaint"),
    [
        ("--resolution", "50", "--resolution: must be 0.005 to 2 m, got 50; mm? then 0.05"),
        ("--raise-alpha", "30", "--raise-alpha: must be 0 to 0.99, got 30; %? then 0.3"),
        ("--lower-alpha", "nan", "--lower-alpha: must be a finite number, got nan"),
    ],
)
def test_what_no_map_can_have_is_wrong_usage(
    option: str, value: str, complaint: str, log_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main(["eval", str(log_file), option, value])
    assert capsys.readouterr().err.endswith(f"error: argument {complaint}\n")
