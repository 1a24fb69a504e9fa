"""A few places of the study: the level beam passes over a crate, and a layer at another tilt does not."""

import pytest

from robotd.contract.estimate import PoseState
from robotd.grid.tables import NO_INFORMATION
from robotd.sim.buildings.world import Wall
from tests.studies.height.mapped import Mapped, places_in
from tests.studies.height.run import CRATE, DOWN, furnished, told_apart_by_a_crate


@pytest.fixture(scope="module")
def mapped() -> Mapped:
    return Mapped.of(told_apart_by_a_crate(), 2.1, (DOWN,))


def test_a_crate_is_an_obstacle_that_the_level_beam_does_not_see(mapped: Mapped) -> None:
    held = mapped.desk.map(mapped.map)
    (first_row, first_col), (last_row, last_col) = (held.grid.spec.cell_at(*CRATE.points_m[at]) for at in (0, 2))
    crate = slice(first_row - 1, last_row + 2), slice(first_col - 1, last_col + 2)
    # Its sides alone are seen from the stops, and of its top what they see from above.
    assert (held.grid.cells[crate] > NO_INFORMATION).mean() < 0.01
    assert held.obstacles()[crate].mean() > 0.05


def test_of_two_equal_rooms_a_crate_tells_which_it_is(mapped: Mapped) -> None:
    in_left_room = [pose for pose in places_in(mapped.world, 12) if pose.x_m < 4.5 and pose.y_m > 2.5]
    found = [(truth, mapped.located(truth, f"look {number}")) for number, truth in enumerate(in_left_room)]
    assert {len(estimate.layers) for _, estimate in found} == {1}
    assert PoseState.LOCALIZED in {estimate.state for _, estimate in found}
    assert all(estimate.best is None or estimate.best.distance_m(truth) < 0.3 for truth, estimate in found)


def test_robots_stand_free_of_tables_and_of_what_is_lower_than_the_beam() -> None:
    world = furnished()
    _room, *things = world.wall
    places = list(places_in(world, 20))
    assert not any(_spans(thing, pose.x_m, pose.y_m) for thing in things for pose in places)


def _spans(thing: Wall, x_m: float, y_m: float) -> bool:
    xs_m, ys_m = [x_m for x_m, _ in thing.points_m], [y_m for _, y_m in thing.points_m]
    return min(xs_m) <= x_m <= max(xs_m) and min(ys_m) <= y_m <= max(ys_m)
