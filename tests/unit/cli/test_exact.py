"""``robotctl exact`` answers without a daemon, in text, in JSON and in a picture."""

import json
import re
from pathlib import Path

import pytest
from matplotlib.image import imread

from robotd.cli.exact_inputs import read_map
from robotd.cli.main import main
from robotd.core.errors import MapError
from robotd.core.grid_spec import GridSpec
from robotd.exact.locate import contains
from robotd.exact.points import Point
from robotd.exact.rationals import ARITHMETICS, rational
from robotd.grid.occupancy import OccupancyGrid
from robotd.maps.store import MapStore

MAP = """outline_m = [[0, 0], [8, 0], [8, 6], [0, 6]]
[[obstacle]]
points_m = [[3, 3], [4, 3], [4, 4], [3, 4]]
"""
READINGS = """bearing_deg,range_m,status
0,7,hit
90,4,hit
180,1,hit
270,2,hit
45,1.5,miss
"""


@pytest.fixture
def files(tmp_path: Path) -> list[str]:
    (tmp_path / "room.toml").write_text(MAP, encoding="utf-8")
    (tmp_path / "readings.csv").write_text(READINGS, encoding="utf-8")
    return [str(tmp_path / "room.toml"), str(tmp_path / "readings.csv")]


def test_exact_readings_leave_one_point(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["exact", *files, "--eps-m", "0", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["best_rank"] == 5
    (region,) = answer["regions"]
    assert region["kind"] == "point"
    assert region["box_m"] == [1.0, 2.0, 1.0, 2.0]
    assert region["readings"] == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("eps", ["0.1", "0.0001"])
def test_with_an_error_radius_it_is_an_area_which_is_drawn(
    eps: str, files: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = tmp_path / "where.png"
    assert main(["exact", *files, "--eps-m", eps, "--out", str(picture)]) == 0
    assert "area" in capsys.readouterr().out
    pixels = imread(picture)
    blue = (pixels[..., 2] > 0.6) & (pixels[..., 0] < 0.2)
    assert 10 < blue.sum() < 3000  # 0.2 m by 0.2 m of 8 m by 6 m, or a dot


def test_the_example_of_the_quick_start_is_answered_as_it_says(
    files: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    page = (Path(__file__).parents[3] / "docs" / "quickstart.md").read_text(encoding="utf-8")
    for file, language in zip(files, ("toml", "text"), strict=True):
        (example,) = re.findall(rf"```{language}\n(outline_m.*?|bearing_deg.*?)```", page, re.DOTALL)
        Path(file).write_text(example, encoding="utf-8")
    regions = []
    for arguments in (["--eps-m", "0"], []):
        assert main(["exact", *files, *arguments, "--json"]) == 0
        (region,) = json.loads(capsys.readouterr().out)["regions"]
        regions.append((region["rank"], region["kind"], region["box_m"]))
    assert regions[0] == (4, "point", [1.0, 2.0, 1.0, 2.0])
    assert regions[1] == (4, "area", pytest.approx([0.95, 1.95, 1.05, 2.05]))


def test_an_unknown_heading_is_found(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    turned = "bearing_deg,range_m\n-90,7\n0,4\n90,1\n180,2\n"
    Path(files[1]).write_text(turned, encoding="utf-8")
    assert main(["exact", *files, "--eps-m", "0", "--headings", "4", "--json"]) == 0
    headings = {region["heading_deg"] for region in json.loads(capsys.readouterr().out)["regions"]}
    assert headings == {90.0, 270.0}  # the room is the same from the other side, but for the obstacle


def test_it_says_why_a_reading_does_not_hold(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["exact", *files, "--at", "1", "3.5"]) == 0
    said = capsys.readouterr().out
    assert "blocked after 2.0000 m" in said
    assert "ends in the open, 1.0000 m from the next obstacle" in said
    assert main(["exact", *files, "--at", "1", "3.5", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["headings"][0]["rank"] == 2


def test_it_finds_the_smallest_error(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    Path(files[1]).write_text("bearing_deg,range_m\n0,7.1\n180,1.1\n", encoding="utf-8")
    assert main(["exact", *files, "--smallest-error", "1", "--json"]) == 0
    bracket = json.loads(capsys.readouterr().out)
    assert bracket["above_m"] < 0.1 <= bracket["at_most_m"] < bracket["above_m"] + 0.0011


def test_headings_near_the_prior_share_the_questions(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    near = ["--heading-deg", "90", "--within-deg", "30", "--headings", "3", "--json"]
    Path(files[1]).write_text("bearing_deg,range_m\n-90,7.1\n90,1.1\n0,4\n", encoding="utf-8")
    assert main(["exact", *files, "--at", "1", "2", "--eps-m", "0.1", *near]) == 0
    headings = json.loads(capsys.readouterr().out)["headings"]
    assert (headings[0]["heading_deg"], headings[0]["rank"]) == (90.0, 3)
    assert sorted(one["heading_deg"] for one in headings) == [60.0, 90.0, 120.0]
    assert max(one["rank"] for one in headings[1:]) < 3
    assert main(["exact", *files, "--smallest-error", "1", *near]) == 0
    bracket = json.loads(capsys.readouterr().out)
    assert bracket["headings_deg"] == [90.0]
    assert bracket["above_m"] < 0.1 <= bracket["at_most_m"]
    assert bracket["needed"] == 3


def test_a_share_of_the_readings_is_rounded_up(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    Path(files[1]).write_text("bearing_deg,range_m\n0,7.1\n180,1.1\n90,4\n", encoding="utf-8")
    assert main(["exact", *files, "--smallest-error", "0.5"]) == 0
    said = capsys.readouterr().out
    assert "2 of 3" in said
    assert "nothing is" in said
    assert main(["exact", *files, "--smallest-error", "0.7"]) == 0
    said = capsys.readouterr().out
    assert "3 of 3" in said
    assert "0.0996093750 m, proved" in said
    assert "0.1005859375 m, proved" in said


def test_a_rank_that_nothing_reaches_is_reached_nowhere(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["exact", *files, "--least-rank", "6", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert (answer["best_rank"], answer["regions"]) == (5, [])


def test_what_is_not_bounded_is_said_to_be_infinite(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    Path(files[0]).write_text("[[obstacle]]\npoints_m = [[3, 3], [4, 3], [4, 4]]", encoding="utf-8")
    Path(files[1]).write_text("bearing_deg,range_m,status\n45,1.5,miss\n", encoding="utf-8")
    assert main(["exact", *files, "--json"]) == 0
    (region,) = json.loads(capsys.readouterr().out)["regions"]
    assert (region["kind"], region["area_m2"], region["box_m"]) == ("area", None, [None] * 4)
    assert main(["exact", *files]) == 0
    assert capsys.readouterr().out.splitlines()[-1].split() == ["1", "0.000", "area", "inf", "0.0000", *"----"]


def test_files_may_begin_with_a_mark_of_their_encoding(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    for file in files:
        Path(file).write_text(Path(file).read_text(encoding="utf-8"), encoding="utf-8-sig")
    assert main(["exact", *files, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["best_rank"] == 5


@pytest.mark.parametrize("answer", [["--at", "1", "2"], ["--smallest-error", "1"]])
def test_only_regions_are_drawn(answer: list[str], files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["exact", *files, *answer, "--out", "where.png"]) == 1
    assert "--out" in capsys.readouterr().err


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_every_arithmetic_gives_the_same_answer(
    arithmetic: str, files: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    answers = []
    for name in ("fractions", arithmetic):
        assert main(["exact", *files, "--eps-m", "0.1", "--arithmetic", name, "--json"]) == 0
        answer = json.loads(capsys.readouterr().out)
        assert answer.pop("arithmetic") == name
        answers.append(answer)
    assert answers[0] == answers[1]


def test_a_saved_map_of_cells_is_a_map_of_polygons(tmp_path: Path) -> None:
    grid = OccupancyGrid(GridSpec(0.5, -1.0, 0.0, (4, 6)))
    grid.cells[:] = 0
    grid.cells[1, 2] = 255
    MapStore(tmp_path).save("cells", grid, {}, 0)
    walls = read_map(tmp_path / "cells")
    assert contains(walls, Point(rational("0.25"), rational("0.75")))
    assert not contains(walls, Point(rational("0.75"), rational("0.75")))
    assert contains(walls, Point(rational(100), rational(100)))


def test_a_version_of_a_saved_map_is_a_map_and_other_directories_say_what_they_hold(tmp_path: Path) -> None:
    for value in (0, 255):
        grid = OccupancyGrid(GridSpec(0.5, -1.0, 0.0, (4, 6)))
        grid.cells[:] = value
        MapStore(tmp_path).save("cells", grid, {}, 0)
    inside = Point(rational("0.25"), rational("0.75"))
    assert not contains(read_map(tmp_path / "cells" / "1"), inside)
    assert contains(read_map(tmp_path / "cells" / "2"), inside)
    assert contains(read_map(tmp_path / "cells"), inside)
    with pytest.raises(MapError, match=r"no saved map.*; it holds cells: name one of them"):
        read_map(tmp_path)
    (tmp_path / "empty").mkdir()
    with pytest.raises(MapError, match=r"no saved map: neither its directory nor that of one of its versions$"):
        read_map(tmp_path / "empty")
    (tmp_path / "cells" / "1" / "cells.bin").write_bytes(b"x")
    with pytest.raises(MapError, match="map cells version 1 is damaged"):
        read_map(tmp_path / "cells" / "1")


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("map.txt", MAP, "the ending must be"),
        ("map.toml", "", "no polygons"),
        ("map.toml", "x = 1", "unknown key x"),
        ("map.toml", "obstacle = 3", "not built as such a file is"),
        ("map.toml", "[[obstacle]]", "no points_m"),
        ("map.json", "[1, 2]", "not built as such a file is"),
        ("map.json", "{", "Expecting"),
        ("map.wkt", "\xff\xfe", "can't decode"),
    ],
)
def test_what_is_no_map_is_refused(tmp_path: Path, name: str, text: str, message: str) -> None:
    (tmp_path / name).write_text(text, encoding="latin-1")
    with pytest.raises(MapError, match=message):
        read_map(tmp_path / name)
