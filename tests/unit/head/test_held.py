"""A map that changed is made ready from what changed, to the same result; no generation is touched by the next."""

import math
from typing import Any

import numpy as np
import pytest

from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.map_stops import MapStops
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
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
