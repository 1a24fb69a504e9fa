"""A map is stored with its stops, comes back with them, and they make it again; one without them stays one without."""

import dataclasses
import logging
import math
import zlib
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from robotd.core.errors import MapError
from robotd.core.map_stop import MapStop, StopSlant
from robotd.core.pose import IDENTITY
from robotd.core.reading import RangeReading, ReadingStatus, Sweep, Tilt
from robotd.grid import map_stops
from robotd.grid.map_stops import MapStops
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings, UpdatePolicy
from robotd.maps.manifest import FileSum, decode_manifest
from robotd.maps.stops_file import decode_stops, encode_stops
from robotd.maps.store import MapStore
from tests.support.made_maps import SPEC, made_stops

FARTHEST = RangeReading(0, 0.0, ReadingStatus.OK, 1e9)
OTHER = GridSettings(raise_alpha=0.6, policy=UpdatePolicy.PER_READING)


def save(root: Path, stops: MapStops, **metadata: Any) -> Path:
    return MapStore(root).save("lab", stops.grid_on(SPEC), metadata, 5, stops).path


def test_stops_come_back_and_make_the_map_again(tmp_path: Path) -> None:
    made = made_stops(3, settings=OTHER)
    save(tmp_path, made)
    stored = MapStore(tmp_path, GridSettings(raise_alpha=0.1)).load("lab")
    assert stored.stops == made
    assert stored.grid.digest() == made.grid_on(SPEC).digest() == stored.entry.digest
    assert stored.entry.stops == 2
    assert MapStore(tmp_path).list() == (stored.entry,)


def test_a_map_goes_on_by_the_settings_that_it_was_made_with(tmp_path: Path) -> None:
    made = made_stops(3, settings=OTHER)
    save(tmp_path, made)
    stored = MapStore(tmp_path, GridSettings(raise_alpha=0.1)).load("lab")
    assert stored.stops is not None
    further = made_stops(4).stops[0]
    stored.grid.insert(further.sweep, further.map_from_robot)
    assert stored.stops.with_stop(further).grid_on(SPEC).digest() == stored.grid.digest()


def test_a_map_on_which_nothing_was_seen_has_no_stops_but_knows_that(tmp_path: Path) -> None:
    save(tmp_path, MapStops(GridSettings()))
    stored = MapStore(tmp_path).load("lab")
    assert (stored.entry.stops, stored.stops) == (0, MapStops(GridSettings()))


def test_a_map_without_stops_is_listed_loaded_and_saved_without(tmp_path: Path) -> None:
    grid = OccupancyGrid(SPEC, np.random.default_rng(1).integers(0, 256, SPEC.shape, np.uint8))
    entry = MapStore(tmp_path).save("lab", grid, {}, 5)
    stored = MapStore(tmp_path).load("lab")
    assert (entry.stops, stored.stops) == (None, None)
    assert not (entry.path / "stops.bin").exists()


@pytest.mark.parametrize("harm", ["missing", "cut", "longer", "flipped", "empty"])
def test_damaged_stops_are_named_and_the_version_before_too(tmp_path: Path, harm: str) -> None:
    save(tmp_path, made_stops(1))
    path = save(tmp_path, made_stops(2)) / "stops.bin"
    data = path.read_bytes()
    path.unlink()
    harmed = {"cut": data[:-1], "longer": data + b"x", "flipped": data[:40] + b"?" + data[41:], "empty": b""}
    if harm in harmed:
        path.write_bytes(harmed[harm])
    with pytest.raises(MapError, match=r"lab version 2 is damaged: stops\.bin.*; version 1 is intact"):
        MapStore(tmp_path).load("lab")
    assert MapStore(tmp_path).list()[-1].damage is None


def forge(path: Path, stops: bytes | None, count: int | None) -> None:
    """Put other stops in the place of a version's, with right sums all round."""
    manifest = decode_manifest((path / "manifest.json").read_bytes())
    files = {name: one for name, one in manifest.files.items() if name != "stops.bin"}
    if stops is not None:
        (path / "stops.bin").write_bytes(stops)
        files["stops.bin"] = FileSum.of((stops,))
    forged = dataclasses.replace(manifest, files=files, stops=count)
    (path / "manifest.json").write_bytes(forged.encode())


@pytest.mark.parametrize(
    ("stops", "count", "says"),
    [
        (encode_stops(made_stops(2)), 2, r"stops\.bin does not make this map: \d+ of 600 cells come out otherwise"),
        (encode_stops(made_stops(1, 3)), 3, r"stops\.bin does not make this map"),
        (encode_stops(made_stops(1)), 3, r"stops\.bin has 2 stops, manifest\.json says 3"),
        (encode_stops(made_stops(1)), 10**30, r"manifest\.json says 10{30}"),
        (b"robotd stops 9\n", 2, r"stops\.bin: it has format '9'"),
        (b"", 2, r"stops\.bin: it does not begin with"),
        (None, 2, r"manifest\.json does not list stops\.bin"),
    ],
    ids=["others", "more", "miscounted", "uncountable", "format", "nothing", "unlisted"],
)
def test_stops_that_are_not_those_of_the_map_are_refused(
    tmp_path: Path, stops: bytes | None, count: int, says: str
) -> None:
    forge(save(tmp_path, made_stops(1)), stops, count)
    with pytest.raises(MapError, match=says):
        MapStore(tmp_path).load("lab")


def aslant(angle_rad: float) -> MapStops:
    """Return a stop on a corner of cells, whose one beam runs along the border of two rows but for an angle."""
    reading = RangeReading(0, angle_rad, ReadingStatus.OK, 1.05)
    return MapStops(GridSettings()).with_stop(MapStop.of(Sweep(0, IDENTITY, (reading,)), IDENTITY))


