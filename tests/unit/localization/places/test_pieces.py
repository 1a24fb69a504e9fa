"""Connected regions against a flood from cell to cell."""

import math
from dataclasses import astuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.contract.estimate import Cover, Region
from robotd.core.grid_spec import GridSpec
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.pose_set import PoseSet
from robotd.grid.readings import Readings
from robotd.localization.count.rank_grid import RankGrid
from robotd.localization.describe import Situation, described
from robotd.localization.even_headings import even_headings
from robotd.localization.fit.refinement_settings import RefinementSettings
from robotd.localization.judged_regions import JudgedRegion
from robotd.localization.obstacles.error_radius import ErrorRadius
from robotd.localization.obstacles.prepared_map import PreparedMap
from robotd.localization.places.pieces import connected_components, pieces_of
from robotd.localization.places.shapes import cover_of
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings

cubes = hnp.arrays(np.bool_, hnp.array_shapes(min_dims=3, max_dims=3, max_side=7))


def slow_components(poses: list[tuple[int, int, int]], headings: int, wrap: bool) -> list[int]:
    """Flood from each pose not yet labelled."""
    labels: dict[tuple[int, int, int], int] = {}
    for number, seed in enumerate(poses):
        queue = [seed] if seed not in labels else []
        while queue:
            pose = queue.pop()
            if pose in labels:
                continue
            labels[pose] = number
            for step in np.ndindex(3, 3, 3):
                heading = pose[0] + step[0] - 1
                near = (heading % headings if wrap else heading, pose[1] + step[1] - 1, pose[2] + step[2] - 1)
                if near in poses:
                    queue.append(near)
    numbers = sorted({labels[pose] for pose in poses})
    return [numbers.index(labels[pose]) for pose in poses]


@settings(max_examples=150)
@given(cubes, st.booleans())
def test_components_are_what_a_flood_reaches(cube: NDArray[np.bool_], wrap: bool) -> None:
    poses = np.argwhere(cube)
    if len(poses) == 0:
        return
    wrap = wrap and cube.shape[0] > 2
    labels = connected_components(poses, headings=cube.shape[0], wrap=wrap)
    assert labels.tolist() == slow_components([(h, r, c) for h, r, c in poses.tolist()], cube.shape[0], wrap)


def test_a_spiral_is_one_region() -> None:
    """Long chains of links are what a careless union-find gets wrong or slow."""
    side = 41
    spiral = np.zeros((side, side), np.bool_)
    row, col, step = 0, 0, (0, 1)
    spiral[0, 0] = True
    for length in [side - 1, *(n for n in range(side - 1, 0, -2) for _ in range(2))]:
        for _ in range(length):
            row, col = row + step[0], col + step[1]
            spiral[row, col] = True
        step = (step[1], -step[0])
    assert (connected_components(np.argwhere(spiral[None]), headings=1, wrap=False) == 0).all()


def two_rooms() -> PreparedMap:
    return ready_rooms().prepared.maps[0]


def ready_rooms() -> ReadyMap:
    """Two equal rooms of 4 x 5 cells of 0.5 m, with a wall between."""
    occupied = np.ones((6, 13), np.bool_)
    occupied[1:5, 1:6] = False
    occupied[1:5, 7:12] = False
    grid = OccupancyGrid(GridSpec(0.5, -1.0, 0.0, (6, 13)), np.where(occupied, np.uint8(255), np.uint8(0)))
    return ReadyMap.of(grid, LocalizationSettings(error_radius=ErrorRadius.CONSTANT, range_error_m=0.0, blocked_by=1))


def regions_of(ranks: RankGrid, least_rank: int, most: int = 99) -> tuple[Region, ...]:
    poses = ranks.cells_of_rank(least_rank)
    found = PoseSet(poses, ranks.rank_at(poses), ranks.best_rank, least_rank)
    pieces = pieces_of(found, ranks.headings_rad, most)
    rooms = ready_rooms()
    walls = rooms.meanings[0].walls
    situation = Situation(rooms, walls, ranks.headings_rad, Readings.none(), RefinementSettings())
    return described([JudgedRegion(piece) for piece in pieces.best], situation)


