"""Pictures are to scale, are cropped to what is known, and show what they were given."""

import io
import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread
from rich.console import Console

from robotd.cli.demo.before_and_after import draw_before_and_after
from robotd.cli.pictures.maps_in_the_making import draw_explored
from robotd.cli.pictures.rooms import Mark, draw_localization, draw_map, draw_room
from robotd.cli.pictures.sheet import bar_length_m, known_box
from robotd.contract.explored import LeftOpen
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.logs.carmen import parse_carmen
from tests.support.carmen_room import POSES, flaser

SPEC = GridSpec(0.1, -1.0, -2.0, (60, 40))


def test_a_map_is_cropped_to_what_is_known() -> None:
    occupancy = np.full(SPEC.shape, 128, np.uint8)
    occupancy[10:21, 5:8] = 0
    assert known_box(SPEC, occupancy, margin_m=0.0) == pytest.approx((-0.5, -1.0, -0.2, 0.1))


def test_a_map_of_which_nothing_is_known_is_shown_whole() -> None:
    assert known_box(SPEC, np.full(SPEC.shape, 128, np.uint8), margin_m=0.0) == pytest.approx((-1.0, -2.0, 3.0, 4.0))


@pytest.mark.parametrize("width_m", [0.5, 3.0, 4.0, 9.0, 17.0, 28.0, 160.0])
def test_the_bar_is_round_and_about_a_fifth_of_the_width(width_m: float) -> None:
    length = bar_length_m(width_m)
    assert float(f"{length:e}".partition("e")[0]) in {1.0, 2.0, 5.0}
    assert 0.1 <= length / width_m <= 0.4


def test_a_map_is_light_where_free_and_dark_where_occupied(tmp_path: Path) -> None:
    shades = []
    for value in (0, 128, 255):
        occupancy = np.full(SPEC.shape, value, np.uint8)
        draw_map(tmp_path / "map.png", "A map", SPEC, occupancy, stops_m=[(0.0, 0.0)])
        pixels = imread(tmp_path / "map.png")
        height, width = pixels.shape[:2]
        shades.append(float(pixels[height // 3, width // 2, :3].mean()))
    assert shades[0] > 0.98
    assert 0.6 < shades[1] < 0.9
    assert shades[2] < 0.02


def test_a_room_and_a_localization_are_drawn_with_their_marks(tmp_path: Path) -> None:
    walls = [np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0], [0.0, 4.0]]), np.array([[1.0, 1.0], [2.0, 1.0], [2.0, 2.0]])]
    draw_room(tmp_path / "deep" / "room.png", "A room", walls, stops_m=[(0.5, 0.5), (2.5, 3.0)], robot_radius_m=0.2)
    rank = np.zeros(SPEC.shape, np.uint16)
    rank[30, 20] = 250
    bare, marked = tmp_path / "bare.png", tmp_path / "marked.png"
    walls_seen = np.zeros(SPEC.shape, np.bool_)
    walls_seen[0, :] = walls_seen[-1, :] = True
    draw_localization(bare, "Where", SPEC, rank, obstacles=walls_seen)
    truth = Mark(Pose2(1.0, 1.0, 0.5), 0.25)
    draw_localization(marked, "Where", SPEC, rank, obstacles=walls_seen, truth=truth, estimate=Pose2(1.1, 1.0, 0.5))
    red = [count_red(imread(file)) for file in (bare, marked)]
    assert (tmp_path / "deep" / "room.png").stat().st_size > 5000
    assert red[0] == 0
    assert red[1] > 200


def count_red(pixels: np.ndarray) -> int:
    return int(((pixels[..., 0] > 0.7) & (pixels[..., 1] < 0.2) & (pixels[..., 2] < 0.3)).sum())


def test_a_map_that_was_explored_shows_what_is_left_open(tmp_path: Path) -> None:
    occupancy = np.full(SPEC.shape, 255, np.uint8)
    occupancy[10:50, 5:35] = 0
    whole, open_ = tmp_path / "whole.png", tmp_path / "open.png"
    stops_m, way_m = [(0.0, 0.0), (1.0, 1.0)], np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    left = LeftOpen(2.0, 2.0, 1.2, "no_way")
    draw_explored(whole, "A map", SPEC, occupancy, stops_m=stops_m, way_m=way_m, left=())
    draw_explored(open_, "A map", SPEC, occupancy, stops_m=stops_m, way_m=way_m, left=(left,))
    assert [count_red(imread(file)) > 200 for file in (whole, open_)] == [False, True]


def test_a_log_is_drawn_before_and_after_it_was_mapped_from_its_odometry(tmp_path: Path) -> None:
    log = parse_carmen(flaser(poses=[*POSES, *reversed(POSES)]))
    said = Console(record=True, width=120, file=io.StringIO())
    draw_before_and_after(said, tmp_path, log)
    assert re.search(r"\d+ stops over \d+ m, 0 loops closed; stops moved by up to 0\.\d m", said.export_text())
    assert all((tmp_path / name).stat().st_size > 10_000 for name in ("odometry.png", "survey.png"))
