"""Pictures are to scale, are cropped to what is known, and show what they were given."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from robotd.cli.pictures.rooms import Mark, draw_localization, draw_map, draw_room
from robotd.cli.pictures.sheet import bar_length_m, known_box
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2

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
