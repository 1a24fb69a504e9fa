"""Connected regions against a flood from cell to cell."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.binary import BinaryMap
from robotd.grid.spec import GridSpec
from robotd.localization.prepared import PreparedMap
from robotd.localization.rank import RankGrid, even_headings
from robotd.localization.regions import connected_components, regions_of

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
    """Two equal rooms of 4 x 5 cells of 0.5 m, with a wall between."""
    occupied = np.ones((6, 13), np.bool_)
    occupied[1:5, 1:6] = False
    occupied[1:5, 7:12] = False
    return PreparedMap.of_binary(BinaryMap(GridSpec(0.5, -1.0, 0.0, (6, 13)), occupied), 0.0)


def test_every_region_is_told_with_its_place_and_extent() -> None:
    ranks = RankGrid(two_rooms(), [0.0])
    ranks.add(RangeReading(0, 0.0, ReadingStatus.OK, 1.5))
    ranks.add(RangeReading(0, math.pi / 2, ReadingStatus.OK, 1.0))
    left, right = regions_of(ranks, 2)
    assert (left.centre.x_m, left.centre.y_m, left.centre.heading_rad) == pytest.approx((0.75, 1.75, 0.0))
    assert right.centre.x_m == pytest.approx(3.75)
    assert (left.x_min_m, left.x_max_m, left.y_min_m, left.y_max_m) == pytest.approx((0.5, 1.0, 1.5, 2.0))
    assert (left.cells, left.best_rank) == (1, 2)


def test_a_region_within_a_margin_keeps_the_mean_of_its_best_cells() -> None:
    ranks = RankGrid(two_rooms(), [0.0])
    ranks.add(RangeReading(0, 0.0, ReadingStatus.OK, 1.5))
    ranks.add(RangeReading(0, math.pi / 2, ReadingStatus.OK, 1.0))
    left, _ = regions_of(ranks, 1)
    assert (left.cells, left.best_rank) == (8, 2)
    assert (left.centre.x_m, left.centre.y_m) == pytest.approx((0.75, 1.75))


def test_nothing_of_that_rank_is_no_region() -> None:
    assert regions_of(RankGrid(two_rooms(), [0.0]), 1) == ()


def test_headings_are_joined_across_north() -> None:
    ranks = RankGrid(two_rooms(), even_headings(36))
    for bearing, range_m in ((0.0, 2.0), (math.pi / 2, 1.5), (math.pi, 1.0), (-math.pi / 2, 1.0)):
        ranks.add(RangeReading(0, bearing, ReadingStatus.OK, range_m))
    regions = regions_of(ranks, 4)
    east = [region for region in regions if math.cos(region.centre.heading_rad) > 0.9]
    assert len(east) == 2  # one in each room
    assert {int(heading) for heading, _, _ in ranks.best_cells if heading < 9 or heading > 27} >= {35, 0, 1}
    assert all(abs(region.centre.heading_rad) < 0.05 for region in east)