def test_every_region_is_told_with_its_place_and_extent() -> None:
    ranks = RankGrid(two_rooms(), [0.0])
    ranks.add(Readings.of((RangeReading(0, 0.0, ReadingStatus.OK, 1.5),)))
    ranks.add(Readings.of((RangeReading(0, math.pi / 2, ReadingStatus.OK, 1.0),)))
    left, right = regions_of(ranks, 2)
    assert (left.centre.x_m, left.centre.y_m, left.centre.heading_rad) == pytest.approx((0.75, 1.75, 0.0))
    assert right.centre.x_m == pytest.approx(3.75)
    assert astuple(left.extent) == pytest.approx((0.5, 1.0, 1.5, 2.0, 0.0, 0.0))
    assert astuple(left.circle) == pytest.approx((0.75, 1.75, math.hypot(0.25, 0.25)))
    assert left.cover == Cover(1, ((3, 3, 3),))
    assert (left.cells, left.best_rank) == (1, 2)


def test_a_region_within_a_margin_keeps_the_mean_of_its_best_cells() -> None:
    ranks = RankGrid(two_rooms(), [0.0])
    ranks.add(Readings.of((RangeReading(0, 0.0, ReadingStatus.OK, 1.5),)))
    ranks.add(Readings.of((RangeReading(0, math.pi / 2, ReadingStatus.OK, 1.0),)))
    left, _ = regions_of(ranks, 1)
    assert (left.cells, left.best_rank) == (8, 2)
    assert (left.centre.x_m, left.centre.y_m) == pytest.approx((0.75, 1.75))


def test_nothing_of_that_rank_is_no_region() -> None:
    assert regions_of(RankGrid(two_rooms(), [0.0]), 1) == ()


def test_headings_are_joined_across_north() -> None:
    ranks = RankGrid(two_rooms(), even_headings(36))
    for bearing, range_m in ((0.0, 2.0), (math.pi / 2, 1.5), (math.pi, 1.0), (-math.pi / 2, 1.0)):
        ranks.add(Readings.of((RangeReading(0, bearing, ReadingStatus.OK, range_m),)))
    regions = regions_of(ranks, 4)
    east = [region for region in regions if math.cos(region.centre.heading_rad) > 0.9]
    assert len(east) == 2  # one in each room
    assert {int(heading) for heading, _, _ in ranks.best_poses().poses if heading < 9 or heading > 27} >= {35, 0, 1}
    assert all(abs(region.centre.heading_rad) < 0.05 for region in east)
    for region in east:
        low_rad, high_rad = region.extent.heading_min_rad, region.extent.heading_max_rad
        assert -0.5 < low_rad < -math.radians(10.0)
        assert math.radians(10.0) < high_rad < 0.5
        assert (region.cells, region.poses >= 3) == (1, True)


def test_a_region_that_goes_all_round_reaches_a_whole_turn() -> None:
    ranks = RankGrid(two_rooms(), even_headings(12))
    ranks.add(Readings.of((RangeReading(0, 0.0, ReadingStatus.MISS, 0.3),)))
    for region in regions_of(ranks, 1):
        extent = region.extent
        assert extent.heading_max_rad - extent.heading_min_rad == pytest.approx(math.tau)
        assert (region.cells, region.poses) == (20, 240)


def test_regions_beyond_the_most_are_counted_and_none_is_better() -> None:
    poses = np.array([(0, 0, 2 * col) for col in range(9)])
    ranks = np.array([5, 9, 7, 9, 1, 2, 3, 4, 8], np.uint16)
    pieces = pieces_of(PoseSet(poses, ranks, 9), (0.0,), 4)
    assert [(int(piece.poses[0, 2]), int(piece.ranks[0])) for piece in pieces.best] == [(2, 9), (6, 9), (16, 8), (4, 7)]
    assert pieces.left_out == 5


@settings(max_examples=80)
@given(hnp.arrays(np.bool_, hnp.array_shapes(min_dims=2, max_dims=2, max_side=12)), st.integers(1, 6))
def test_a_cover_is_short_and_holds_every_cell(mask: NDArray[np.bool_], most: int) -> None:
    cells = np.argwhere(mask)
    if len(cells) == 0:
        return
    cover = cover_of(cells, most)
    block = cover.block_cells
    held = {(row, col) for row, first, last in cover.runs for col in range(first, last + 1)}
    assert held == {(row // block, col // block) for row, col in cells.tolist()}
    assert len(cover.runs) <= most
    assert block == 1 or len(cover_of(cells, 99).runs) > most
    assert cover.runs == tuple(sorted(cover.runs))
