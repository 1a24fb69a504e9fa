import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from robotd.core.errors import TooLarge
from robotd.core.pose import Pose2
from robotd.slam.graph import Edge, EdgeKind, EdgeTable, chi2, linear, residuals
from robotd.slam.solve import STOPS_MAX, solve
from robotd.slam.stops import Poses
from tests.support.chains import GROUP, STEP_COVARIANCE, edges_of, false_groups, false_loops, start_of, truth_of


def problem(stops: int, seed: int) -> tuple[Poses, list[Edge], Poses]:
    truth = truth_of(stops)
    edges = edges_of(truth, np.random.default_rng(seed))
    return truth, edges, start_of(edges, stops)


def dense_steps(table: EdgeTable, poses: Poses, weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the normal matrix of all poses but the first, and the right-hand side last: the slow twin."""
    count = 3 * len(poses)
    normal, right, at = np.zeros((count, count)), np.zeros(count), linear(table, poses)
    for (one, other), by_one, by_other, residual, information, weight in zip(
        table.ends, at.by_earlier, at.by_later, at.residuals, table.information, weights, strict=True
    ):
        by = np.zeros((3, count))
        by[:, 3 * one : 3 * one + 3], by[:, 3 * other : 3 * other + 3] = by_one, by_other
        normal += weight * by.T @ information @ by
        right -= weight * by.T @ information @ residual
    return np.column_stack((normal[3:, 3:], right[3:]))


def test_derivatives_are_those_of_the_residuals() -> None:
    _, edges, poses = problem(60, 1)
    table = EdgeTable.of(edges)
    at = linear(table, poses)
    for axis in range(3):
        for end, by in ((0, at.by_earlier), (1, at.by_later)):
            for edge in (0, 17, len(edges) - 1):
                moved = poses.copy()
                moved[table.ends[edge, end], axis] += 1e-6
                found = (residuals(table, moved)[edge] - at.residuals[edge]) / 1e-6
                assert found == pytest.approx(by[edge, :, axis], abs=1e-4)


def test_the_solution_is_where_the_dense_twin_moves_nothing() -> None:
    _, edges, start = problem(120, 2)
    solution = solve(start, edges)
    equations = dense_steps(EdgeTable.of(edges), solution.poses, solution.weights)
    assert np.abs(np.linalg.solve(equations[:, :-1], equations[:, -1])).max() < 1e-6
    covariance = np.linalg.inv(equations[:, :-1])
    one, other = 100, 57
    difference = np.zeros((3, len(covariance)))
    difference[:, 3 * one - 3 : 3 * one], difference[:, 3 * other - 3 : 3 * other] = np.eye(3), -np.eye(3)
    (relative,) = solution.relative_covariance(one, [other])
    assert relative == pytest.approx(difference @ covariance @ difference.T, rel=1e-6, abs=1e-12)
    (to_fixed,) = solution.relative_covariance(one, [0])
    assert to_fixed == pytest.approx(covariance[3 * one - 3 : 3 * one, 3 * one - 3 : 3 * one], rel=1e-6, abs=1e-12)


def test_it_is_nearer_to_the_truth_than_the_steps_and_always_the_same() -> None:
    truth, edges, start = problem(300, 3)
    solution, again = solve(start, edges), solve(start, edges)
    off_m = np.hypot(*(solution.poses - truth)[:, :2].T)
    assert off_m.max() < 0.5 * np.hypot(*(start - truth)[:, :2].T).max()
    assert solution.refused == ()
    assert solution.poses.tobytes() == again.poses.tobytes()


@pytest.mark.parametrize("share", [0.2, 0.5, 0.8])
def test_false_loops_lose_their_say(share: float) -> None:
    truth, edges, start = problem(200, 4)
    clean = solve(start, edges).poses
    loops = _loops(edges)
    _lose_their_say(
        start, edges, clean, false_loops(truth, round(loops * share / (1.0 - share)), np.random.default_rng(5))
    )


@pytest.mark.parametrize("share", [0.2, 0.5])
def test_so_do_groups_of_false_loops_that_agree(share: float) -> None:
    truth, edges, start = problem(200, 4)
    clean = solve(start, edges).poses
    groups = round(_loops(edges) * share / (1.0 - share)) // GROUP
    _lose_their_say(start, edges, clean, false_groups(truth, groups, np.random.default_rng(5)))


def _loops(edges: list[Edge]) -> int:
    return sum(edge.kind is EdgeKind.LOOP for edge in edges)


def _lose_their_say(start: Poses, edges: list[Edge], clean: Poses, false: list[Edge]) -> None:
    solution = solve(start, [*edges, *false])
    assert np.hypot(*(solution.poses - clean)[:, :2].T).max() <= 0.05
    refused = set(solution.refused)
    assert {len(edges) + at for at in range(len(false))} <= refused
    assert len(refused) - len(false) <= 0.1 * _loops(edges)


def test_fixed_stops_stay() -> None:
    _, edges, start = problem(60, 6)
    solution = solve(start, edges, fixed=(0, 1, 30))
    assert np.array_equal(solution.poses[[0, 1, 30]], start[[0, 1, 30]])


def test_a_graph_that_falls_apart_is_refused() -> None:
    edge = Edge(0, 1, Pose2(1.0, 0.0, 0.0), STEP_COVARIANCE, EdgeKind.STEP)
    with pytest.raises(ValueError, match="hang on no other"):
        solve(np.zeros((3, 3)), [edge])


def test_too_many_stops_are_refused() -> None:
    with pytest.raises(TooLarge, match="20001 stops"):
        solve(np.zeros((STOPS_MAX + 1, 3)), [])


def test_gtsam_comes_to_the_same() -> None:
    gtsam: Any = pytest.importorskip("gtsam", reason="the oracle from outside needs gtsam: pip install gtsam")
    _, edges, start = problem(200, 7)
    graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
    for at, pose in enumerate(start.tolist()):
        values.insert(at, gtsam.Pose2(*pose))
    graph.add(gtsam.PriorFactorPose2(0, gtsam.Pose2(*start[0].tolist()), gtsam.noiseModel.Isotropic.Sigma(3, 1e-9)))
    noise = gtsam.noiseModel.Gaussian.Covariance(STEP_COVARIANCE)
    cauchy = gtsam.noiseModel.Robust.Create(gtsam.noiseModel.mEstimator.DCS.Create(10.0), noise)
    for edge in edges:
        step = gtsam.Pose2(edge.step.x_m, edge.step.y_m, edge.step.heading_rad)
        model = cauchy if edge.kind.is_robust else noise
        graph.add(gtsam.BetweenFactorPose2(edge.earlier, edge.later, step, model))
    found = gtsam.LevenbergMarquardtOptimizer(graph, values).optimize()
    theirs = np.array([[(p := found.atPose2(at)).x(), p.y(), p.theta()] for at in range(len(start))])
    off = solve(start, edges).poses - theirs
    off[:, 2] = np.mod(off[:, 2] + math.pi, math.tau) - math.pi
    # Their residual is a logarithm, ours is not: that differs in the second order.
    assert np.abs(off).max() < 2e-3


def test_chi2_weighs_by_covariance() -> None:
    edge = Edge(0, 1, Pose2(1.0, 0.0, 0.0), np.diag([0.04, 0.01, 0.25]), EdgeKind.LOOP)
    table = EdgeTable.of([edge])
    poses = np.array([[0.0, 0.0, 0.0], [1.2, 0.1, 0.5]])
    bent = chi2(residuals(table, poses), table)
    assert bent == pytest.approx([0.2**2 / 0.04 + 0.1**2 / 0.01 + 0.5**2 / 0.25])
