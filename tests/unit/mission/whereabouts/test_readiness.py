"""A map that changed is made ready from what changed, to the same result; a forgotten job spoils nothing."""

import math
from typing import Any

import numpy as np
import pytest

from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.meaning import Meaning
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings
from robotd.mission.whereabouts import readiness
from robotd.mission.whereabouts.laying import lay
from robotd.mission.whereabouts.map_in_use import MapInUse

SETTINGS = LocalizationSettings()
ERRORS = ErrorModel()


def swept(place: MapInUse, x_m: float) -> Sweep:
    bearings = np.arange(60) * math.tau / 60
    taken = tuple(RangeReading(0, bearing, ReadingStatus.OK, 1.0 + 0.3 * math.sin(5 * bearing)) for bearing in bearings)
    return Sweep(0, Pose2(x_m, 0.2, 0.0), taken)


def place() -> MapInUse:
    return MapInUse("m", "office", OccupancyGrid(GridSettings(rows=90, cols=120).spec_covering(((0, 0),), 1.0)))


def made(here: MapInUse) -> ReadyMap:
    return readiness.made_ready(here.grid, SETTINGS, ERRORS, *here.readiness.hand_over())


def insert(here: MapInUse, x_m: float) -> None:
    sweep = swept(here, x_m)
    here.take(lay(here.grid, here.latest, None, sweep, sweep.in_odom))


def arrays(ready: ReadyMap) -> list[Any]:
    planes, packed = ready.searched.planes, ready.prepared.packed
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
    whole = readiness._made

    def noting(grid: OccupancyGrid, settings: LocalizationSettings, errors: ErrorModel) -> ReadyMap:
        made.append(1)
        return whole(grid, settings, errors)

    monkeypatch.setattr(readiness, "_made", noting)
    return made


def test_sweeps_between_two_localizations_are_taken_in_at_once_and_only_where_they_were(
    from_nothing: list[int],
) -> None:
    here = place()
    insert(here, -0.5)
    here.readiness.keep(made(here))
    insert(here, 0.4)
    insert(here, 0.9)
    updated = made(here)
    assert len(from_nothing) == 1
    anew = place()
    anew.grid = here.grid
    fresh = made(anew)
    assert len(from_nothing) == 2
    for one, other in zip(arrays(updated), arrays(fresh), strict=True):
        np.testing.assert_array_equal(one, other)


def test_a_map_that_did_not_change_stays_ready(from_nothing: list[int]) -> None:
    here = place()
    ready = made(here)
    here.readiness.keep(ready)
    assert made(here) is ready


def test_where_nobody_took_the_result_of_a_job_the_next_takes_in_what_that_one_did(from_nothing: list[int]) -> None:
    here = place()
    insert(here, -0.5)
    here.readiness.keep(made(here))
    insert(here, 0.4)
    made(here)  # the mission was stopped while it ran
    insert(here, 0.9)
    updated = made(here)
    assert len(from_nothing) == 1
    for one, other in zip(arrays(updated), arrays(ReadyMap.of(here.grid, SETTINGS, ERRORS)), strict=True):
        np.testing.assert_array_equal(one, other)
