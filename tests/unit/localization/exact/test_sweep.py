"""The plane sweep finds the arrangement that brute force finds, whatever meets whatever."""

from functools import partial

from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.localization.exact.arrangement import Arrangement
from robotd.localization.exact.locate import contains
from robotd.localization.exact.minkowski import grown
from robotd.localization.exact.pairwise import Part, parts, parts_of, vertices
from robotd.localization.exact.planar import PlanarSet
from robotd.localization.exact.points import Point
from robotd.localization.exact.polygons import solid
from robotd.localization.exact.sweep import arrange
from tests.unit.localization.exact.maps import polygons, radii
from tests.unit.localization.exact.shapes import planar_sets, points


def same(one: Part, other: Part) -> bool:
    masks = one.right, one.on, one.left
    return one.start == other.start and one.end == other.end and masks == (other.right, other.on, other.left)


@settings(max_examples=150, deadline=None)
@given(st.lists(planar_sets, max_size=5))
def test_it_agrees_with_brute_force(sets: list[PlanarSet]) -> None:
    expect_brute_force(sets)


grown_polygons = st.builds(lambda polygon, eps: grown(solid([polygon]), eps), polygons(), radii)


@settings(max_examples=40, deadline=None)
@given(st.lists(grown_polygons, min_size=2, max_size=2))
def test_it_agrees_with_brute_force_where_there_are_roots_under_roots(sets: list[PlanarSet]) -> None:
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
        for point in probes:
            assert contains(selected, point) == (sum(contains(planar, point) for planar in sets) >= least)


@settings(max_examples=40, deadline=None)
@given(st.lists(planar_sets, min_size=1, max_size=4))
def test_selecting_again_changes_nothing(sets: list[PlanarSet]) -> None:
    once = arrange(sets).select(bool)
    again = arrange([once]).select(bool)
    assert len(again.borders) == len(once.borders)
    assert len(again.spots) == len(once.spots)
    assert again.far == once.far
