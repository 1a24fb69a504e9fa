"""The shortlist stands for all poses, the best ones first."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.localization.judge.shortlist import near, shortlist


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32), st.integers(0, 200), st.floats(0.05, 1.0), st.floats(0.01, 2.0))
def test_every_pose_is_near_to_a_start_that_explains_as_much(
    seed: int, count: int, reach_m: float, reach_rad: float
) -> None:
    rng = np.random.default_rng(seed)
    poses, ranks = rng.uniform((0, 0, -7), (4, 4, 7), (count, 3)), rng.integers(0, 50, count)
    starts = shortlist(poses, ranks, reach_m, reach_rad, count)
    assert (np.diff(ranks[starts]) <= 0).all()
    for pose, rank in zip(poses, ranks, strict=True):
        around = starts[near(poses[starts], pose, reach_m, reach_rad)]
        assert (ranks[around] >= rank).any()
    for start in starts:
        assert near(poses[starts], poses[start], reach_m, reach_rad).sum() == 1


def test_too_many_starts_leave_out_those_that_explain_least() -> None:
    poses = np.array([[x_m, 0.0, 0.0] for x_m in range(6)], np.float64)
    assert shortlist(poses, np.array([3, 9, 5, 9, 1, 7]), 0.5, 0.1, 4).tolist() == [1, 3, 5, 2]


def test_headings_go_round() -> None:
    poses = np.array([[0.0, 0.0, 3.1], [0.0, 0.0, -3.1], [0.0, 0.0, 0.0]])
    assert near(poses, poses[0], 0.1, 0.1).tolist() == [True, True, False]
