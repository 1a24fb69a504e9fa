"""``make exact`` draws all figures, and counts what the paper's lower bounds promise."""

import math
from itertools import islice
from pathlib import Path

import pytest
from matplotlib.image import imread

from robotd.exact.feasible import PolygonMap
from robotd.exact.planar import PlanarSet, segment
from robotd.exact.points import Point
from robotd.exact.rationals import rational
from robotd.exact.sweep import arrange
from tests.studies.exact import growth
from tests.studies.exact.figures import FIGURES
from tests.studies.exact.operations import counted
from tests.studies.exact.run import main
from tests.studies.exact.scenes import laboratory, readings, scattered


def test_every_figure_is_drawn(tmp_path: Path) -> None:
    assert main(["--figures-only", "--out", str(tmp_path)]) == 0
    for figure in FIGURES:
        pixels = imread(tmp_path / f"{figure.name}.png")
        assert (pixels[..., :3].max(axis=2) < 0.9).any(), f"{figure.name} is not empty"


def test_feasible_poses_have_of_the_order_of_n_squared_pieces() -> None:
    # b bars each way leave (b + 1)^2 gaps, and one of them is too near to a corner of the map.
    assert [pieces for _, pieces, _ in islice(growth.lemma_2_pieces(), 3)] == [2**2 - 1, 3**2 - 1, 5**2 - 1]


def test_feasible_poses_cross_in_of_the_order_of_m_squared_points() -> None:
    assert [count for _, count, _ in islice(growth.lemma_2_crossings(), 3)] == [1, 6, 28]


def test_both_together_grow_with_the_square_of_both() -> None:
    few, _, more_readings, more_edges = islice(growth.lemma_2(), 4)
    # b bars each way leave (b + 1)^2 gaps, in all but one of which every two of m readings cross.
    assert [row[4] for row in (few, more_readings, more_edges)] == [8 * 1, 8 * 28, 24 * 28]
    assert more_readings[2] == 4 * few[2]
    assert more_edges[2] > 2.5 * more_readings[2]


def test_the_laboratory_has_many_edges_and_readings_of_both_kinds() -> None:
    walls, pose = laboratory()
    beams = readings(walls, pose, 24)
    assert len(walls.borders) >= 60
    assert {beam.is_hit for beam in beams} == {True, False}


@pytest.mark.parametrize("eps", ["0", "0.05"])
def test_a_sweep_asks_of_the_order_of_n_plus_s_times_log_n_predicates(eps: str) -> None:
    asked = []
    for edges in (12, 48, 192):
        walls, pose = scattered(edges, seed=edges)
        row = growth.grown_by(PolygonMap(walls, rational(eps)), readings(walls, pose, 1), eps, overlay=False)
        asked.append(row.predicates / row.work)
    assert max(asked) < 5.0
    assert asked[2] < 1.15 * asked[0], "a square would grow sixteenfold"


def crossed(count: int) -> list[PlanarSet]:
    """Return segments from west to east and from south to north, every two of which cross apart from others."""
    sets = []
    for number in range(count):
        low, high = rational(number), count - 1 - number + rational(number) / 97
        for ends in (((0, low), (count, high)), ((low, 0), (high, count))):
            start, end = (Point(rational(x), rational(y)) for x, y in ends)
            sets.append(PlanarSet((segment(start, end, on=True, left=False, right=False),)))
    return sets


def test_crossings_as_many_as_the_square_of_the_borders_are_paid_for_once_each() -> None:
    asked = []
    for count in (6, 12, 24):
        with counted() as operations:
            crossings = growth.crossings_of(arrange(crossed(count)))
        assert crossings > count * count
        asked.append(operations.all_of_them / ((2 * count + crossings) * math.log2(2 * count)))
    assert max(asked) < 9.0
    assert asked == sorted(asked, reverse=True)
