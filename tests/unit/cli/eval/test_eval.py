"""What ``robotctl eval`` promises: the protocol to the letter, shares that add up, and nothing lost to Ctrl-C."""

import bz2
import gzip
import json
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.image import imread

from robotd.cli.main import main
from robotd.core.reading import ReadingStatus
from robotd.evaluation.division import divide
from robotd.evaluation.recorded import Reach, map_of, readings_of
from robotd.evaluation.running import Searcher
from robotd.grid.occupancy import GridSettings
from robotd.logs.carmen import parse_carmen
from robotd.logs.scan import RecordedLog

REACH = Reach(range_max_m=4.0, clear_m=3.0)


@pytest.fixture
def log(log_text: str) -> RecordedLog:
    return parse_carmen(log_text.splitlines())


@given(scans=st.integers(1, 2600), cases=st.integers(1, 150), seed=st.integers(0, 5))
@settings(max_examples=30, deadline=None)
def test_a_log_is_divided_as_the_protocol_says(log_text: str, scans: int, cases: int, seed: int) -> None:
    scan = parse_carmen(log_text.splitlines()[:1]).scans[0]
    division = divide(RecordedLog((scan,) * scans, 80.0), cases, seed)
    kept = list(range(scans))[:: 4 if scans > 2000 else 1]
    odd = kept[1::2]
    chosen: Any = np.random.default_rng(seed).choice(len(odd), min(cases, len(odd)), replace=False) if odd else []
    assert [query.number for query in division.queries] == [odd[index] for index in chosen]
    assert len(division.map_scans) == len(kept[::2])


def test_what_came_back_is_a_hit_and_what_did_not_is_free_up_to_the_limit(log: RecordedLog) -> None:
    scan = next(scan for scan in log.scans if scan.missed.any())
    readings = readings_of(scan, REACH)
    beyond = int((scan.hit & (scan.ranges_m > REACH.range_max_m)).sum())
    missed = [reading for reading in readings if reading.status is ReadingStatus.MISS]
    assert len(missed) == int(scan.missed.sum()) + beyond
    assert {reading.range_m for reading in missed} == {REACH.clear_m}
    hits = [reading.range_m for reading in readings if reading.status is ReadingStatus.OK]
    assert hits == scan.ranges_m[scan.hit & (scan.ranges_m <= REACH.range_max_m)].tolist()


def test_a_beam_of_range_zero_says_nothing() -> None:
    [scan] = parse_carmen(["FLASER 4 0 1 1 1 0 0 0 0 0 0 1 h 1"]).scans
    assert [reading.range_m for reading in readings_of(scan, REACH)] == [1.0, 1.0, 1.0]


def test_the_map_holds_every_hit_where_the_log_has_it(log: RecordedLog) -> None:
    grid = map_of(log.scans, REACH, GridSettings(rows=1, cols=1, raise_alpha=0.5, lower_alpha=0.9))
    occupied = np.argwhere(grid.cells > 200)
    x_m, y_m = np.array([grid.spec.centre_of(row, col) for row, col in occupied]).T
    assert (x_m.min(), x_m.max(), y_m.min(), y_m.max()) == pytest.approx((0.0, 5.0, 0.0, 3.0), abs=0.06)


def run_eval(*words: str | Path) -> int:
    return main(["eval", *map(str, words), "--range-max", "4", "--clear", "3"])


def test_shares_add_up_and_a_room_without_symmetry_is_recognized(
    log_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "report.json"
    assert run_eval(log_file, "--cases", "6", "--json", file) == 0
    said = capsys.readouterr().out
    document = json.loads(file.read_text())
    [report] = document["logs"]
    assert (report["cases"], report["asked"], report["interrupted"], report["map_scans"]) == (6, 6, False, 30)
    shares = [report[name] for name in ("right", "wrong_and_sure", "ambiguous", "lost")]
    assert sum(shares) == pytest.approx(1.0)
    assert report["right"] >= 0.5
    assert report["wrong_and_sure"] == 0.0
    assert report["ambiguous_with_truth"] == report["ambiguous"]
    assert report["error_m"]["p50"] < 0.1
    assert report["cpu_s"]["p50"] > 0.0
    assert re.search(rf"right +{100 * report['right']:.1f} %", said)
    assert document["parameters"]["grid"]["resolution_m"] == 0.05
    assert len(report["results"]) == 6


@pytest.mark.parametrize("compress", [gzip.compress, bz2.compress])
def test_the_same_cases_give_the_same_answers_whatever_the_compression(
    log_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], compress: Any
) -> None:
    packed = tmp_path / "room.log.packed"
    packed.write_bytes(compress(log_file.read_bytes()))
    assert run_eval(log_file, packed, "--cases", "2", "--json") == 0
    one, other = json.loads(capsys.readouterr().out)["logs"]
    times = {"cpu_s", "wall_s"}
    results = [[{k: v for k, v in case.items() if k not in times} for case in log["results"]] for log in (one, other)]
    assert results[0] == results[1]


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
    monkeypatch.setattr(Searcher, "cases", None)
    assert run_eval(log_file, "--pictures", tmp_path) == 1
    assert "--pictures needs matplotlib" in capsys.readouterr().err


def test_ctrl_c_keeps_what_was_done(
    log_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = Searcher.cases

    def interrupted(self: Searcher, queries: Any) -> Any:
        yield next(whole(self, queries))
        raise KeyboardInterrupt

    monkeypatch.setattr(Searcher, "cases", interrupted)
    file = tmp_path / "report.json"
    assert run_eval(log_file, log_file, "--cases", "5", "--json", file) == 130
    assert "interrupted after 1 of 5 cases" in capsys.readouterr().out
    [report] = json.loads(file.read_text())["logs"]
    assert (report["cases"], report["interrupted"]) == (1, True)


def test_a_damaged_log_is_named_with_line_and_expectation_before_any_work(
    log_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(Searcher, "cases", None)
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
    [report] = json.loads(capsys.readouterr().out)["logs"]
    assert (report["map_scans"], report["cases"], report["error_m"]) == (1, 0, None)


def test_a_log_is_never_overwritten_by_the_report(log_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = log_file.read_bytes()
    assert main(["eval", str(log_file), "--json", str(log_file)]) == 1
    assert "is not a JSON document of eval; it is left as it is" in capsys.readouterr().err
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
