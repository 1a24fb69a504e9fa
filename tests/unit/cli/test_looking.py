"""Verbs that only look: pose, watch, maps, recordings."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robotd.cli.main import main
from robotd.cli.show.half_blocks import coloured, plain, shrink
from robotd.client.feed import Gap
from robotd.contract.estimate import PoseState
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry, Pose2
from tests.unit.cli.conftest import ESTIMATE


def test_a_pose_is_its_state_and_all_its_regions(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["pose"]) == 0
    assert client.asked[0] == ("subscribe", "pose")
    first, second = capsys.readouterr().out.splitlines()
    assert first.startswith("localized: x 1.000 m, y 2.000 m")
    assert second.startswith("  x 1.000 m, y 2.000 m, heading 0.0 deg; 0.20 x 0.20 m x 11.5 deg, 280 readings")


def test_no_pose_in_time_is_a_failure(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    client.published = []
    assert main(["pose"]) == 1
    assert capsys.readouterr().err == "robotctl: no pose: the daemon is silent\n"


def test_what_is_watched_is_printed_as_it_comes(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    client.published = [*client.mission_events, client.status(), client.map_show(None, None), Gap("pose", 3)]
    assert main(["watch", "pose", "mission"]) == 0
    assert ("subscribe", "pose", "mission") in client.asked
    assert [line[13:] for line in capsys.readouterr().out.splitlines()] == [
        "localize: started",
        "150 of 300 readings: 120 hits, 20 misses, 10 rejected",
        "ambiguous: 2 regions (140 of 150 readings explained, so far)",
        "300 of 300 readings: 240 hits, 40 misses, 20 rejected",
        "localized: x 1.000 m, y 2.000 m, heading 0.0 deg (280 of 300 readings explained)",
        "localize: done, localized",
        "idle: armed by request",
        "map abc generation 2: 36 cells",
        "pose: 3 messages missed",
    ]
    client.published = [client.map_show(None, None), Gap("pose", None)]
    assert main(["watch", "map", "pose", "--json"]) == 0
    changed, gap = map(json.loads, capsys.readouterr().out.splitlines())
    assert (changed["event"], changed["cells"], changed["spec"]["shape"]) == ("map_changed", 36, [6, 6])
    assert gap == {"event": "gap", "topic": "pose", "missed": None}


def test_counts_are_shown_raw(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    client.published = [Odometry(1, IDENTITY, STANDSTILL, (27300, -5)), Odometry(1, IDENTITY, STANDSTILL)]
    assert main(["watch", "odometry", "--raw"]) == 0
    first, second = capsys.readouterr().out.splitlines()
    assert first.endswith("0.00 m/s; counted 27300 of translation, -5 of rotation")
    assert second.endswith("counted nothing that it tells")
    assert main(["watch", "odometry"]) == 0


def test_who_watches_hears_what_is_news_and_when(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    moved = replace(ESTIMATE, state=PoseState.PREDICTED)
    status = client.status()
    client.published = [
        *client.mission_events,
        moved,
        status,
        replace(status, time_ns=9),
        Odometry(1, IDENTITY, STANDSTILL),
    ]
    assert main(["watch"]) == 0
    assert ("subscribe", "odometry") not in client.asked
    lines = capsys.readouterr().out.splitlines()
    assert [line[13:] for line in lines] == [
        "localize: started",
        "localized: x 1.000 m, y 2.000 m, heading 0.0 deg (280 of 300 readings explained)",
        "localize: done, localized",
        "idle: armed by request",
    ]
    assert all(re.match(r"\d\d:\d\d:\d\d\.\d\d\d ", line) for line in lines)


def test_maps_are_saved_loaded_and_listed(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["map", "save", "lab"]) == 0
    assert main(["map", "load", "lab", "--version", "2", "--robot", "1", "2", "0"]) == 0
    assert main(["map", "list"]) == 0
    assert ("map_save", "lab") in client.asked
    assert ("map_load", "lab", 2, Pose2(1.0, 2.0, 0.0)) in client.asked
    saved, loaded, header, row = capsys.readouterr().out.splitlines()
    assert saved == "saved lab version 3: 60 x 40 cells of 50 mm, made of 7 stops, digest abcdef0123456789"
    assert loaded.startswith("loaded lab version 3")
    assert header.split() == ["map", "version", "made", "(UTC)", "cells", "stops", "digest"]
    assert row.split() == ["lab", "3", "2023-11-14", "22:13:20", "60", "x", "40", "7", "abcdef012345"]
    client.damage = "cells.npy: checksum does not match"
    assert main(["map", "list"]) == 0
    assert "damaged: cells.npy: checksum does not match" in capsys.readouterr().out
    for words in (["save"], ["load", "lab"]):
        assert main(["map", *words, "--json"]) == 0
        assert json.loads(capsys.readouterr().out)["digest"] == "abcdef0123456789"
    assert main(["map", "list", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)[0]["version"] == 3


def test_a_map_is_drawn_on_the_terminal_and_into_a_file(
    client: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    png = tmp_path / "m.png"
    assert main(["map", "show", "lab", "--png", str(png)]) == 0
    assert client.asked[0] == ("map_show", "lab", None)
    assert capsys.readouterr().out == "█▀▀█\n█▄▄█\nmade of 7 stops\n"
    assert png.read_bytes().startswith(b"\x89PNG")
    assert main(["map", "show", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert len(facts["digest"]) == 64
    assert (facts["free_cells"], facts["unknown_cells"], facts["occupied_cells"]) == (4, 20, 12)


def test_without_matplotlib_a_png_is_refused_with_what_to_install(
    client: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "robotd.cli.pictures.sheet", None)
    assert main(["map", "show", "--png", "m.png"]) == 1
    assert client.asked == []
    said = capsys.readouterr().err
    assert said.startswith("robotctl: --png needs matplotlib")
    assert "pip install 'robotd[plots]'" in said


@pytest.mark.parametrize("columns", [1, 3, 10, 40])
def test_a_map_shrinks_to_the_width_and_keeps_its_walls(columns: int) -> None:
    rng = np.random.default_rng(columns)
    cells = np.full((31, 40), 128, np.uint8)
    cells[3:29, 2:37] = 10
    for row, col in rng.integers((3, 2), (29, 37), (5, 2)):
        cells[row, col] = 250
    small = shrink(cells, columns)
    assert small.shape[1] <= columns
    assert small.shape[0] % 2 == 0
    step = -(-35 // columns)
    for row, col in np.argwhere(cells == 250):
        assert small[::-1][(row - 3) // step, (col - 2) // step] == 250


def test_a_map_of_nothing_is_drawn_as_nothing() -> None:
    nothing = shrink(np.full((10, 10), 128, np.uint8), 20)
    assert plain(nothing).strip() == ""
    assert coloured(nothing).plain == "▀▀\n"


def test_recording_is_started_and_stopped(client: Any, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "a.mcap"
    assert main(["record", "start", str(file)]) == 0
    assert main(["record", "start", "day/b.mcap"]) == 0
    assert main(["record", "start", "--json"]) == 0
    assert main(["record", "stop"]) == 0
    assert [asked for asked in client.asked if asked != "close"] == [
        ("record_start", str(file)),
        ("record_start", "day/b.mcap"),
        ("record_start", None),
    ]
    named, _, unnamed, stopped = capsys.readouterr().out.splitlines()
    assert named == f"recording to {file}"
    assert json.loads(unnamed) == {"path": "recordings/new.mcap"}
    assert stopped == "recorded recordings/new.mcap"


def test_a_file_that_cannot_be_written_is_one_line(
    client: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["map", "show", "--png", str(tmp_path)]) == 1
    assert capsys.readouterr().err == f"robotctl: {tmp_path}: is a directory; a PNG picture was to be written there\n"
