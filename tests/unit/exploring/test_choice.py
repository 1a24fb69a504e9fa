"""Where to stop next: what counts, what is never tried twice, and that it ends."""

import math
from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from robotd.core.pose import Pose2
from robotd.core.rectangle import Rectangle
from robotd.exploring.choice import Choice, ChoiceQuestion, choose
from robotd.exploring.reasons import WhyEnded, WhyLeft
from robotd.exploring.settings import ExploringSettings, Pace
from robotd.exploring.tried import Tried
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION
from tests.unit.exploring.maps import ROBOT, at, drawn, grid_of, question

ROOM = (
    "##########",
    "#........#",
    "#........ ",
    "#........ ",
    "#........ ",
    "#........#",
    "##########",
)
"""A room with a door in its east."""


def chosen(grid: OccupancyGrid, asked: ChoiceQuestion, settings: ExploringSettings | None = None) -> Choice:
    return choose(grid, np.zeros(grid.spec.shape, np.bool_), asked, ROBOT, settings)


def test_it_goes_where_the_door_is_seen_and_says_what_it_expects() -> None:
    choice = chosen(drawn(*ROOM), question(at(2, 2)))
    assert choice.ending is None
    best = choice.candidates[0]
    assert choice.goal_m == best.at_m
    assert best.opening_m >= 0.6
    assert best.area_m2 > 0.0
    others = [one.score for one in choice.candidates[1:]]
    assert others == sorted(others, reverse=True)
    assert choice.tour_m[0] == choice.goal_m
    assert all(one.overlap >= 0.4 for one in choice.candidates)
    assert [left.why for left in choice.left] == [WhyLeft.HIDDEN]


def test_the_same_question_has_the_same_answer() -> None:
    asked = question(at(2, 2))
    assert chosen(drawn(*ROOM), asked) == chosen(drawn(*ROOM), asked)


def test_a_closed_room_is_complete() -> None:
    choice = chosen(drawn(*(line.replace(" ", "#") for line in ROOM)), question(at(2, 2)))
    assert (choice.ending, choice.left, choice.goal_m) == (WhyEnded.COMPLETE, (), None)


def test_bounds_leave_what_lies_beyond_alone() -> None:
    inner = replace(question(at(2, 2)), within=Rectangle(0.0, 0.0, 2.7, 2.1))
    assert chosen(drawn(*ROOM), inner).ending is WhyEnded.COMPLETE


def test_what_was_tried_in_vain_is_left_and_said() -> None:
    asked = question(at(2, 2))
    tried = Tried()
    all_counts = ExploringSettings(good_enough=0.0)
    while (choice := chosen(drawn(*ROOM), replace(asked, tried=tried), all_counts)).goal_m is not None:
        assert all(math.dist(choice.goal_m, place_m) > 0.3 for place_m in tried.in_vain_m)
        tried = Tried((*tried.in_vain_m, choice.goal_m))
    assert choice.ending is WhyEnded.UNREACHABLE
    assert [left.why for left in choice.left] == [WhyLeft.IN_VAIN]


def test_where_a_stop_was_made_none_is_made_again() -> None:
    first = chosen(drawn(*ROOM), question(at(2, 2))).goal_m
    assert first is not None
    second = chosen(drawn(*ROOM), question(at(2, 2), stops_m=(first,))).goal_m
    assert second is not None
    assert math.dist(first, second) > 0.3


def test_ground_behind_a_gap_too_narrow_to_drive_is_named() -> None:
    grid = drawn(
        "#########",
        "#...#... ",
        "#....... ",
        "#...#... ",
        "#########",
    )
    cells = grid.cells.copy()
    cells[6:8, 12:15] = 250  # of the door of 0.3 m only 0.1 m is left
    choice = chosen(grid_of(cells), question(at(2, 2)))
    everywhere = [(0.05 + 0.1 * x, 0.05 + 0.1 * y) for x in range(27) for y in range(15)]
    end = chosen(grid_of(cells), question(at(2, 2), Tried(tuple(everywhere))))
    assert all(one.at_m[0] < 1.2 for one in choice.candidates)
    assert end.ending in {WhyEnded.UNREACHABLE, WhyEnded.COMPLETE}
    assert all(left.why is WhyLeft.NO_WAY for left in end.left)


