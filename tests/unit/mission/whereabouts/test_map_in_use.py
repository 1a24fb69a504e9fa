"""The map in use is replaced, never changed under those who hold it; what is saved of it, and what is at risk."""

import numpy as np

from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.map_stops import MapStops
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.mission.whereabouts.laying import lay
from robotd.mission.whereabouts.map_in_use import MapInUse


def place() -> MapInUse:
    grid = OccupancyGrid(GridSettings(rows=60, cols=60).spec_covering(((0.0, 0.0),), 1.0))
    return MapInUse("m", "office", grid)


def sweep_at(in_odom: Pose2) -> Sweep:
    readings = (RangeReading(number, number * 0.2, ReadingStatus.OK, 1.0) for number in range(30))
    return Sweep(0, in_odom, tuple(readings))


def test_a_sweep_makes_a_new_grid_and_leaves_every_snapshot_alone() -> None:
    here = place()
    before, snapshot = here.grid, here.whole(1)
    laid = lay(here.grid, here.latest, here.stops, sweep_at(IDENTITY), IDENTITY)
    assert here.grid is before
    assert np.all(before.cells == before.cells[0, 0])
    here.take(laid)
    assert here.grid is laid.grid
    assert here.digest == laid.grid.digest() != before.digest()
    assert here.generation == 1
    assert np.all(snapshot.values == before.cells)
    change = here.changes(2, laid.cells)
    patched = snapshot.values.copy()
    patched.reshape(-1)[change.cells] = change.values
    assert np.array_equal(patched, here.whole(3).values)
    assert (snapshot.generation, change.generation) == (0, 1)


def test_a_map_is_made_of_the_stops_that_were_laid_in_and_no_snapshot_of_them_changes() -> None:
    here, map_from_odom = place(), Pose2(0.5, 0.25, 0.3)
    here.stops = before = MapStops(here.grid.settings)
    for x_m in (0.0, 0.1):
        sweep = sweep_at(Pose2(x_m, 0.0, 0.0))
        here.take(lay(here.grid, here.latest, here.stops, sweep, map_from_odom @ sweep.in_odom))
    assert here.stops is not None
    assert before.stops == ()
    assert [stop.map_from_robot for stop in here.stops.stops] == [
        map_from_odom @ Pose2(x_m, 0.0, 0.0) for x_m in (0.0, 0.1)
    ]
    assert here.stops.grid_on(here.grid.spec).digest() == here.digest


def test_a_map_whose_stops_are_not_known_does_not_get_to_know_them() -> None:
    here = place()
    here.take(lay(here.grid, here.latest, here.stops, sweep_at(IDENTITY), IDENTITY))
    assert here.stops is None


def test_what_is_saved_kept_and_given_up_is_known_by_the_change_up_to_which_it_is() -> None:
    here = place()
    assert (here.is_unsaved, here.at_risk, here.kept_as) == (False, 0, None)
    here.generation = 3
    here.kept(2, 7)
    assert (here.is_unsaved, here.at_risk, here.kept_as) == (True, 1, None)
    here.kept(3, 8)
    assert (here.is_unsaved, here.at_risk, here.kept_as) == (True, 0, 8)
    here.saved(3)
    assert (here.is_unsaved, here.at_risk, here.kept_as) == (False, 0, None)
    here.saved(1)  # a save that began earlier and ended later makes nothing unsaved
    assert not here.is_unsaved
    here.generation = 4
    assert here.at_risk == 1
    here.given_up()
    assert not here.is_unsaved


def test_a_map_that_nobody_had_saved_is_unsaved_from_the_start_and_not_at_risk() -> None:
    here = place()
    here.found_unsaved(5)
    assert (here.is_unsaved, here.at_risk, here.kept_as) == (True, 0, 5)
    here.generation = 1
    assert (here.at_risk, here.kept_as) == (True, None)
