"""Graphs of stops with a known truth: a robot that goes round a square again and again, with noisy steps and loops."""

import math

import numpy as np

from robotd.core.pose import Pose2
from robotd.slam.graph import Edge, EdgeKind
from robotd.slam.stops import Poses

GROUP = 5
"""False loops that say the same: stops in a row, taken for others in a row, all by one mistake."""
STEP_COVARIANCE = np.diag([0.02**2, 0.02**2, math.radians(0.35) ** 2])


def truth_of(stops: int, side: int = 12) -> Poses:
    """Return poses along a square, steps of 0.7 m, round and round."""
    poses, pose = np.empty((0, 3)), Pose2(0.0, 0.0, 0.0)
    for stop in range(stops):
        poses = _with(poses, pose)
        turn = math.pi / 2 if stop % side == side - 1 else 0.0
        pose = pose @ Pose2(0.7, 0.0, turn)
    return poses


def noisy(step: Pose2, random: np.random.Generator) -> Pose2:
    """Return a step as it is measured."""
    x_m, y_m, heading_rad = random.multivariate_normal(np.zeros(3), STEP_COVARIANCE).tolist()
    return step @ Pose2(x_m, y_m, heading_rad)


def edges_of(truth: Poses, random: np.random.Generator, round_of: int = 48) -> list[Edge]:
    """Return a step from each stop to the next, and a loop from every second one to where it was a round before."""
    steps = [_edge(truth, at, at + 1, EdgeKind.STEP, random) for at in range(len(truth) - 1)]
    return steps + [_edge(truth, at - round_of, at, EdgeKind.LOOP, random) for at in range(round_of, len(truth), 2)]


def start_of(edges: list[Edge], stops: int) -> Poses:
    """Return the poses that the steps alone come to."""
    poses = np.zeros((1, 3))
    for edge in edges[: stops - 1]:
        poses = _with(poses, _pose(poses, edge.earlier) @ edge.step)
    return poses


def false_loops(truth: Poses, count: int, random: np.random.Generator) -> list[Edge]:
    """Return loops that claim of two stops far apart that they are one place."""
    found: list[Edge] = []
    while len(found) < count:
        earlier, later = sorted(random.integers(0, len(truth), 2).tolist())
        if np.hypot(*(truth[earlier, :2] - truth[later, :2])) > 2.0:
            x_m, y_m, heading_rad = random.normal(0.0, (0.3, 0.3, 0.2)).tolist()
            found.append(Edge(earlier, later, Pose2(x_m, y_m, heading_rad), STEP_COVARIANCE, EdgeKind.LOOP))
    return found


def false_groups(truth: Poses, count: int, random: np.random.Generator) -> list[Edge]:
    """Return loops in groups of :data:`GROUP`, each of which agrees with itself: rooms that are alike."""
    found: list[Edge] = []
    for _ in range(count):
        earlier = int(random.integers(0, len(truth) - 10 * GROUP))
        later = int(random.integers(earlier + 5 * GROUP, len(truth) - GROUP))
        mistake = _pose(truth, earlier) @ Pose2(*random.uniform(-3.0, 3.0, 3).tolist()) @ _pose(truth, later).inverse()
        for at in range(GROUP):
            step = _pose(truth, earlier + at).inverse() @ mistake @ _pose(truth, later + at)
            found.append(Edge(earlier + at, later + at, step, STEP_COVARIANCE, EdgeKind.LOOP))
    return found


def _edge(truth: Poses, one: int, other: int, kind: EdgeKind, random: np.random.Generator) -> Edge:
    step = _pose(truth, one).inverse() @ _pose(truth, other)
    return Edge(one, other, noisy(step, random), STEP_COVARIANCE, kind)


def _pose(poses: Poses, at: int) -> Pose2:
    return Pose2(*poses[at].tolist())


def _with(poses: Poses, pose: Pose2) -> Poses:
    return np.concatenate((poses, [(pose.x_m, pose.y_m, pose.heading_rad)]))
