"""``map import`` and ``map export``: a map of another program goes in and comes out, and nothing is lost."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from robotd.cli.main import main
from robotd.grid.image import encode_pgm
from robotd.maps.store import MapStore

YAML = (
    b"image: hall.pgm\nresolution: 0.05\norigin: [-1.5, 2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
)
GREY = np.array([[0, 205, 254], [254, 254, 254]], np.uint8)


@pytest.fixture
def hall(tmp_path: Path) -> Path:
    file = tmp_path / "hall.yaml"
    file.write_bytes(YAML)
    (tmp_path / "hall.pgm").write_bytes(encode_pgm(GREY))
    return file


def run(*words: object) -> int:
    return main(["map", *map(str, words)])


def test_a_map_goes_in_and_comes_out(hall: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    maps, out = tmp_path / "maps", tmp_path / "out"
    assert run("import", hall, "--maps", maps, "--json") == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["name"], told["version"], told["rows"], told["cols"], told["notes"]) == ("hall", 1, 2, 3, [])
    stored = MapStore(maps).load("hall")
    grid, entry = stored.grid, stored.entry
    assert grid.cells.tolist() == [[255, 128, 1], [1, 1, 1]]
    assert entry.metadata["imported_from"] == "hall.yaml"
    assert run("export", "hall", out, "--maps", maps, "--mode", "scale") == 0
    assert run("import", out / "hall.yaml", "--name", "again", "--maps", maps) == 0
    assert MapStore(maps).load("again").grid.digest() == grid.digest()


def test_a_picture_alone_needs_its_resolution(hall: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture, maps = hall.with_suffix(".pgm"), tmp_path / "maps"
    assert run("import", picture, "--maps", maps) == 1
    assert "give the yaml beside it, or --resolution" in capsys.readouterr().err
    assert run("import", picture, "--maps", maps, "--resolution", "0.05", "--origin", "-1.5", "2") == 0
    assert MapStore(maps).load("hall").grid.spec.origin_x_m == -1.5


@pytest.mark.parametrize(
    ("spoil", "complaint"),
    [
        (lambda hall: hall.with_suffix(".pgm").unlink(), "hall.pgm cannot be read: No such file or directory"),
        (lambda hall: hall.with_suffix(".pgm").write_bytes(b"P5 3 2 255\n\0"), "the picture is damaged"),
        (lambda hall: hall.write_bytes(YAML.replace(b"negate: 0\n", b"")), "negate is missing; expected 0 or 1"),
        (lambda hall: hall.unlink(), "hall.yaml: No such file or directory"),
        (lambda hall: (hall.unlink(), hall.mkdir()), "hall.yaml: it is no file"),
    ],
)
def test_what_is_wrong_is_said_with_the_file(
    hall: Path, tmp_path: Path, spoil: object, complaint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert callable(spoil)
    spoil(hall)
    assert run("import", hall, "--maps", tmp_path / "maps") == 1
    said = capsys.readouterr().err
    assert str(hall) in said
    assert complaint in said
    assert not (tmp_path / "maps").exists()


def test_a_file_that_is_no_name_wants_one(hall: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    odd = hall.rename(tmp_path / "my hall.yaml")
    assert run("import", odd, "--maps", tmp_path / "maps") == 1
    assert "choose a name with --name" in capsys.readouterr().err


def test_what_should_be_known_is_said(hall: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    hall.write_bytes(YAML.replace(b"0.196", b"0.25"))
    assert run("import", hall, "--maps", tmp_path / "maps") == 0
    assert "17% of its pixels are 205" in capsys.readouterr().err


def test_an_export_writes_over_nothing_else(hall: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    maps, out = tmp_path / "maps", tmp_path / "out"
    assert run("import", hall, "--maps", maps) == 0
    out.mkdir()
    (out / "hall.yaml").write_text("groceries: milk\n")
    assert run("export", "hall", out, "--maps", maps) == 1
    assert "is not the yaml of a map; it is left as it is" in capsys.readouterr().err
    assert [file.name for file in out.iterdir()] == ["hall.yaml"]


def test_the_configuration_says_where_maps_are(hall: Path, tmp_path: Path) -> None:
    file = tmp_path / "robotd.toml"
    file.write_text('[maps]\ndir = "mine"\n')
    assert run("import", hall, "--config", file) == 0
    assert MapStore(tmp_path / "mine").load("hall").entry.version == 1


def test_without_the_extra_it_is_said_how_to_get_it(
    hall: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in [name for name in sys.modules if name.startswith("robotd.interop")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "PIL", None)
    assert run("import", hall) == 1
    assert "install the extra interop" in capsys.readouterr().err
