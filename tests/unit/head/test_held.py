"""A map that changed is made ready from what changed, to the same result; no generation is touched by the next."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Slant, Sweep, Tilt
from robotd.grid.map_stops import MapStops
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.grid.tables import NO_INFORMATION
from robotd.head.held import Held
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.meaning import Meaning
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings

SETTINGS = LocalizationSettings()
ERRORS = ErrorModel()
GRID = GridSettings(rows=90, cols=120)


def swept(x_m: float) -> Sweep:
    bearings = np.arange(60) * math.tau / 60
    taken = tuple(RangeReading(0, bearing, ReadingStatus.OK, 1.0 + 0.3 * math.sin(5 * bearing)) for bearing in bearings)
    return Sweep(0, Pose2(x_m, 0.2, 0.0), taken)


def blank(stops: MapStops | None = None) -> Held:
    return Held.of(OccupancyGrid(GRID.spec_covering(((0, 0),), 1.0), settings=GRID), stops)


def laid(held: Held, *xs_m: float) -> Held:
    for x_m in xs_m:
        sweep = swept(x_m)
        held, _ = held.with_sweep(sweep, sweep.in_odom)
    return held


def made_ready(held: Held) -> Held:
    return held.made_ready(SETTINGS, ERRORS)[0]


def arrays(ready: ReadyMap) -> list[Any]:
    planes, packed = ready.searched.planes, ready.prepared.maps[0].packed
    return [
        *(planes.cells, planes.pooled, planes.near, planes.ground.free, planes.ground.blocking, planes.ground.grown),
        *(packed.free, packed.blocking, packed.grown, packed.tiles),
        *(value for one in ready.meanings for value in meant(one)),
        *(ready.ternary.occupied, ready.ternary.vacant),
    ]


def meant(meaning: Meaning) -> list[Any]:
    chances = meaning.likelihood.chances
    return [chances.cells, chances.skips, meaning.likelihood.vacant_m2, meaning.walls.codes, meaning.walls.skips]


@pytest.fixture
def from_nothing(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Notes each time a map is made ready from nothing."""
    made: list[int] = []
    whole = ReadyMap.of

    def noting(*args: Any) -> ReadyMap:
        made.append(1)
        return whole(*args)

    monkeypatch.setattr(ReadyMap, "of", noting)
    return made


def same(one: Held, other: Held) -> None:
    assert one.ready is not None
    assert other.ready is not None
    for mine, theirs in zip(arrays(one.ready), arrays(other.ready), strict=True):
        np.testing.assert_array_equal(mine, theirs)


def test_sweeps_between_two_localizations_are_taken_in_at_once_and_only_where_they_were(
    from_nothing: list[int],
) -> None:
    updated = made_ready(laid(made_ready(laid(blank(), -0.5)), 0.4, 0.9))
    assert len(from_nothing) == 1
    fresh = made_ready(Held.of(updated.grid, None))
    assert len(from_nothing) == 2
    same(updated, fresh)


def test_a_map_that_did_not_change_stays_ready() -> None:
    ready = made_ready(blank())
    assert made_ready(ready).ready is ready.ready


def test_where_one_generation_was_made_ready_and_given_up_the_next_takes_in_what_that_one_did(
    from_nothing: list[int],
) -> None:
    ready = made_ready(laid(blank(), -0.5))
    before = laid(ready, 0.4)
    made_ready(before)  # the mission was stopped while it ran
    updated = made_ready(laid(before, 0.9))
    assert len(from_nothing) == 1
    same(updated, made_ready(Held.of(updated.grid, None)))


def test_a_sweep_makes_another_grid_and_leaves_the_one_before_alone() -> None:
    before = blank()
    cells_before = before.grid.cells.copy()
    after, cells = before.with_sweep(swept(0.0), IDENTITY)
    assert np.array_equal(before.grid.cells, cells_before)
    assert not before.latest.any()
    assert after.digest == after.grid.digest() != before.digest
    patched = cells_before
    patched.reshape(-1)[cells] = after.grid.cells.reshape(-1)[cells]
    assert np.array_equal(patched, after.grid.cells)