def test_next_to_nothing_is_enough() -> None:
    lines = [*ROOM]
    closed = drawn(*(line.replace(" ", "#") for line in lines)).cells.copy()
    closed[5:16, 15:19] = NO_INFORMATION  # a box that nobody saw behind
    asked = question(at(2, 2))
    assert chosen(grid_of(closed), asked).ending is None
    assert chosen(grid_of(closed), asked, ExploringSettings(good_enough=0.2)).ending is WhyEnded.GOOD_ENOUGH


def test_lone_hits_are_doubted_only_where_nothing_else_is_left() -> None:
    grid = drawn(
        "############",
        "#....#..... ",
        "#.......... ",
        "#....#..... ",
        "############",
    )
    cells = grid.cells.copy()
    cells[7, 16] = 166  # one hit in the door
    blocked = chosen(grid_of(cells), question(at(2, 2)))
    assert blocked.ending is None
    assert all(one.area_m2 > 0.0 for one in blocked.candidates)


def test_what_was_met_is_an_obstacle_whatever_the_map_says() -> None:
    grid = drawn(*ROOM)
    hit = np.zeros(grid.spec.shape, np.bool_)
    hit[3:18, 12] = True
    choice = choose(grid, hit, question(at(1, 2)), ROBOT)
    assert all(one.at_m[0] < 1.1 for one in choice.candidates)


@st.composite
def worlds(draw: st.DrawFn) -> tuple[OccupancyGrid, OccupancyGrid]:
    """Return a random world, and what is known of it at first: a spot about where the robot stands."""
    letters = np.array(draw(st.lists(st.sampled_from("....#"), min_size=64, max_size=64))).reshape(8, 8)
    letters[3:5, 3:5] = "."
    world = drawn(*("".join(row) for row in letters))
    cells = np.full_like(world.cells, NO_INFORMATION)
    cells[8:16, 8:16] = world.cells[8:16, 8:16]
    return world, grid_of(cells)


@given(worlds=worlds(), blind=st.booleans(), refuses=st.integers(0, 3))
def test_exploring_ends_whatever_is_seen_and_whatever_is_reached(
    worlds: tuple[OccupancyGrid, OccupancyGrid], blind: bool, refuses: int
) -> None:
    """Each choice is a place 0.3 m from all before it, so there are no more than fit; blind, a stop shows nothing."""
    world, known = worlds
    stops_m: tuple[tuple[float, float], ...] = (at(3, 3),)
    tried, here = Tried(), at(3, 3)
    for count in range(100):
        choice = chosen(known, ChoiceQuestion(Pose2(*here, 0.0), stops_m, tried, None, 1.0, Pace()))
        if choice.goal_m is None:
            assert choice.ending is not None
            return
        assert all(math.dist(choice.goal_m, place_m) > 0.3 for place_m in (*stops_m, *tried.in_vain_m))
        if refuses and count % (refuses + 1) == 0:
            tried = Tried((*tried.in_vain_m, choice.goal_m))
            continue
        here, stops_m = choice.goal_m, (*stops_m, choice.goal_m)
        if not blind:
            known = _seen(world, known, here)
    raise AssertionError("it does not end")


def _seen(world: OccupancyGrid, known: OccupancyGrid, from_m: tuple[float, float]) -> OccupancyGrid:
    """Show all cells within a metre: more than any sweep would."""
    rows, cols = np.ogrid[: world.spec.rows, : world.spec.cols]
    row, col = world.spec.cell_at(*from_m)
    near = (rows - row) ** 2 + (cols - col) ** 2 <= 100
    return grid_of(np.where(near, world.cells, known.cells))
