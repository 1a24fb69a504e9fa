"""What one pose explains is what the feasible poses of each reading say of it."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.readings import Readings
from robotd.grid.ternary import TernaryMap
from robotd.localization.count.explained import explained_at
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.obstacles.levels import Levels
from robotd.localization.obstacles.unknown_cells import UnknownCells
from robotd.localization.reference.feasible_poses import feasible_poses
from robotd.localization.reference.probe import probe_of

SPEC = GridSpec(0.1, 0.0, 0.0, (9, 11))
readings = st.builds(
    RangeReading,
    st.just(0),
    st.floats(-math.pi, math.pi),
    st.sampled_from([ReadingStatus.OK, ReadingStatus.MISS]),
    st.floats(0.05, 2.0),
    st.none(),
    st.sampled_from([0.0, 0.13]),
    st.sampled_from([0.0, -0.21]),
)


@settings(max_examples=150, deadline=None)
@given(
    hnp.arrays(np.uint8, SPEC.shape, elements=st.sampled_from([0, 0, 0, 1, 2])),
    st.lists(readings, min_size=1, max_size=8),
    st.floats(-4.0, 4.0),
    st.sampled_from(UnknownCells),
    st.sampled_from([1, 2]),
    st.sampled_from([0.0, 1.0, 1.5]),
)
def test_it_is_feasibility_at_that_pose(
    cells: NDArray[np.uint8],
    taken: list[RangeReading],
    heading_rad: float,
    unknown: UnknownCells,
    blocked_by: int,
    error_radius_cells: float,
) -> None:
    ternary = TernaryMap(SPEC, cells == 1, cells == 0)
    obstacles = Obstacles.of_map(ternary, unknown, error_radius_cells, blocked_by=blocked_by)
    the_map = Levels.of(obstacles, SPEC, error_radius_cells)
    probes = [
        probe_of(
            reading,
            heading_rad,
            resolution_m=SPEC.resolution_m,
            error_radius_cells=error_radius_cells,
            reach_cells=2 * max(SPEC.shape),
        )
        for reading in taken
    ]
    feasible = np.stack([feasible_poses(obstacles, probe) for probe in probes], axis=2)
    for row, col in np.ndindex(SPEC.shape):
        found = explained_at(the_map, Readings.of(taken), (row, col), heading_rad)
        assert found.tolist() == feasible[row, col].tolist()
