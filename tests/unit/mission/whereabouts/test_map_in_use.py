"""What is told of the map in use as it changes; what is saved of it, and what is at risk."""

import numpy as np

from robotd.core.grid_bytes import unpacked_cells
from robotd.exploring.errand import Errand
from robotd.head.jobs import Inserted, MapRef
from robotd.mission.whereabouts.map_in_use import MapState
from tests.support.places import held, place


def test_a_change_is_told_and_the_map_goes_on_from_there() -> None:
    here = place("office", held(stops=0))
    whole = here.whole(1)
    assert whole.packed is not None
    assert (whole.whole, whole.generation, whole.stops, here.ref) == (True, 0, 0, MapRef(here.number, 0))
    assert unpacked_cells(whole.packed, whole.spec).shape == here.spec.shape
    inserted = Inserted(np.array([3, 7], "<i8").tobytes(), bytes([20, 200]), "another", 1)
    here.take(inserted)
    change = here.changes(2, inserted)
    assert (change.generation, change.cells.tolist(), change.values.tolist()) == (1, [3, 7], [20, 200])
    assert (change.whole, change.packed, change.stops) == (False, None, 1)
    assert (here.digest, here.ref) == ("another", MapRef(here.number, 1))


def test_what_is_saved_kept_and_given_up_is_known_by_the_change_up_to_which_it_is() -> None:
    here = place()
    assert (here.is_unsaved, here.is_at_risk, here.kept_as) == (False, False, None)
    here.generation = 3
    here.kept(MapState(2), 7)
    assert (here.is_unsaved, here.is_at_risk, here.kept_as) == (True, True, None)
    here.kept(MapState(3), 8)
    assert (here.is_unsaved, here.is_at_risk, here.kept_as) == (True, False, 8)
    here.saved(MapState(3))
    assert (here.is_unsaved, here.is_at_risk, here.kept_as) == (False, False, None)
    here.saved(MapState(1))  # a save that began earlier and ended later makes nothing unsaved
    assert not here.is_unsaved
    here.generation = 4
    assert here.is_at_risk
    here.given_up()
    assert not here.is_unsaved


def test_a_map_that_nobody_had_saved_is_unsaved_from_the_start_and_not_at_risk() -> None:
    here = place()
    here.found_unsaved(5)
    assert (here.is_unsaved, here.is_at_risk, here.kept_as) == (True, False, 5)
    here.generation = 1
    assert (here.is_at_risk, here.kept_as) == (True, None)


def test_what_is_remarked_beside_the_cells_is_a_change_too() -> None:
    """A bump on a map that was saved, or that comes while the disk writes, is not in the store yet."""
    here = place()
    here.saved(here.state)
    here.bumped((1.0, 2.0))
    assert (here.is_unsaved, here.is_at_risk, here.bumps_m) == (True, True, ((1.0, 2.0),))
    written = here.state
    here.bumped((1.5, 2.0))
    here.kept(written, 2)
    assert here.is_at_risk
    here.kept(here.state, 3)
    assert (here.is_unsaved, here.is_at_risk) == (True, False)
    here.explored(errand := Errand((0.0, 0.0)))
    assert here.is_at_risk
    here.kept(here.state, 4)
    here.explored(errand)  # that is no news
    assert not here.is_at_risk
