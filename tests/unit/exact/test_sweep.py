"""The plane sweep finds the arrangement that brute force finds, whatever meets whatever."""

from functools import partial

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.exact.arrangement import Arrangement
from robotd.exact.locate import contains
from robotd.exact.minkowski import grown
from robotd.exact.pairwise import Part, parts, parts_of, vertices
from robotd.exact.planar import PlanarSet, disk, segment
from robotd.exact.points import Point
from robotd.exact.polygons import solid
from robotd.exact.rationals import rational
from robotd.exact.sweep import arrange
from tests.unit.exact.maps import polygons, radii
from tests.unit.exact.shapes import planar_sets, point, points


def same(one: Part, other: Part) -> bool:
    masks = one.right, one.on, one.left
    return one.start == other.start and one.end == other.end and masks == (other.right, other.on, other.left)


@settings(max_examples=150, deadline=None)
@given(st.lists(planar_sets, max_size=5))
def test_it_agrees_with_brute_force(sets: list[PlanarSet]) -> None:
    expect_brute_force(sets)


def circle(x: int, y: int, radius: int, *, closed: bool = True) -> PlanarSet:
    return disk(point(x, y), rational(radius), closed=closed)


def line(start: tuple[int, int], end: tuple[int, int]) -> PlanarSet:
    return PlanarSet((segment(point(*start), point(*end), on=True, left=False, right=False),))


grown_polygons = st.builds(lambda polygon, eps: grown(solid([polygon]), eps), polygons(), radii)


@settings(max_examples=40, deadline=None)
@given(st.lists(grown_polygons, min_size=2, max_size=2))
def test_it_agrees_with_brute_force_where_there_are_roots_under_roots(sets: list[PlanarSet]) -> None:
    expect_brute_force(sets)


@pytest.mark.parametrize(
    "sets",
    [
        [circle(0, 0, 2), circle(0, 0, 2)],
        [circle(0, 0, 2), circle(1, 0, 1)],
        [circle(0, 0, 2), circle(3, 0, 1), circle(0, 3, 1)],
        [circle(0, 0, 2), line((-3, 2), (3, 2)), line((2, -3), (2, 3))],
        [circle(0, 0, 2), circle(0, 0, 2, closed=False), circle(0, 2, 2), line((-2, 0), (2, 0)), line((-1, 0), (5, 0))],
        [line((-2, y), (2, -y)) for y in (-2, -1, 0, 1, 2)]
        + [line((0, -2), (0, 2)), circle(1, 0, 1), circle(-1, 0, 1)],
    ],
    ids=[
        "coincident arcs",
        "tangent within",
        "tangent outside",
        "tangent to lines",
        "all of that",
        "through one point",
    ],
)
def test_degenerate_curves_are_cut_as_by_brute_force(sets: list[PlanarSet]) -> None:
    expect_brute_force(sets)


def expect_brute_force(sets: list[PlanarSet]) -> None:
    arrangement = arrange(sets)
    found = [(vertex.point, vertex.mask) for vertex in arrangement.vertices]
    assert found == vertices(sets)
    swept, forced = parts_of(arrangement), parts(sets)
    assert len(swept) == len(forced)
    assert all(any(same(one, other) for other in forced) for one in swept)
    assert len(arrangement.faces) == faces_by_euler(arrangement)


def covered(least: int, mask: int) -> bool:
    return mask.bit_count() >= least


def faces_by_euler(arrangement: Arrangement) -> int:
    """Return F of V - E + F = 1 + C."""
    roots = list(range(len(arrangement.vertices)))

    def root(of: int) -> int:
        while roots[of] != of:
            of = roots[of]
        return of

    for edge in arrangement.edges:
        roots[root(edge.start)] = root(edge.end)
    components = sum(root(vertex) == vertex for vertex in range(len(roots)))
    return 1 + components - len(arrangement.vertices) + len(arrangement.edges)


@settings(max_examples=60, deadline=None)
@given(st.lists(planar_sets, min_size=2, max_size=4), st.lists(points, min_size=1, max_size=5))
def test_a_selection_contains_what_its_condition_says(sets: list[PlanarSet], probes: list[Point]) -> None:
    arrangement = arrange(sets)
    probes += [vertex.point for vertex in arrangement.vertices]
    for least in (1, len(sets)):
        selected = arrangement.select(partial(covered, least))
        for at in probes:
            assert contains(selected, at) == (sum(contains(planar, at) for planar in sets) >= least)


@settings(max_examples=40, deadline=None)
@given(st.lists(planar_sets, min_size=1, max_size=4))
def test_selecting_again_changes_nothing(sets: list[PlanarSet]) -> None:
    once = arrange(sets).select(bool)
    again = arrange([once]).select(bool)
    assert len(again.borders) == len(once.borders)
    assert len(again.spots) == len(once.spots)
    assert again.far == once.far