def test_where_a_last_place_counts_the_grid_of_the_maps_maker_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """Another machine draws a beam along a border on its other side: the map is loaded as it was made."""
    there = aslant(-1e-14)
    grid, here = there.grid_on(SPEC), aslant(1e-14)
    assert 0 < np.count_nonzero(grid.cells != here.grid_on(SPEC).cells) < 30
    foreign = dataclasses.replace(here, arithmetic="another")
    path = MapStore(tmp_path).save("lab", grid, {}, 5, there).path
    forge(path, encode_stops(foreign), 1)
    caplog.set_level(logging.INFO)
    stored = MapStore(tmp_path).load("lab")
    assert (stored.grid.digest(), stored.stops) == (grid.digest(), foreign)
    assert "this machine's arithmetic would draw" in caplog.text
    forge(path, encode_stops(here), 1)
    with pytest.raises(MapError, match=r"stops\.bin does not make this map"):
        MapStore(tmp_path).load("lab")
    monkeypatch.setattr(map_stops, "arithmetic", lambda: "this")
    assert MapStore(tmp_path).load("lab").grid.digest() == grid.digest()


def test_a_foreign_map_is_saved_again_as_foreign(tmp_path: Path) -> None:
    foreign = dataclasses.replace(aslant(1e-14), arithmetic="another")
    grid = aslant(-1e-14).grid_on(SPEC)
    MapStore(tmp_path).save("lab", grid, {}, 5, foreign)
    stored = MapStore(tmp_path).load("lab")
    MapStore(tmp_path).save("hall", stored.grid, {}, 6, stored.stops)
    assert MapStore(tmp_path).load("hall").stops == foreign


@pytest.mark.parametrize(
    "wrong",
    [
        made_stops(2),
        MapStops(GridSettings()).with_stop(MapStop.of(Sweep(0, IDENTITY, (FARTHEST,)), IDENTITY)),
    ],
    ids=["of another map", "that cannot be stored"],
)
def test_a_map_is_not_lost_for_its_stops(tmp_path: Path, wrong: MapStops, caplog: pytest.LogCaptureFixture) -> None:
    grid = made_stops(1).grid_on(SPEC)
    entry = MapStore(tmp_path).save("lab", grid, {}, 5, wrong)
    assert "map lab is saved without its stops" in caplog.text
    stored = MapStore(tmp_path).load("lab")
    assert (stored.grid.digest(), stored.stops, stored.entry) == (grid.digest(), None, entry)


def test_a_kept_map_is_saved_in_place_with_its_stops_alone(tmp_path: Path) -> None:
    save(tmp_path, made_stops(1), unsaved=True)
    assert save(tmp_path, made_stops(1)).name == "1"
    assert MapStore(tmp_path).load("lab").stops == made_stops(1)
    save(tmp_path, made_stops(2), unsaved=True)
    assert MapStore(tmp_path).save("lab", made_stops(2).grid_on(SPEC), {}, 5).version == 3
    assert MapStore(tmp_path).load("lab").stops is None


def layered(*tilts: Tilt) -> MapStops:
    """Return stops of which the first looks at all tilts, and the others at all but the first."""
    made, slants = made_stops(3, settings=OTHER), made_stops(4).stops[0].readings
    stops = tuple(
        dataclasses.replace(stop, slants=tuple(StopSlant(tilt, slants[at:]) for tilt in tilts[min(at, 1) :]))
        for at, stop in enumerate(made.stops)
    )
    return dataclasses.replace(made, stops=stops)


def test_what_was_seen_at_further_tilts_comes_back_with_its_stop(tmp_path: Path) -> None:
    made = layered(Tilt(-0.24, 2.1), Tilt(0.1, 4.0))
    save(tmp_path, made)
    stops = MapStore(tmp_path).load("lab").stops
    assert stops == made
    assert stops.tilts == (Tilt(-0.24, 2.1), Tilt(0.1, 4.0))
    assert [len(stops.layer(tilt_rad).stops) for tilt_rad in (-0.24, 0.1)] == [1, len(made.stops)]
    assert stops != dataclasses.replace(made, stops=made_stops(3).stops)


def test_a_map_without_layers_is_written_as_before_there_were_any() -> None:
    made = made_stops(3)
    plain, more = (zlib.decompress(encode_stops(one).partition(b"\n")[2]) for one in (made, layered(Tilt(0.1, 4.0))))
    keys = "numbers counts in_odom in_map times_ns bearings_rad ranges_m origins_m states statuses strong strengths"
    content = msgspec.msgpack.decode(plain)
    assert list(content) == ["settings", "arithmetic", "columns"]
    assert list(content["columns"]) == keys.split()
    assert list(msgspec.msgpack.decode(more)) == ["settings", "arithmetic", "columns", "layers"]


@pytest.mark.parametrize(
    ("field", "value", "complaint"),
    [
        ("tilt_rad", math.nan, "expected a tilt"),
        ("tilt_rad", 2.0, "expected a tilt"),
        ("cut_off_m", 0.0, "expected a tilt"),
        ("counts", b"", "counts: expected 2 numbers"),
        ("bearings_rad", b"", "bearings_rad: expected"),
        ("ranges_m", None, "Object missing required field"),
    ],
)
def test_a_layer_that_contradicts_itself_is_refused_by_name(field: str, value: object, complaint: str) -> None:
    head, _, packed = encode_stops(layered(Tilt(0.1, 4.0))).partition(b"\n")
    content = msgspec.msgpack.decode(zlib.decompress(packed))
    content["layers"][0][field] = value
    if value is None:
        del content["layers"][0][field]
    with pytest.raises(MapError, match=complaint):
        decode_stops(head + b"\n" + zlib.compress(msgspec.msgpack.encode(content)))
