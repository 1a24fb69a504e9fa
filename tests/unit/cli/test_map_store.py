"""``map copy``, ``rename``, ``delete`` and ``compare`` on a store, without a daemon."""

import json
from pathlib import Path

import numpy as np
import pytest

from robotd.cli.main import main
from robotd.core.grid_spec import GridSpec
from robotd.grid.occupancy import OccupancyGrid
from robotd.maps.store import MapStore

SPEC = GridSpec(0.05, 0.0, 0.0, (20, 20))


@pytest.fixture
def maps(tmp_path: Path) -> Path:
    cells = np.zeros(SPEC.shape, np.uint8)
    cells[:, 5] = 255
    store = MapStore(tmp_path / "maps")
    store.save("lab", OccupancyGrid(SPEC, cells), {}, 1)
    store.save("lab", OccupancyGrid(SPEC, np.roll(cells, 2, axis=1)), {}, 2)
    return tmp_path / "maps"


def run(maps: Path, *words: object) -> int:
    return main(["map", *map(str, words), "--maps", str(maps)])


def names(maps: Path) -> list[tuple[str, int]]:
    return [(entry.name, entry.version) for entry in MapStore(maps).list()]


def test_maps_are_copied_renamed_and_deleted(maps: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(maps, "copy", "lab", "hall", "--version", 1) == 0
    assert run(maps, "rename", "lab", "kitchen") == 0
    assert names(maps) == [("hall", 1), ("kitchen", 1), ("kitchen", 2)]
    assert run(maps, "delete", "kitchen", "--version", 2, "--yes") == 0
    assert run(maps, "delete", "hall", "--yes") == 0
    assert names(maps) == [("kitchen", 1)]
    assert capsys.readouterr().out.splitlines() == [
        "copied lab: hall version 1",
        "renamed lab: kitchen version 1, 2",
        "deleted kitchen version 2",
        "deleted hall version 1",
    ]


def test_nothing_is_deleted_unasked(
    maps: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(maps, "delete", "lab") == 1  # no terminal to ask on
    assert "--yes" in capsys.readouterr().err
    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    monkeypatch.setattr("builtins.input", lambda _: "lav")
    assert run(maps, "delete", "lab") == 1
    assert len(names(maps)) == 2
    monkeypatch.setattr("builtins.input", lambda _: " lab ")
    assert run(maps, "delete", "lab") == 0
    assert names(maps) == []


def test_two_versions_are_compared(maps: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    assert run(maps, "compare", "lab@1", "lab", "--json", "--png", tmp_path / "both.png") == 0
    told = json.loads(capsys.readouterr().out)
    assert told["counts"] == [[360, 0, 20], [0, 0, 0], [20, 0, 0]]
    assert told["agreement_where_both_have_seen"] == 0.9
    assert told["nine_in_ten_walls_within_m"] == pytest.approx(0.1)
    assert (tmp_path / "both.png").read_bytes().startswith(b"\x89PNG")
    assert run(maps, "compare", "lab", "lab@2") == 0
    shown = capsys.readouterr().out
    assert "agreement where both have seen: 1.000" in shown
    assert "380" in shown


def test_words_for_what_cannot_be(maps: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(maps, "compare", "lab@x", "lab") == 78
    assert "expected NAME or NAME@VERSION" in capsys.readouterr().err
    assert run(maps, "rename", "lab", "lab") == 1
    assert "already" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words",
    ["copy lab hall", "rename lab hall", "delete lab --yes", "compare lab lab", "export lab out", "changes lab"],
)
def test_where_no_maps_are_it_is_said_where_was_looked_and_how_another_place_is_named(
    words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(tmp_path, *words.split()) == 1
    said = f"robotctl: {tmp_path}: there are no maps; say where they are, with --config FILE or --maps DIR\n"
    assert capsys.readouterr().err == said
