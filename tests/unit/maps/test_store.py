"""A stored map comes back exactly, or not at all and saying why."""

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from robotd.core.errors import MapError
from robotd.core.grid_spec import GridSpec
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.maps.entry import MapEntry
from robotd.maps.store import MapStore

SPEC = GridSpec(0.05, -1.0 / 3.0, 2.5, (6, 8))


def grid_of(seed: int, spec: GridSpec = SPEC) -> OccupancyGrid:
    return OccupancyGrid(spec, np.random.default_rng(seed).integers(0, 256, spec.shape, np.uint8))


def store_with(root: Path, versions: int, keep: int = 10) -> MapStore:
    store = MapStore(root, keep=keep)
    for number in range(1, versions + 1):
        store.save("lab", grid_of(number), {"stops": number}, 1000 + number)
    return store


specs = st.builds(
    GridSpec,
    st.floats(1e-3, 10.0),
    st.floats(-1e6, 1e6),
    st.floats(-1e6, 1e6),
    st.tuples(st.integers(1, 9), st.integers(1, 9)),
)


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data(), spec=specs)
def test_a_map_comes_back_bit_for_bit(tmp_path: Path, data: st.DataObject, spec: GridSpec) -> None:
    cells = data.draw(arrays(np.uint8, spec.shape))
    saved = MapStore(tmp_path).save("any", OccupancyGrid(spec, cells), {"note": "ä", "depth": [1, None]}, 17)
    stored = MapStore(tmp_path).load("any")
    grid, loaded = stored.grid, stored.entry
    assert grid.spec == spec
    np.testing.assert_array_equal(grid.cells, cells)
    assert loaded == saved
    assert loaded.digest == grid.digest()
    assert (loaded.created_unix_ns, loaded.metadata) == (17, {"note": "ä", "depth": [1, None]})


def test_a_loaded_map_goes_on_with_the_given_settings(tmp_path: Path) -> None:
    chosen = GridSettings(raise_alpha=0.7)
    MapStore(tmp_path).save("lab", grid_of(1), {}, 0)
    assert MapStore(tmp_path, chosen).load("lab").grid.settings == chosen


def test_versions_count_up_and_old_ones_go(tmp_path: Path) -> None:
    store = store_with(tmp_path, 5, keep=3)
    assert [entry.version for entry in store.list()] == [3, 4, 5]
    assert store.load("lab").entry.version == 5
    assert store.load("lab", 3).entry.metadata == {"stops": 3}
    assert sorted(path.name for path in tmp_path.iterdir()) == [".lock", "lab"]


def test_the_version_in_use_is_kept_however_old(tmp_path: Path) -> None:
    store = store_with(tmp_path, 2, keep=2)
    store.load("lab", 1)
    for number in range(3, 6):
        store.save("lab", grid_of(number), {}, 0)
    assert [entry.version for entry in store.list()] == [1, 4, 5]


def test_other_programs_can_read_the_exports(tmp_path: Path) -> None:
    cells = np.array([[0, 128], [255, 128]], np.uint8)
    entry = MapStore(tmp_path).save("lab", OccupancyGrid(GridSpec(1 / 3, -1.1, 7.0, (2, 2)), cells), {}, 0)
    described = yaml.safe_load((entry.path / "map.yaml").read_text())
    assert described["resolution"] == 1 / 3
    assert described["origin"] == [-1.1, 7.0, 0]
    assert described["free_thresh"] == 0.196
    assert (entry.path / described["image"]).read_bytes() == b"P5\n2 2\n255\n" + bytes([0, 205, 254, 205])


@pytest.mark.parametrize("name", ["", ".", "..", "../lab", "a/b", ".hidden", "-x", "lab\n", "a" * 65, "a\0b", "ä"])
def test_names_that_are_no_names_are_refused(tmp_path: Path, name: str) -> None:
    store = MapStore(tmp_path / "root")
    with pytest.raises(MapError, match="cannot name a map"):
        store.save(name, grid_of(1), {}, 0)
    with pytest.raises(MapError, match="cannot name a map"):
        store.load(name)
    assert not (tmp_path / "root").exists()


def test_what_is_not_there_is_said_with_what_is(tmp_path: Path) -> None:
    with pytest.raises(MapError, match="there is none at all"):
        MapStore(tmp_path / "nowhere").load("lab")
    store = store_with(tmp_path, 2)
    with pytest.raises(MapError, match="no map 'lob'; there is lab"):
        store.load("lob")
    with pytest.raises(MapError, match="no version 7; it has 1, 2"):
        store.load("lab", 7)


