"""Maps that older versions saved are read for ever, and saved again as what they are.

``schema_1`` was written by version 0.1, before stops were stored; ``schema_2`` by the first that stored them.
"""

import json
import shutil
from pathlib import Path

import pytest

from robotd.core.errors import MapError
from robotd.maps.manifest import SCHEMA, decode_manifest
from robotd.maps.store import MapStore

HERE = Path(__file__).parent
DIGEST = "93fe32aca3fb8872a527fb7af8177f49bb1fd5ee6d340ed50d39fe24b833dfbb"


@pytest.fixture(name="root", params=["schema_1", "schema_2"])
def _root(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    return Path(shutil.copytree(HERE / request.param, tmp_path / request.param))


def stops_in(root: Path) -> int | None:
    return 2 if root.name == "schema_2" else None


def test_there_is_a_fixture_of_every_schema() -> None:
    for number in range(1, SCHEMA + 1):
        manifest = json.loads((HERE / f"schema_{number}" / "office" / "1" / "manifest.json").read_bytes())
        assert manifest["schema"] == number


def test_an_old_map_is_listed_and_loaded(root: Path) -> None:
    store = MapStore(root)
    assert [(entry.name, entry.is_unsaved, entry.damage, entry.stops) for entry in store.list()] == [
        ("attic", True, None, stops_in(root)),
        ("office", False, None, stops_in(root)),
    ]
    for name in ("attic", "office"):
        stored = store.load(name)
        assert stored.grid.digest() == stored.entry.digest == DIGEST
        assert (stored.stops is None) == (root.name == "schema_1")
        assert stored.entry.metadata["generation"] == 2


def test_an_old_map_is_saved_again_as_what_it_is(root: Path) -> None:
    store = MapStore(root)
    old = store.load("office")
    store.save("office", old.grid, {}, 5, old.stops)
    again = MapStore(root).load("office")
    assert (again.entry.version, again.grid.digest(), again.stops) == (2, DIGEST, old.stops)
    assert again.entry.stops == stops_in(root)
    assert (again.entry.path / "stops.bin").exists() == (root.name == "schema_2")
    assert MapStore(root).load("office", 1).entry == old.entry


def test_an_old_map_that_was_kept_loses_its_mark_when_it_is_saved(root: Path) -> None:
    store = MapStore(root)
    old = store.load("attic")
    entry = store.save("attic", old.grid, {}, 5, old.stops)
    assert (entry.version, entry.is_unsaved) == (1, False)
    again = MapStore(root).load("attic")
    assert (again.grid.digest(), again.stops, again.entry) == (DIGEST, old.stops, entry)
    rewritten = (root / "attic" / "1" / "manifest.json").read_bytes()
    assert json.loads(rewritten)["schema"] == SCHEMA
    assert decode_manifest(rewritten).stops == stops_in(root)


def test_an_old_map_that_was_damaged_is_refused(root: Path) -> None:
    path = root / "office" / "1" / "cells.bin"
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(MapError, match=r"office version 1 is damaged: cells\.bin has 719 bytes"):
        MapStore(root).load("office")
