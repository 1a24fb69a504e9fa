"""One of the paper's tests, small and whole: the page that is kept says what the code says."""

import math
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from robotd.core.pose import Pose2
from robotd.grid.binary import BinaryMap
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.ready_map import ReadyMap
from robotd.localization.reference.feasible_poses import feasible_poses
from robotd.localization.reference.probe import probe_of
from tests.studies.paper.figures import FIGURES, draw_figures
from tests.studies.paper.page import table
from tests.studies.paper.page import test_row as row_of
from tests.studies.paper.pictures import draw_panels, draw_test
from tests.studies.paper.poses_figures import at_the_robot, rank_here, seen
from tests.studies.paper.robot import Tour, probes_at, tour_of
from tests.studies.paper.rooms import OFFICE, TESTS
from tests.studies.paper.run import ROOT, SEEDS
from tests.studies.paper.trials import COUNTED, ERROR_M, OURS, PAPERS, Manner, outcome_of

PAGE = ROOT / "docs" / "paper" / "README.md"
FIRST = TESTS[0]


@pytest.fixture(scope="module")
def tour() -> Tour:
    return tour_of(OFFICE.world, OFFICE.stops_m, SEEDS[0])


@pytest.mark.slow
@pytest.mark.parametrize("manner", [PAPERS, COUNTED], ids=["paper", "counted"])
def test_the_page_has_the_row_that_this_code_measures(tour: Tour, manner: Manner) -> None:
    pose = FIRST.pose_on(tour.map_by(PAPERS.grid, OFFICE.spec))
    readings = probes_at(OFFICE.world, pose, FIRST.probes, SEEDS[0])
    the_map = ReadyMap.of(tour.map_by(manner.grid, OFFICE.spec), manner.localization)
    outcome = outcome_of(manner, the_map, readings, pose)
    assert outcome.nearest_off_m < 0.2
    assert table((), [row_of(FIRST, outcome)]).splitlines()[-1] in PAGE.read_text(encoding="utf-8")


@pytest.mark.slow
def test_what_is_drawn_is_the_sum_of_the_feasible_poses_as_the_paper_defines_them(tour: Tour, tmp_path: Path) -> None:
    grid = tour.map_by(PAPERS.grid, OFFICE.spec)
    pose = FIRST.pose_on(grid)
    readings = probes_at(OFFICE.world, pose, FIRST.probes, 7)
    outcome = outcome_of(PAPERS, ReadyMap.of(grid, PAPERS.localization), readings, pose)
    resolution_m = grid.spec.resolution_m
    obstacles = Obstacles.of(BinaryMap.from_grid(grid).occupied, ERROR_M / resolution_m)
    rank = np.zeros(grid.spec.shape, np.int64)
    for reading in PAPERS.counted(readings):
        probe = probe_of(
            reading,
            pose.heading_rad,
            resolution_m=resolution_m,
            error_radius_cells=ERROR_M / resolution_m,
            reach_cells=512,
        )
        rank += feasible_poses(obstacles, probe)
    assert np.array_equal(outcome.rank, rank)
    draw_test(tmp_path / "test.png", FIRST, pose, grid, outcome, PAPERS.counted(readings))
    assert (tmp_path / "test.png").stat().st_size > 10_000


@pytest.mark.slow
def test_as_the_product_is_set_the_answer_counts_and_none_is_infinitely_far(tour: Tour) -> None:
    grid = tour.map_by(OURS.grid, OFFICE.spec)
    pose, the_map = next(OFFICE.poses(5)), ReadyMap.of(grid, OURS.localization)
    found = outcome_of(OURS, the_map, probes_at(OFFICE.world, pose, 24, 5), pose)
    assert found.largest_off_m < 0.1
    assert found.within_robot == 1.0
    nothing = outcome_of(OURS, the_map, probes_at(OFFICE.world, pose, 4, 5), pose)
    assert (nothing.largest_off_m, nothing.cells, nothing.within_robot) == (math.inf, 0, 0.0)


def test_a_new_obstacle_takes_three_of_twelve_readings_and_leaves_the_robot_the_best_pose() -> None:
    for with_new, explained in ((False, 12), (True, 9)):
        ranks = rank_here(seen(with_new=with_new))
        assert ranks[at_the_robot()] == ranks.max() == explained


def beyond_its_picture(figure: Figure) -> list[str]:
    """Return the titles and captions that do not fit: those the edge cuts, and those that run into the next panel."""
    figure.draw_without_rendering()
    found = []
    for axes in figure.axes:
        caption, panel = axes.xaxis.label.get_window_extent(), axes.get_window_extent()
        left, right = (panel.x0, panel.x1) if len(figure.axes) > 1 else (0.0, figure.bbox.width)
        if caption.x0 < left or caption.x1 > right or caption.y0 < 0.0:
            found.append(axes.get_xlabel())
    title = figure.texts[0].get_window_extent()
    if title.x0 < 0.0 or title.x1 > figure.bbox.width or title.y1 > figure.bbox.height:
        found.append(figure.texts[0].get_text())
    return found


def test_no_title_or_caption_is_cut(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
    draw_figures(tmp_path)
    for test in TESTS:
        caption = f"(c) localization; black: {test.probes} of {test.probes} readings consistent"
        exact = f"(d) exact, on the true walls; black: {test.probes} of {test.probes}"
        panels = ((caption, lambda _: None), (exact, lambda _: None)) * 2
        title = f"Test {test.number}: {test.room.name}, {test.probes} probes"
        draw_panels(tmp_path / "test.png", title, test.room, Pose2(0.0, 0.0, 0.0), panels)
    assert len(drawn) == len(FIGURES) + len(TESTS)
    assert [text for figure in drawn for text in beyond_its_picture(figure)] == []


def test_every_test_and_figure_has_its_picture_on_the_page(tmp_path: Path) -> None:
    draw_figures(tmp_path)
    drawn = {path.name for path in tmp_path.glob("*.png")} | {f"test-{test.number}.png" for test in TESTS}
    assert {path.stem for path in tmp_path.glob("*.png")} == set(FIGURES)
    assert drawn == {path.name for path in PAGE.parent.glob("*.png")}
    assert sum(path.stat().st_size for path in PAGE.parent.glob("*")) < 1_500_000
