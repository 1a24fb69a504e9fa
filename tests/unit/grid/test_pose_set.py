"""A pose set against the sets of Python."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from robotd.grid.pose_set import PoseSet

cubes = st.dictionaries(
    st.tuples(st.integers(0, 3), st.integers(0, 5), st.integers(0, 6)), st.integers(1, 300), min_size=1
)


def set_of(ranks: dict[tuple[int, int, int], int]) -> PoseSet:
    poses = sorted(ranks)
    rows = np.array([(*pose, ranks[pose]) for pose in poses], np.int32)
    return PoseSet.of_rows(rows, max(ranks.values()), min(ranks.values()), slack=300)


@given(cubes)
def test_it_holds_its_poses_and_no_others(ranks: dict[tuple[int, int, int], int]) -> None:
    found = set_of(ranks)
    assert len(found) == len(ranks)
    for pose in np.ndindex(4, 6, 7):
        assert found.holds(np.array(pose)) == (pose in ranks)
    for row, col in np.ndindex(6, 7):
        assert found.holds_cell(row, col) == any((heading, row, col) in ranks for heading in range(4))
    assert [tuple(cell) for cell in found.cells().tolist()] == sorted({pose[1:] for pose in ranks})
    greatest = max(ranks.values())
    assert [tuple(pose) for pose in found.best.tolist()] == [pose for pose in sorted(ranks) if ranks[pose] == greatest]


@given(cubes, st.integers(0, 3))
def test_a_part_knows_its_own_best_rank(ranks: dict[tuple[int, int, int], int], heading: int) -> None:
    found = set_of(ranks)
    part = found.part(found.poses[:, 0] == heading)
    ours = {pose: rank for pose, rank in ranks.items() if pose[0] == heading}
    assert (len(part), part.best_rank) == (len(ours), max(ours.values(), default=0))
    assert part.least_rank == found.least_rank


def test_fewer_than_were_asked_for_are_not_all() -> None:
    rows = np.array([(0, 1, 2, 9)], np.int32)
    assert PoseSet.of_rows(rows, 9, 8, slack=1).is_all
    assert not PoseSet.of_rows(rows, 9, 9, slack=1).is_all
    assert PoseSet.of_rows(rows[:0], 0, 5, slack=1).is_all
    assert PoseSet.nothing(5).is_all
