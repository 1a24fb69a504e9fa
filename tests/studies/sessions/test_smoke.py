"""Furniture is moved to where it fits, and a list of changes is held against what was moved."""

import pytest

from robotd.core.rectangle import Rectangle
from robotd.sim.buildings.world import load_world
from robotd.sim.physics.walls import WallSegments, clearance_m
from robotd.slam.changed_places import Change, ChangedPlace
from tests.studies.sessions.moving import moved
from tests.studies.sessions.trial import Found, Trial, _held_against

LABORATORY = load_world("laboratory")


@pytest.mark.parametrize("seed", range(3))
def test_a_share_of_the_furniture_is_moved_and_the_robot_still_fits_where_it_stops(seed: int) -> None:
    after, pieces = moved(LABORATORY, 0.15, seed)
    stay = [wall for wall in after.wall if wall in LABORATORY.wall]
    assert len(pieces) == round(0.15 * (len(LABORATORY.wall) - 1)) == len(LABORATORY.wall) - len(stay)
    assert {piece.after for piece in pieces} == set(after.wall) - set(stay)
    walls = WallSegments.of(segment for piece in pieces for segment in piece.after.segments())
    assert min(clearance_m(walls, stop_m) for stop_m in (*after.stops_m, *after.probes_m)) >= 0.5
    others = WallSegments.of(segment for wall in stay for segment in wall.segments())
    assert all(clearance_m(others, corner_m) > 0.04 for piece in pieces for corner_m in piece.after.points_m)


def test_more_than_fits_is_not_moved() -> None:
    with pytest.raises(ValueError, match="pieces could be moved"):
        moved(LABORATORY, 30.0, 0)


def test_a_piece_is_listed_where_it_stood_or_where_it_stands_and_what_is_elsewhere_is_counted() -> None:
    _, (one, *_) = moved(LABORATORY, 0.15, 0)
    (x_m, y_m), (to_x_m, to_y_m) = one.before.points_m[0], one.after.points_m[0]
    gone = ChangedPlace(Change.GONE, Rectangle(x_m - 0.05, y_m - 0.05, x_m + 0.1, y_m + 0.1), 5)
    came = ChangedPlace(Change.CAME, Rectangle(to_x_m - 0.05, to_y_m - 0.05, to_x_m + 0.1, to_y_m + 0.1), 5)
    elsewhere = ChangedPlace(Change.CAME, Rectangle(50.0, 50.0, 50.1, 50.1), 5)
    assert _held_against((gone, came, elsewhere), (one,)) == (1, 1)
    assert _held_against((elsewhere,), (one,)) == (0, 1)


def test_how_long_it_did_not_know_is_counted_over_both_days() -> None:
    first, later = (Found.RIGHT, Found.LOST), (Found.UNSURE, Found.UNSURE, Found.RIGHT, Found.LOST)
    trial = Trial(first, later, 1, 1, 0)
    assert trial.longest_unsure == 3
    assert trial.counts[Found.LOST] == 2


def test_lost_for_good_is_who_does_not_know_at_the_last_stops() -> None:
    lost = (Found.LOST, Found.UNSURE) * 3
    assert Trial((), (Found.RIGHT, *lost), 1, 1, 0).is_lost_for_good
    assert not Trial((), (*lost, Found.RIGHT), 1, 1, 0).is_lost_for_good
    assert not Trial(lost, lost[:5], 1, 1, 0).is_lost_for_good
