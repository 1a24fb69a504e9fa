"""Every table of the command line says what its columns are, with their units, and shows names as they are."""

import io
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from rich.text import Text

from robotd.cli.demo.mission import Trial, print_trials
from robotd.cli.main import main
from robotd.cli.show.terminal import bold, plain_console, print_pairs, print_table
from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from tests.support.carmen_room import POSES
from tests.support.recorded_room import drive_lines
from tests.unit.cli.conftest import ESTIMATE

ROOT = Path(__file__).parents[3]
STRANGE = "[mm] [/red] [bold] :snake: \\[x]"


def columns(line: str) -> list[str]:
    return re.split(r"  +", line.strip())


def test_no_console_takes_words_for_markup(capsys: pytest.CaptureFixture[str]) -> None:
    file = io.StringIO()
    plain_console(file).print(STRANGE)
    plain_console(file).print(bold(STRANGE) + STRANGE)
    assert file.getvalue() == f"{STRANGE}\n{STRANGE}{STRANGE}\n"
    print_table((STRANGE, "b"), [(STRANGE, 1)])
    print_pairs([(STRANGE, STRANGE)])
    said = capsys.readouterr().out.splitlines()
    assert [columns(line) for line in said] == [[STRANGE, "b"], [STRANGE, "1"], [STRANGE, STRANGE]]


def test_every_console_is_made_in_one_place() -> None:
    makers = {file.name for file in (ROOT / "robotd").rglob("*.py") if "Console(" in file.read_text()}
    assert makers == {"terminal.py"}


def test_words_that_stand_out_end_where_they_end() -> None:
    words = bold("loud") + " and soft"
    assert isinstance(words, Text)
    assert [(span.start, span.end, span.style) for span in words.spans] == [(0, 4, "bold")]
    assert words.style == ""


def test_the_tables_of_eval(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = tmp_path / "a[b].log"
    log.write_text("\n".join(drive_lines(60)))
    assert main(["eval", str(log), str(log), "--cases", "2", "--range-max", "4", "--clear", "3"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("a[b].log: 2 cases; map of 30 of 60 scans, ")
    for name in (
        "position error of the right [mm]",
        "heading error of the right [deg]",
        "processor time of a case [ms]",
        "time to the answer [ms]",
    ):
        [line, other] = [line for line in said if line.strip().startswith(name)]
        assert len(columns(line)) == len(columns(other)) == 5
    heads = [columns(line) for line in said if line.strip().startswith("50 %")]
    assert heads == [["50 %", "90 %", "99 %", "most"]] * 2
    [summary] = [line for line in said if line.strip().startswith("log ")]
    assert columns(summary) == [
        "log",
        "cases",
        "right",
        "wrong and sure",
        "ambiguous",
        "lost",
        "with truth",
        "right nearby",
        "error",
        "CPU 50 %",
        "CPU 90 %",
        "CPU 99 %",
        "most",
    ]
    [total] = [columns(line) for line in said if line.strip().startswith("all ")]
    assert total[1] == "4"
    assert re.fullmatch(r"\d+\.\d % of 4", total[7])
    assert total[-1].endswith(" ms")
    assert total[-5].endswith(" mm")
    for words in ("right", "wrong and sure", "ambiguous", "lost"):
        assert any(re.fullmatch(rf"{words} +\d+\.\d %", line.strip()) for line in said)


def test_the_table_of_a_demonstration() -> None:
    file = io.StringIO()
    readings = (RangeReading(0, 0.0, ReadingStatus.OK, 1.0),)
    print_trials(plain_console(file, 120), [Trial(Sweep(1, POSES[0], readings), Pose2(1.0, 2.01, 0.0), ESTIMATE)])
    head, units, row, total = file.getvalue().splitlines()
    assert columns(head) == ["error", "error", "rank /"]
    assert columns(units) == ["truth [m]", "estimate [m]", "[mm]", "[deg]", "readings", "regions", "state"]
    assert columns(row) == ["1", "1.000, 2.010", "1.000, 2.000", "10", "+0.00", "280 / 300", "1", "localized"]
    assert total == "  1 of 1 localized; median error 10 mm"


def test_the_tables_of_a_status(
    client: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    strange = DeviceStatus("drive", LinkState.ABSENT, armed=False, detail="no [/dev/ttyUSB0] [red]")
    status = replace(client.status(), devices=(strange, *client.status().devices[1:]))
    monkeypatch.setattr(client, "status", lambda: status)
    assert main(["status"]) == 0
    said = [columns(line) for line in capsys.readouterr().out.splitlines()]
    assert ["battery", "24.5 V"] in said
    assert ["device", "link", "motion", "faults", "detail"] in said
    assert ["drive", "absent", "disarmed", "no [/dev/ttyUSB0] [red]"] in said
    assert ["device", "counted on its line since start"] in said


def test_the_table_of_maps(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    client.damage = "no [cells]"
    assert main(["map", "list"]) == 0
    head, row = [columns(line) for line in capsys.readouterr().out.splitlines()]
    assert head == ["map", "version", "made (UTC)", "cells", "stops", "digest"]
    assert row == ["lab", "3", "2023-11-14 22:13:20", "60 x 40", "7", "damaged: no [cells]"]


def test_the_tables_of_the_exact_algorithm(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.wkt").write_text("POLYGON ((3 3, 4 3, 4 4, 3 4, 3 3))")
    (tmp_path / "a.csv").write_text("bearing_deg,range_m,status\n0,1,hit\n")
    files = [str(tmp_path / "a.wkt"), str(tmp_path / "a.csv")]
    assert main(["exact", *files]) == 0
    said = [columns(line) for line in capsys.readouterr().out.splitlines()]
    names = ["rank", "heading deg", "kind", "area m2", "length m", "x m", "y m", "width m", "height m"]
    assert [len(line) for line in said if line == names] == [len(names)]
    assert main(["exact", *files, "--at", "1", "3.5"]) == 0
    said = [columns(line) for line in capsys.readouterr().out.splitlines()]
    assert ["reading", "length m", "hit", "why"] in said
