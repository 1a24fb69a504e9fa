"""Verbs that only look: pose, watch, maps, recordings."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robotd.cli.live import _obeyed
from robotd.cli.main import main
from robotd.cli.show.dashboard import Dashboard
from robotd.cli.show.half_blocks import Ink, draw, shrink
from robotd.cli.show.wording import in_words
from robotd.client.feed import Gap
from robotd.contract.estimate import PoseState
from robotd.contract.events import SweepBegun, SweepDone
from robotd.contract.sweep_columns import in_columns
from robotd.contract.topics import LogEntry, from_wire
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from tests.unit.cli.conftest import ESTIMATE
from tests.unit.contract.messages import message, names


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


@pytest.mark.parametrize("name", names("events"))
def test_every_event_has_its_words(name: str) -> None:
    event = from_wire(message(f"events/{name}"))
    assert event is not None
    assert len(in_words(event).splitlines()) == 1


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
    assert capsys.readouterr().out.splitlines() == DRAWN
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


DRAWN = ["    0.40|█▀▀█", "        |█▄▄█", "        |0.10 m", "made of 7 stops"]
SPEC = GridSpec(0.1, -1.0, 2.0, (31, 40))
PLAIN, ASCII = Ink(colour=False, blocks=True), Ink(colour=False, blocks=False)


@pytest.mark.parametrize("columns", [1, 3, 10, 40])
def test_a_map_shrinks_to_the_width_and_keeps_its_walls(columns: int) -> None:
    rng = np.random.default_rng(columns)
    cells = np.full((31, 40), 128, np.uint8)
    cells[3:29, 2:37] = 10
    for row, col in rng.integers((3, 2), (29, 37), (5, 2)):
        cells[row, col] = 250
    small = shrink(SPEC, cells, columns)
    assert small.cells.shape[1] <= max(1, columns - 9)
    assert small.cells.shape[0] % 2 == 0
    for row, col in np.argwhere(cells == 250):
        x_m, y_m = SPEC.centre_of(float(row), float(col))
        line, column = small.place(x_m, y_m)
        assert 250 in small.cells[2 * line : 2 * line + 2, column]


def test_free_unknown_and_wall_differ_without_colour_and_the_robot_is_there() -> None:
    cells = np.full((31, 40), 128, np.uint8)
    cells[3:29, 2:37] = 10
    cells[3:5] = 250
    x_m, y_m = SPEC.centre_of(15.0, 20.0)
    cells[10:20, 2:6] = 128
    for ink, inks in ((PLAIN, " ░█↑"), (ASCII, " :#^")):
        drawn = draw(shrink(SPEC, cells, 60), ink, robot=Pose2(x_m, y_m, 1.57)).plain
        assert all(letter in drawn for letter in inks)
    coloured = draw(shrink(SPEC, cells, 60), Ink(colour=True, blocks=True), places_m=[(x_m, y_m)])
    assert "o" in coloured.plain
    assert len({span.style for span in coloured.spans}) >= 3


def test_axes_tell_where_a_cell_is() -> None:
    cells = np.full((31, 40), 128, np.uint8)
    cells[0:30, 0:40] = 10
    shrunk = shrink(SPEC, cells, 80)
    lines = draw(shrunk, PLAIN).plain.splitlines()
    assert float(lines[0].partition("|")[0]) == pytest.approx(2.0 + 3.0 - 0.1)
    assert lines[-1].split("|")[1].strip() == "-1.00"
    assert float(lines[-1].split("|")[2]) == pytest.approx(-1.0 + 12 * 0.1)


def test_a_map_of_nothing_is_drawn_as_unknown() -> None:
    assert "░" in draw(shrink(SPEC, np.full((31, 40), 128, np.uint8), 20), PLAIN).plain


def test_what_is_shown_live_is_all_that_was_heard(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    client.published = [
        client.map_show(None, None),
        *client.mission_events,
        client.status(),
        LogEntry(1, "INFO", "robotd", "a line\nand another"),
    ]
    assert main(["map", "show", "--live"]) == 0
    shown = capsys.readouterr().out
    for words in (
        "keys: space or s stops",
        "idle: armed by request",
        "drive ready armed",
        "localized: x 1.000",
        "info a line",
    ):
        assert words in shown
    assert "0.40|" in shown
    assert main(["top"]) == 0
    assert "idle: armed by request" in capsys.readouterr().out


def test_a_map_that_changes_is_drawn_as_it_is_then(client: Any) -> None:
    board = Dashboard()
    whole = client.map_show(None, None)
    board.hear(whole)
    board.hear(replace(whole, whole=False, cells=np.array([7]), values=np.array([3], np.uint8)))
    assert board.values is not None
    assert board.values.reshape(-1)[7] == 3
    assert whole.values.reshape(-1)[7] == 255


def test_a_sweep_is_drawn_as_it_comes_where_it_is_taken(client: Any) -> None:
    board = Dashboard()
    board.hear(client.map_show(None, None))
    ahead = RangeReading(5, 0.0, ReadingStatus.OK, 0.25)
    left, missed = replace(ahead, bearing_rad=math.pi / 2), RangeReading(5, 1.0, ReadingStatus.MISS, 6.0)
    told = in_columns(3, 0, [ahead, missed, left])
    board.hear(SweepBegun(4, 3, 300, IDENTITY, None))
    board.hear(told)
    assert board._hits_m() == []  # nothing ties odometry to the map yet
    board.hear(SweepBegun(4, 4, 300, IDENTITY, Pose2(1.0, 2.0, 0.0)))
    board.hear(told)
    assert np.allclose(board._hits_m(), [(1.25, 2.0), (1.0, 2.25)], atol=1e-6)
    board.hear(SweepDone(6, Sweep(4, IDENTITY, (ahead,)), Pose2(1.0, 2.0, math.pi / 2)))
    assert np.allclose(board._hits_m(), [(1.0, 2.25)])
    board.hear(replace(ESTIMATE, bearings_rad=(0.0,), best=Pose2(0.5, 0.5, 0.0)))
    assert np.allclose(board._hits_m(), [(0.75, 0.5)])  # what it localizes at says better where it was taken
    board.hear(client.map_show(None, None))
    assert board._hits_m() == []


@pytest.mark.parametrize(
    ("key", "asked"),
    [(" ", ("stop", "stopped at the command line")), ("s", ("stop", "stopped at the command line")), ("a", "arm")],
)
def test_keys_stop_and_arm(client: Any, key: str, asked: object) -> None:
    assert _obeyed(client, key)
    assert client.asked[-1] == asked


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


def test_recordings_are_listed_and_deleted(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["record", "list"]) == 0
    printed = capsys.readouterr().out
    assert re.search(r"monday\.mcap\s+2\.5 MB\s+2023-11-14 22:13:20 UTC\s+under way", printed)
    assert "and 2 older ones" in printed
    assert main(["record", "list", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["recordings"][0]["size_bytes"] == 2_500_000
    assert main(["record", "delete", "monday.mcap"]) == 0
    assert ("record_delete", "monday.mcap") in client.asked
    assert capsys.readouterr().out == "deleted monday.mcap\n"


def test_a_way_is_told_before_anybody_drives_it(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plan", "2.5", "0.75"]) == 0
    assert capsys.readouterr().out == "3.25 m, by (1.00, 0.00), (2.50, 0.75) m\n"
    assert main(["plan", "-9", "0"]) == 1
    assert capsys.readouterr().out == "no way: the goal lies outside the map\n"
    assert main(["plan", "--json", "-9", "0"]) == 1
    assert json.loads(capsys.readouterr().out)["nearest_m"] == [0.5, 1.0]


def test_a_file_that_cannot_be_written_is_one_line(
    client: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["map", "show", "--png", str(tmp_path)]) == 1
    assert capsys.readouterr().err == f"robotctl: {tmp_path}: is a directory; a PNG picture was to be written there\n"
