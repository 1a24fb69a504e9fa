"""A further layer of the map narrows the answers down as the definition says, counted pose by pose."""

import math
from collections.abc import Sequence

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.reading import RangeReading, ReadingStatus, Tilt
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.pose_set import PoseSet
from robotd.grid.readings import Readings
from robotd.grid.tables import NO_INFORMATION
from robotd.localization.count.explained import explained_at
from robotd.localization.layer_seen import LayerSeen
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings

SPEC = GridSpec(0.1, -0.5, 0.3, (14, 17))
SETTINGS = LocalizationSettings(range_error_m=0.1, bearing_error_rad=0.1)
TILT = Tilt(-0.2, 2.0)
HEADINGS_RAD = (-1.0, 0.3, 2.0)
readings = st.builds(
    RangeReading,
    st.just(0),
    st.floats(-math.pi, math.pi),
    st.sampled_from([ReadingStatus.OK, ReadingStatus.OK, ReadingStatus.MISS]),
    st.floats(0.05, 1.5),
)
# Vacant, never seen, an obstacle.
evidence = hnp.arrays(np.uint8, SPEC.shape, elements=st.sampled_from([0, 0, 0, NO_INFORMATION, 255]))


def ready(cells: NDArray[np.uint8]) -> ReadyMap:
    return ReadyMap.of(OccupancyGrid(SPEC, cells), SETTINGS)


poses = st.sets(st.tuples(st.integers(0, 2), st.integers(0, 13), st.integers(0, 16)), max_size=12)


def found_of(chosen: set[tuple[int, int, int]]) -> PoseSet:
    poses = np.array(sorted(chosen), np.intp).reshape(-1, 3)
    return PoseSet(poses, np.arange(1, len(poses) + 1).astype(np.uint16), len(poses))


def agreeing_by_definition(cells: NDArray[np.uint8], taken: Sequence[RangeReading], found: PoseSet) -> list[bool]:
    """Ask at each pose alone: may the robot stand there, and does the layer explain enough, if it has a say."""
    levels = ready(cells).prepared
    ranks = [
        int(explained_at(levels, Readings.of(taken), (row, col), HEADINGS_RAD[heading]).sum())
        if cells[row, col] == 0
        else None
        for heading, row, col in found.poses.tolist()
    ]
    best = max((rank for rank in ranks if rank is not None), default=0)
    enough = best - math.ceil(SETTINGS.rival_share * len(taken))
    return [
        bool(cells[row, col] == NO_INFORMATION if rank is None else rank >= enough)
        for (_, row, col), rank in zip(found.poses.tolist(), ranks, strict=True)
    ]


@settings(max_examples=60, deadline=None)
@given(evidence, poses, st.lists(readings, min_size=1, max_size=9))
def test_it_leaves_the_poses_that_the_definition_leaves(
    cells: NDArray[np.uint8], chosen: set[tuple[int, int, int]], taken: list[RangeReading]
) -> None:
    found, layer = found_of(chosen), LayerSeen(TILT, ready(cells))
    layer.add(Readings.of(taken[:3]))
    layer.add(Readings.of(taken[3:]))
    left, best = layer.agreeing(found, HEADINGS_RAD)
    expected = np.array(agreeing_by_definition(cells, taken, found), np.bool_)
    assert np.array_equal(left.poses, found.poses[expected])
    assert np.array_equal(left.ranks, found.ranks[expected])
    assert left.best_rank == int(found.ranks[expected].max(initial=0))
    assert 0 <= best <= len(taken)


def test_what_was_never_seen_at_its_tilt_has_no_say() -> None:
    found = found_of({(0, 3, 4), (2, 7, 7)})
    layer = LayerSeen(TILT, ready(np.full(SPEC.shape, NO_INFORMATION, np.uint8)))
    layer.add(Readings.of([RangeReading(0, 0.1, ReadingStatus.OK, 0.7)] * 20))
    left, best = layer.agreeing(found, HEADINGS_RAD)
    assert (len(left), best) == (len(found), 0)
