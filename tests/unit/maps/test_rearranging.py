"""Copying, renaming and deleting maps: what was saved is under one of the names at any moment; nothing else goes."""

from pathlib import Path

import pytest

from robotd.core.errors import MapError
from robotd.maps import atomic
from robotd.maps.entry import UNSAVED
from robotd.maps.lock import sole_writer
from robotd.maps.store import MapStore
from tests.support.made_maps import SPEC, made_stops


def store_of(root: Path, versions: int = 3, keep: int = 10) -> MapStore:
    store = MapStore(root, keep=keep)
    for seed in range(versions):
        stops = made_stops(seed)
        store.save("lab", stops.grid_on(SPEC), {"seed": seed}, 100 + seed, stops)
    return store


def content(store: MapStore, name: str) -> list[tuple[str, int, int | None, object]]:
    entries = (entry for entry in store.list() if entry.name == name)
    return [(entry.digest, entry.created_unix_ns, entry.stops, entry.metadata) for entry in entries]


def test_a_copy_is_the_map_once_more_with_its_stops(tmp_path: Path) -> None:
    store = store_of(tmp_path)
    entry = store.copy("lab", "hall", 2)
    assert (entry.name, entry.version) == ("hall", 1)
    assert content(store, "hall") == content(store, "lab")[1:2]
    assert store.load("hall").stops == store.load("lab", 2).stops
    assert store.copy("lab", "hall").version == 2
    assert len(content(store, "lab")) == 3


def test_a_renamed_map_has_all_its_versions_also_those_that_nobody_saved(tmp_path: Path) -> None:
    store = store_of(tmp_path)
    stops = made_stops(9)
    store.save("lab", stops.grid_on(SPEC), {UNSAVED: True}, 200, stops)
    before = content(store, "lab")
    assert [entry.version for entry in store.rename("lab", "hall")] == [1, 2, 3, 4]
    assert content(store, "hall") == before
    assert content(store, "lab") == []
    assert not (tmp_path / "lab").exists()


def test_renaming_drops_no_version_however_few_are_kept(tmp_path: Path) -> None:
    store_of(tmp_path, versions=5)
    assert len(MapStore(tmp_path, keep=1).rename("lab", "hall")) == 5


def test_a_deleted_version_goes_and_the_others_stay(tmp_path: Path) -> None:
    store = store_of(tmp_path)
    before = content(store, "lab")
    assert store.delete("lab", 2) == (2,)
    assert content(store, "lab") == [before[0], before[2]]
    assert store.delete("lab") == (1, 3)
    assert store.list() == ()
    assert not (tmp_path / "lab").exists()


def test_deleting_leaves_what_is_not_of_the_map(tmp_path: Path) -> None:
    store = store_of(tmp_path)
    (tmp_path / "lab" / "notes.txt").write_text("mine")
    store.delete("lab")
    assert (tmp_path / "lab" / "notes.txt").read_text() == "mine"
    assert store.list() == ()


def test_a_damaged_version_can_be_deleted_and_is_not_renamed(tmp_path: Path) -> None:
    store = store_of(tmp_path)
    (tmp_path / "lab" / "2" / "cells.bin").write_bytes(b"")
    with pytest.raises(MapError, match=r"version 2 is damaged.*version 3 is intact"):
        store.rename("lab", "hall")
    assert content(store, "hall") == []
    store.delete("lab", 2)
    assert len(store.rename("lab", "hall")) == 2


@pytest.mark.parametrize(
    ("new_name", "why"),
    [("hall", "there is a map 'hall' already"), ("..", "cannot name a map"), ("LAB", "capitals"), ("lab", "already")],
)
def test_a_name_that_cannot_be_taken_is_refused_and_nothing_changes(tmp_path: Path, new_name: str, why: str) -> None:
    store = store_of(tmp_path)
    store.copy("lab", "hall")
    before = store.list()
    with pytest.raises(MapError, match=why):
        store.rename("lab", new_name)
    assert store.list() == before


def test_what_is_not_there_is_said(tmp_path: Path) -> None:
    store = store_of(tmp_path, versions=1)
    for act in (store.delete, lambda name: store.rename(name, "x"), lambda name: store.copy(name, "x")):
        with pytest.raises(MapError, match="there is no map 'hall'; there is lab"):
            act("hall")
    with pytest.raises(MapError, match="has no version 7; it has 1"):
        store.delete("lab", 7)


def test_writers_take_turns(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = store_of(tmp_path)
    monkeypatch.setattr("robotd.maps.archive.sole_writer", lambda root: sole_writer(root, wait_s=0.0))
    with sole_writer(tmp_path):
        for act in (lambda: store.rename("lab", "hall"), lambda: store.delete("lab")):
            with pytest.raises(MapError, match="nothing was changed"):
                act()
    assert len(content(store, "lab")) == 3


@pytest.mark.parametrize("at", range(1, 10))
def test_a_rename_that_is_cut_short_loses_nothing(tmp_path: Path, at: int, monkeypatch: pytest.MonkeyPatch) -> None:
    store = store_of(tmp_path, versions=2)
    before = content(store, "lab")
    calls = iter(range(1, 1000))
    real = atomic.sync_directory

    def failing(path: Path) -> None:
        if next(calls) >= at:
            raise OSError(28, "No space left on device")
        real(path)

    monkeypatch.setattr(atomic, "sync_directory", failing)
    try:
        store.rename("lab", "hall")
    except MapError:
        assert content(store, "lab") == before
    else:
        assert content(store, "hall") == before
