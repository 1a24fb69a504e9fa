import itertools
import math
from pathlib import Path

import pytest

from robotd.core.errors import ConfigError
from robotd.sim.buildings.world import load_world, parse_world, world_names
from robotd.sim.physics.walls import Point, clearance_m, ray_cast

BOX = """\
name = "box"
start = { x_m = 1.0, y_m = 1.0, heading_deg = 90.0 }
stops_m = [[1.0, 2.0]]

[[wall]]
points_m = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]]

[[wall]]
name = "screen"
points_m = [[1.5, 1.5], [2.0, 1.5]]
closed = false
height_m = 1.2
"""


def test_a_world_is_read_as_written() -> None:
    world = parse_world(BOX, file="box.toml")
    assert world.start_pose.heading_rad == pytest.approx(math.pi / 2)
    assert world.stops_m == ((1.0, 2.0),)
    assert world.probes_m == ()
    assert world.walls.heights_m.tolist() == [math.inf] * 4 + [1.2]
    assert world.walls.along_m.sum(axis=0).tolist() == [0.5, 0.0]  # the box closes, the screen does not


@pytest.mark.parametrize(
    ("wrong", "right", "line", "message"),
    [
        ("stop_m", "stops_m", 3, "stop_m: unknown key; did you mean stops_m?"),
        ("x_mm", "x_m", 2, "start.x_mm: unknown key; did you mean x_m?"),
        ("height", "height_m", 12, "wall[1].height: unknown key; did you mean height_m?"),
        ('"high"', "1.2", 12, "wall[1].height_m: Expected `float`, got `str`"),
        ("-1.2", "1.2", 8, "wall[1]: height_m must be positive, got -1.2"),
        ("[[1.5, 1.5]]", "[[1.5, 1.5], [2.0, 1.5]]", 8, "wall[1]: points_m must name at least 2 corners, got 1"),
        ("[1.0]", "[1.0, 2.0]", 3, "stops_m[0]: Expected `array` of length 2, got 1"),
        ("nmae", "name", 1, "nmae: unknown key; did you mean name?"),
        ("= =", "= {", 2, "Invalid value (at line 2, column 9)"),
    ],
)
def test_every_mistake_is_named_with_file_line_and_key(wrong: str, right: str, line: int, message: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_world(BOX.replace(right, wrong, 1), file="box.toml")
    assert str(caught.value) == f"box.toml:{line}: {message}"


def test_a_world_without_walls_is_refused() -> None:
    with pytest.raises(ConfigError, match="wall"):
        parse_world(BOX.split("[[wall]]", maxsplit=1)[0] + "wall = []\n", file="box.toml")


def test_a_missing_key_is_named() -> None:
    with pytest.raises(ConfigError, match="start"):
        parse_world('name = "box"\n[[wall]]\npoints_m = [[0.0, 0.0], [1.0, 0.0]]\n', file="box.toml")


def test_a_name_that_is_neither_world_nor_file_is_answered_with_the_known_worlds() -> None:
    with pytest.raises(ConfigError, match="laboratory"):
        load_world("labratory")


def test_a_file_of_ones_own_is_loaded_by_its_path(tmp_path: Path) -> None:
    path = tmp_path / "box.toml"
    path.write_text(BOX)
    assert load_world(str(path)).name == "box"


def test_the_four_rooms_are_there() -> None:
    assert world_names() == ("corridor", "laboratory", "office", "symmetric")


@pytest.mark.parametrize("name", world_names())
def test_a_robot_can_go_the_whole_tour_in_straight_lines(name: str) -> None:
    world = load_world(name)
    assert world.name == name
    tour = [(world.start.x_m, world.start.y_m), *world.stops_m]
    for start, end in itertools.pairwise(tour):
        assert min(clearance_m(world.walls, point) for point in between(start, end)) > 0.45
    for probe in world.probes_m:
        assert clearance_m(world.walls, probe) > 0.45
        assert min(math.dist(probe, stop) for stop in tour) > 0.3


def between(start: Point, end: Point) -> list[Point]:
    shares = [index / 50 for index in range(51)]
    return [(start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])) for share in shares]


def test_the_two_rooms_of_the_symmetric_world_look_the_same_until_one_leaves_them() -> None:
    world = load_world("symmetric")
    left, right = world.probes_m
    assert (right[0] - left[0], right[1]) == (5.0, left[1])

    def views(point: Point) -> list[float]:
        return [ray_cast(world.walls, point, math.tau * index / 300) for index in range(300)]

    assert views(left) == pytest.approx(views(right), abs=1e-9)
    assert views((2.4, 0.9)) != pytest.approx(views((7.4, 0.9)), abs=0.5)
