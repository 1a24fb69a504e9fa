"""``make exact`` draws all figures, and counts what the paper's lower bounds promise."""

from itertools import islice
from pathlib import Path

from matplotlib.image import imread

from tests.exact import growth
from tests.exact.figures import FIGURES
from tests.exact.run import main
from tests.exact.scenes import POSE, laboratory, readings


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


def test_the_laboratory_has_many_edges_and_readings_of_both_kinds() -> None:
    walls = laboratory()
    beams = readings(walls, POSE, 24)
    assert len(walls.borders) >= 60
    assert {beam.is_hit for beam in beams} == {True, False}