def test_strangers_in_the_directory_do_not_disturb(tmp_path: Path) -> None:
    store = store_with(tmp_path, 1)
    (tmp_path / "README").write_text("hello")
    (tmp_path / "lab" / "notes").mkdir()
    (tmp_path / "lab" / "02").mkdir()
    (tmp_path / ".tmp-lab-2").mkdir()
    assert [entry.version for entry in store.list()] == [1]
    assert store.save("lab", grid_of(2), {}, 0).version == 2
    assert not (tmp_path / ".tmp-lab-2").exists(), "what a crash left behind goes with the next save"


@pytest.mark.parametrize("file", ["manifest.json", "cells.bin", "map.pgm", "map.yaml"])
@pytest.mark.parametrize("harm", ["missing", "cut", "longer", "flipped", "empty"])
def test_damage_is_named_and_never_papered_over(tmp_path: Path, file: str, harm: str) -> None:
    store = store_with(tmp_path, 3)
    path = tmp_path / "lab" / "3" / file
    content = path.read_bytes()
    path.unlink()
    harmed = {
        "cut": content[:-1],
        "longer": content + b" x",
        "flipped": content[:30] + bytes([content[30] ^ 1]) + content[31:],
        "empty": b"",
    }
    if harm == "cut" and file == "manifest.json":
        harmed["cut"] = content[:-2]  # the last byte is a newline
    if harm in harmed:
        path.write_bytes(harmed[harm])
    with pytest.raises(MapError, match=rf"lab version 3 is damaged: {file}.*; version 2 is intact"):
        store.load("lab")
    assert store.load("lab", 2).entry.version == 2
    listed = store.list()[-1]
    assert listed.version == 3
    assert (listed.damage is not None) == (file == "manifest.json")


def test_damage_everywhere_is_said_too(tmp_path: Path) -> None:
    store = store_with(tmp_path, 2)
    for version in "12":
        (tmp_path / "lab" / version / "cells.bin").write_bytes(b"")
    with pytest.raises(MapError, match="no other version is intact"):
        store.load("lab")


def test_every_flipped_byte_of_a_manifest_is_noticed(tmp_path: Path) -> None:
    store = store_with(tmp_path, 1)
    path = tmp_path / "lab" / "1" / "manifest.json"
    content = path.read_bytes()
    for at in range(len(content) - 1):
        path.write_bytes(content[:at] + bytes([content[at] ^ 2]) + content[at + 1 :])
        if json_or_none(path) == json.loads(content):
            continue  # white space
        with pytest.raises(MapError, match=r"manifest\.json"):
            store.load("lab")


def json_or_none(path: Path) -> object:
    try:
        content: object = json.loads(path.read_bytes())
    except ValueError:
        return None
    return content


@pytest.mark.parametrize(
    ("key", "value", "says"),
    [
        ("digest", None, "has no 'digest'|makes no sense"),
        ("spec", {"resolution_m": -1.0, "origin_x_m": 0.0, "origin_y_m": 0.0, "shape": [6, 8]}, "must be positive"),
        ("spec", {"resolution_m": 0.05, "origin_x_m": 0.0, "origin_y_m": 0.0, "shape": [6, 8]}, "another digest"),
        ("spec", {"resolution_m": 0.05, "origin_x_m": 0.0, "origin_y_m": 0.0, "shape": [8, 8]}, "48 bytes for 8 x 8"),
        ("schema", 3, "schema 3, this version reads schemas 1 to 2"),
        ("name", "other", "belongs to map other"),
        ("files", {}, "does not list cells.bin"),
        ("surprise", 1, "makes no sense"),
    ],
)
def test_a_manifest_of_somebody_elses_making_is_refused(tmp_path: Path, key: str, value: object, says: str) -> None:
    store = store_with(tmp_path, 1)
    path = tmp_path / "lab" / "1" / "manifest.json"
    content = json.loads(path.read_bytes())
    content.pop("sha256")
    content[key] = value
    if value is None:
        del content[key]
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"))
    path.write_text(json.dumps({**content, "sha256": hashlib.sha256(canonical.encode()).hexdigest()}))
    with pytest.raises(MapError, match=says):
        store.load("lab")


def test_metadata_that_json_cannot_hold_leaves_no_trace(tmp_path: Path) -> None:
    store = store_with(tmp_path, 1)
    with pytest.raises(TypeError):
        store.save("lab", grid_of(2), {"who": object()}, 0)
    assert [entry.version for entry in store.list()] == [1]


def test_a_root_that_is_a_file_is_said(tmp_path: Path) -> None:
    (tmp_path / "root").write_text("")
    with pytest.raises(MapError, match="cannot save map lab"):
        MapStore(tmp_path / "root").save("lab", grid_of(1), {}, 0)


