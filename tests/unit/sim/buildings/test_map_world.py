"""A map to drive in: light ends where its wall cells begin, as a walk from cell to cell says."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from robotd.core.errors import ConfigError
from robotd.core.grid_spec import GridSpec
from robotd.grid.image import encode_pgm
from robotd.grid.occupancy import OccupancyGrid
from robotd.sim.buildings.map_world import borders_of, world_of
from robotd.sim.load import load_robot
from robotd.sim.physics.walls import WallSegments, ray_cast

SPEC = GridSpec(0.5, -1.0, 2.0, (12, 15))
YAML = b"image: m.pgm\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
maps = st.integers(0, 2**32 - 1).map(lambda seed: np.random.default_rng(seed).random(SPEC.shape) < 0.15)


def walked_m(occupied: NDArray[np.bool_], start: tuple[float, float], heading_rad: float) -> float:
    """Walk in steps of a tenth of a millimetre until a wall cell begins; ``inf`` beyond the map."""
    steps_m = np.arange(0.0, 12.0, 1e-4)
    points = np.stack((start[0] + steps_m * math.cos(heading_rad), start[1] + steps_m * math.sin(heading_rad)), axis=1)
    flat = SPEC.flat_at(points)
    met = np.flatnonzero((flat >= 0) & occupied.ravel()[np.maximum(flat, 0)])
    return float(steps_m[met[0]]) if len(met) else math.inf


@given(occupied=maps, place=st.tuples(st.integers(0, 11), st.integers(0, 14)), heading_rad=st.floats(0.01, 6.27))
@settings(deadline=None)
def test_light_ends_where_a_wall_cell_begins(
    occupied: NDArray[np.bool_], place: tuple[int, int], heading_rad: float
) -> None:
    occupied[place] = False
    walls = WallSegments.of((start, end, math.inf) for start, end in borders_of(occupied, SPEC))
    start = SPEC.centre_of(*place)
    assert ray_cast(walls, start, heading_rad) == pytest.approx(walked_m(occupied, start, heading_rad), abs=2e-4)


def test_straight_borders_are_one_segment() -> None:
    occupied = np.zeros(SPEC.shape, np.bool_)
    occupied[3:7, 2:12] = True
    assert len(borders_of(occupied, SPEC)) == 4


def test_the_robot_starts_at_the_most_open_place() -> None:
    cells = np.full((41, 41), 255, np.uint8)
    cells[5:12, 5:12] = 0
    cells[20:36, 10:36] = 0
    world = world_of("two rooms", OccupancyGrid(GridSpec(0.1, 0.0, 0.0, (41, 41)), cells))
    assert 2.6 <= world.start.y_m <= 3.0
    assert 1.6 <= world.start.x_m <= 3.0


def test_a_map_file_is_a_world(tmp_path: Path) -> None:
    cells = np.zeros((20, 20), np.uint8)
    cells[1:-1, 1:-1] = 254
    (tmp_path / "m.yaml").write_bytes(YAML)
    (tmp_path / "m.pgm").write_bytes(encode_pgm(cells))
    robot = load_robot(str(tmp_path / "m.yaml"))
    assert (robot.start.x_m, robot.start.y_m) == pytest.approx((5.0, 5.0), abs=0.5)


@pytest.mark.parametrize(
    ("text", "picture", "complaint"),
    [
        (b"image: gone.pgm" + YAML[12:], np.full((2, 2), 254, np.uint8), "gone.pgm: No such file or directory"),
        (YAML, np.zeros((2, 2), np.uint8), "it has no free cell: the robot can stand nowhere"),
        (YAML, np.full((2, 2), 254, np.uint8), "wall: a world needs at least one"),
        (YAML.replace(b"negate: 0\n", b""), np.full((2, 2), 254, np.uint8), "negate is missing; expected 0 or 1"),
    ],
)
def test_what_is_no_room_is_said(tmp_path: Path, text: bytes, picture: NDArray[np.uint8], complaint: str) -> None:
    (tmp_path / "m.yaml").write_bytes(text)
    (tmp_path / "m.pgm").write_bytes(encode_pgm(picture))
    with pytest.raises(ConfigError) as caught:
        load_robot(str(tmp_path / "m.yaml"))
    assert complaint in str(caught.value)
