"""Whatever else lies in a directory of maps: the rest is listed, and what is saved next is found."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robotd.core.errors import MapError
from robotd.core.grid_spec import MAX_SIDE_CELLS, GridSpec
from robotd.grid.occupancy import OccupancyGrid
from robotd.maps.atomic import Blocks, publish_directory
from robotd.maps.store import MapStore

SPEC = GridSpec(0.05, 0.0, 0.0, (6, 8))


def grid_of(seed: int) -> OccupancyGrid:
    return OccupancyGrid(SPEC, np.random.default_rng(seed).integers(0, 256, SPEC.shape, np.uint8))


@pytest.fixture(name="root")
def _root(tmp_path: Path) -> Path:
    for seed in (1, 2):
        MapStore(tmp_path).save("lab", grid_of(seed), {"seed": seed}, seed)
    return tmp_path


def save_and_find(root: Path, name: str = "lab") -> int:
    """Save a map, find it as the newest and by its number, and return that."""
    saved = MapStore(root).save(name, grid_of(7), {"seed": 7}, 7)
    for version in (None, saved.version):
        stored = MapStore(root).load(name, version)
        grid, found = stored.grid, stored.entry
        assert found == saved
        np.testing.assert_array_equal(grid.cells, grid_of(7).cells)
    assert saved in MapStore(root).list()
    return saved.version


STRAY = [
    "lab/3",
    "lab/9",
    "lab/999999999",
    "lab/1000000000",
    "lab/0",
    "lab/007",
    "lab/-4",
    "lab/٣",
    "lab/9.mcap",
    "lab/³",
]


@pytest.mark.parametrize("kind", ["file", "broken link"])
@pytest.mark.parametrize(
    "path", [*STRAY, ".tmp-lab-3", ".tmp-lab-11", ".tmp-", "7", "lab.pgm", "lost+found", ".hidden"]
)
def test_a_stray_file_hides_nothing_and_blocks_nothing(root: Path, path: str, kind: str) -> None:
    stray = root / path
    if kind == "file":
        stray.write_text("not ours")
    else:
        stray.symlink_to("nowhere")
    assert [(entry.name, entry.version) for entry in MapStore(root).list()] == [("lab", 1), ("lab", 2)]
    assert MapStore(root).load("lab").entry.version == 2
    assert save_and_find(root) == (4 if path == "lab/3" else 3)
    assert os.path.lexists(stray), "it is somebody else's, and stays"


@pytest.mark.parametrize(
    "path", ["lab/0", "lab/007", "lab/1000000000", "lab/x", "lost+found", ".tmp-lab-3", ".x", "ä", "empty"]
)
def test_a_stray_directory_hides_nothing_and_blocks_nothing(root: Path, path: str) -> None:
    (root / path / "inner").mkdir(parents=True)
    assert [(entry.name, entry.version) for entry in MapStore(root).list()] == [("lab", 1), ("lab", 2)]
    assert save_and_find(root) == 3


@pytest.mark.parametrize("version", [3, 9, 999_999_998])
def test_a_version_without_content_is_named_as_damaged_and_the_next_is_found(root: Path, version: int) -> None:
    (root / "lab" / str(version)).mkdir()
    listed = MapStore(root).list()
    assert [entry.version for entry in listed] == [1, 2, version]
    assert listed[-1].damage == "manifest.json is missing"
    with pytest.raises(MapError, match=f"version {version} is damaged: .* version 2 is intact"):
        MapStore(root).load("lab")
    assert save_and_find(root) == version + 1


def test_when_the_numbers_have_run_out_a_save_is_refused_and_says_why(root: Path) -> None:
    (root / "lab" / "999999999").mkdir()
    with pytest.raises(MapError, match=r"no version comes after .*/lab/999999999: move that away"):
        MapStore(root).save("lab", grid_of(3), {}, 3)
    assert not list(root.glob(".tmp-*"))
    assert save_and_find(root, "another") == 1
    (root / "lab" / "999999999").rmdir()
    assert save_and_find(root) == 3


@pytest.mark.parametrize("unreadable", ["root/lob", "root/lob/1"])
def test_what_cannot_be_read_is_named_and_the_rest_listed(
    root: Path, monkeypatch: pytest.MonkeyPatch, unreadable: str
) -> None:
    MapStore(root).save("lob", grid_of(3), {}, 3)
    refused = root / unreadable.removeprefix("root/")
    monkeypatch.setattr(os, "scandir", refusing(os.scandir, refused))
    monkeypatch.setattr(Path, "open", refusing(Path.open, refused))
    *rest, bad = MapStore(root).list()
    assert [(entry.name, entry.version, entry.damage) for entry in rest] == [("lab", 1, None), ("lab", 2, None)]
    assert (bad.name, bad.version) == ("lob", 0 if unreadable == "root/lob" else 1)
    assert bad.damage is not None
    assert "cannot be read: Permission denied" in bad.damage
    with pytest.raises(MapError, match=r"lob.*Permission denied"):
        MapStore(root).load("lob")
    assert save_and_find(root) == 3


def refusing(real: Callable[..., Any], refused: Path) -> Callable[..., Any]:
    def call(path: Any, *arguments: Any, **options: Any) -> Any:
        if Path(path) == refused or Path(path).parent == refused:
            raise PermissionError(13, "Permission denied")
        return real(path, *arguments, **options)

    return call


def test_a_pipe_in_a_manifests_place_keeps_nobody_waiting(root: Path) -> None:
    (root / "lab" / "2" / "manifest.json").unlink()
    os.mkfifo(root / "lab" / "2" / "manifest.json")
    assert MapStore(root).list()[-1].damage == "manifest.json is no file"
    with pytest.raises(MapError, match=r"manifest\.json is no file; version 1 is intact"):
        MapStore(root).load("lab")


def test_a_copied_version_is_not_taken_for_what_it_was_copied_from(root: Path) -> None:
    (root / "lab" / "2").rename(root / "lab" / "8")
    listed = MapStore(root).list()
    assert [entry.version for entry in listed] == [1, 8]
    assert listed[-1].damage == "manifest.json belongs to map lab version 2"


@pytest.mark.parametrize("name", ["Lab", "LAB", "lAb"])
def test_names_that_differ_in_capitals_alone_are_refused(root: Path, name: str) -> None:
    with pytest.raises(MapError, match=f"map {name} would differ from map lab in capitals alone"):
        MapStore(root).save(name, grid_of(3), {}, 3)
    assert not (root / name).exists()


def test_a_twin_that_is_there_already_goes_on(root: Path) -> None:
    (root / "lab").rename(root / "elsewhere")
    MapStore(root).save("Lab", grid_of(3), {}, 3)
    (root / "elsewhere").rename(root / "lab")
    assert save_and_find(root, "Lab") == 2
    assert save_and_find(root, "lab") == 3


@pytest.mark.parametrize(
    "name", ["lab.", "lost+found", "labe\u0301", "lab\u00e9", "\uff4cab", ".tmp-lab-1", "a" * 65, "con/1"]
)
def test_names_that_a_file_system_may_change_are_refused(root: Path, name: str) -> None:
    with pytest.raises(MapError, match="cannot name a"):
        MapStore(root).save(name, grid_of(3), {}, 3)


@pytest.mark.slow
def test_the_largest_map_is_found_again(root: Path) -> None:
    spec = GridSpec(0.05, 0.0, 0.0, (MAX_SIDE_CELLS, MAX_SIDE_CELLS))
    saved = MapStore(root).save("hall", OccupancyGrid(spec, np.full(spec.shape, 128, np.uint8)), {}, 1)
    assert MapStore(root).load("hall").entry == saved


def test_the_longest_name_fits(root: Path) -> None:
    assert save_and_find(root, "a" * 64) == 1


@pytest.mark.parametrize(
    "metadata", [{"note": "x" * (1 << 20)}, {"counts": {2: "a", 10: "b"}}], ids=["too long", "keys that JSON reorders"]
)
def test_what_could_not_be_loaded_again_is_not_reported_saved(root: Path, metadata: dict[str, Any]) -> None:
    with pytest.raises(MapError, match="cannot save map lab"):
        MapStore(root).save("lab", grid_of(3), metadata, 3)
    assert save_and_find(root) == 3


def test_a_file_system_that_keeps_another_name_is_found_out(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def publish_under_another_name(temporary: Path, final: Path, files: dict[str, Blocks]) -> None:
        publish_directory(temporary, final.with_name(f"{final.name}~"), files)

    monkeypatch.setattr("robotd.maps.archive.publish_directory", publish_under_another_name)
    with pytest.raises(MapError, match="keeps other names"):
        MapStore(root).save("lab", grid_of(3), {}, 3)