def kept(store: MapStore, seed: int) -> MapEntry:
    return store.save("lab", grid_of(seed), {"unsaved": True}, seed)


def test_unsaved_versions_take_no_place_from_saved_ones_and_three_are_kept(tmp_path: Path) -> None:
    store = store_with(tmp_path, 3, keep=3)
    for seed in range(4, 10):
        kept(store, seed)
    assert [(entry.version, entry.is_unsaved) for entry in store.list()] == [
        *((version, False) for version in (1, 2, 3)),
        *((version, True) for version in (7, 8, 9)),
    ]


def test_the_newest_saved_version_is_loaded_before_any_that_nobody_saved(tmp_path: Path) -> None:
    store = MapStore(tmp_path)
    only = kept(store, 1)
    assert store.load("lab").entry == only
    store.save("lab", grid_of(2), {}, 2)
    assert kept(store, 3).version == 3
    assert store.load("lab").entry.version == 2
    assert store.load("lab", 3).grid.digest() == grid_of(3).digest()


def test_saving_what_is_kept_takes_the_mark_away_and_keeping_it_again_writes_nothing(tmp_path: Path) -> None:
    store = MapStore(tmp_path)
    first = kept(store, 1)
    assert kept(store, 1) == first
    saved = store.save("lab", grid_of(1), {"stops": 2}, 17)
    assert (saved.version, saved.is_unsaved, saved.metadata, saved.created_unix_ns) == (1, False, {"stops": 2}, 17)
    assert store.list() == (saved,)
    stored = store.load("lab", 1)
    grid, entry = stored.grid, stored.entry
    assert (entry, grid.digest()) == (saved, grid_of(1).digest())
    assert sorted(path.name for path in tmp_path.iterdir()) == [".lock", "lab"]


def test_saving_under_another_name_takes_the_place_of_what_was_kept(tmp_path: Path) -> None:
    store = MapStore(tmp_path)
    before = kept(store, 1)
    saved = store.save("hall", grid_of(1), {}, 2, in_place_of=(before.name, before.version))
    assert store.list() == (saved,)
    assert store.load("hall").grid.digest() == grid_of(1).digest()


def test_what_is_kept_of_a_map_that_grows_takes_the_place_of_what_was_kept_before(tmp_path: Path) -> None:
    store = MapStore(tmp_path)
    before = kept(store, 1)
    later = store.save("lab", grid_of(2), {"unsaved": True}, 2, in_place_of=("lab", before.version))
    assert store.list() == (later,)
    again = store.save("lab", grid_of(2), {"unsaved": True}, 3, in_place_of=("lab", later.version))
    assert store.list() == (later,)
    assert again == later


def test_a_version_that_somebody_saved_gives_its_place_to_nothing(tmp_path: Path) -> None:
    store = store_with(tmp_path, 2)
    store.save("lab", grid_of(9), {"unsaved": True}, 9, in_place_of=("lab", 1))
    store.save("hall", grid_of(9), {}, 9, in_place_of=("lab", 77))
    assert [(entry.name, entry.version) for entry in store.list()] == [("hall", 1), ("lab", 1), ("lab", 2), ("lab", 3)]


@pytest.mark.parametrize("metadata", [{"note": "x" * (1 << 20)}, {"counts": {2: "a", 10: "b"}}])
def test_metadata_that_could_not_be_read_again_leave_what_is_kept_alone(
    tmp_path: Path, metadata: dict[str, Any]
) -> None:
    store = MapStore(tmp_path)
    before = kept(store, 1)
    with pytest.raises(MapError, match="cannot save map lab"):
        store.save("lab", grid_of(1), metadata, 2)
    assert store.list() == (before,)
    assert store.load("lab").entry == before


def test_what_is_kept_but_damaged_is_saved_anew(tmp_path: Path) -> None:
    store = MapStore(tmp_path)
    (kept(store, 1).path / "cells.bin").write_bytes(bytes(48))
    saved = store.save("lab", grid_of(1), {}, 2)
    assert saved.version == 2
    assert store.load("lab").grid.digest() == grid_of(1).digest()


@pytest.mark.parametrize("origin", [0, np.float64(-3.0), True], ids=repr)
def test_a_grid_placed_by_whole_numbers_or_numpys_comes_back(tmp_path: Path, origin: float) -> None:
    store = MapStore(tmp_path, keep=10)
    grid = OccupancyGrid(GridSpec(1, origin, origin, (4, 5)))
    saved = store.save("lab", grid, {}, 1)
    stored = store.load("lab")
    loaded, entry = stored.grid, stored.entry
    assert (entry.version, loaded.digest()) == (saved.version, grid.digest())