def test_a_map_is_made_of_the_stops_that_were_laid_in_and_no_snapshot_of_them_changes() -> None:
    before = blank(MapStops(GRID))
    after = laid(before, 0.0, 0.1)
    assert before.stops == MapStops(GRID)
    assert after.stops is not None
    assert [stop.map_from_robot for stop in after.stops.stops] == [Pose2(x_m, 0.2, 0.0) for x_m in (0.0, 0.1)]
    assert after.stops.grid_on(after.grid.spec).digest() == after.digest


def test_a_map_whose_stops_are_not_known_does_not_get_to_know_them() -> None:
    assert laid(blank(), 0.0).stops is None


DOWN, UP = Tilt(-0.24, 2.1), Tilt(0.1, 4.0)


def slanted(x_m: float, *tilts: Tilt) -> Sweep:
    """Return a sweep that sees at each further tilt something of its own."""
    seen = (
        Slant(
            tilt,
            tuple(
                replace(reading, range_m=(reading.range_m or 0.0) + tilt.tilt_rad) for reading in swept(x_m).readings
            ),
        )
        for tilt in tilts
    )
    return replace(swept(x_m), slants=tuple(seen))


def test_a_layer_is_the_map_of_what_was_seen_at_its_tilt_and_the_first_one_knows_nothing_of_it() -> None:
    sweeps = slanted(0.1, DOWN, UP), slanted(0.2), slanted(-0.3, UP)
    held, plain = blank(MapStops(GRID)), blank(MapStops(GRID))
    for sweep in sweeps:
        held, cells = held.with_sweep(sweep, sweep.in_odom)
        plain, same = plain.with_sweep(replace(sweep, slants=()), sweep.in_odom)
        assert np.array_equal(cells, same)
    assert held.digest == plain.digest
    assert held.tilts == held.told.tilts == (DOWN, UP)
    for layer in held.layers:
        alone = OccupancyGrid(held.grid.spec, settings=GRID)
        for sweep in sweeps:
            for slant in sweep.slants:
                if slant.tilt == layer.tilt:
                    alone.insert(Sweep(0, sweep.in_odom, slant.readings), sweep.in_odom)
        assert layer.held.digest == alone.digest() != held.digest


def test_a_map_from_the_store_has_the_layers_that_it_was_laid_with() -> None:
    held = blank(MapStops(GRID))
    for sweep in (slanted(0.1, DOWN, UP), slanted(-0.3, UP)):
        held, _ = held.with_sweep(sweep, sweep.in_odom)
    again = Held.of(held.grid, held.stops)
    assert [(layer.tilt, layer.held.digest) for layer in again.layers] == [
        (layer.tilt, layer.held.digest) for layer in held.layers
    ]


def test_what_stands_at_any_height_is_an_obstacle() -> None:
    held, _ = blank(MapStops(GRID)).with_sweep(slanted(0.1, DOWN), Pose2(0.1, 0.2, 0.0))
    stored = Held.of(held.grid, held.stops)
    (layer,) = stored.layers
    met = layer.held.grid.cells > NO_INFORMATION
    assert met.any()
    assert not (met & (held.grid.cells > NO_INFORMATION)).all()
    # Nothing was laid in since it was loaded, so the first layer has nothing beyond its cells.
    assert np.array_equal(stored.obstacles(), met)
    assert (held.obstacles() & met).sum() == met.sum()


def test_layers_are_made_ready_from_what_changed() -> None:
    held = blank(MapStops(GRID))
    for x_m in (0.1, 0.2):
        held, _ = held.with_sweep(slanted(x_m, DOWN), Pose2(x_m, 0.2, 0.0))
        held, ((tilt, ready),) = held.layers_ready(SETTINGS, ERRORS)
    (layer,) = held.layers
    assert tilt == layer.tilt == DOWN
    remade = ReadyMap.of(layer.held.grid, SETTINGS, ERRORS)
    assert all(np.array_equal(one, other) for one, other in zip(arrays(ready), arrays(remade), strict=True))
