"""What is known of where stops lie to each other: edges between poses, and what it costs to bend them.

An edge says where one stop lies as seen from another, and how sure that is. Edges of odometry and of loops may be
wrong: they are robust, and lose their say where they contradict what all the others say.
"""

import enum
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2


class EdgeKind(enum.StrEnum):
    """Who says so."""

    STEP = "step"
    """A sweep that was placed on the stops before it."""
    ODOMETRY = "odometry"
    """The wheels."""
    LOOP = "loop"
    """A sweep that was found on stops of long ago."""

    @property
    def is_robust(self) -> bool:
        """Whether it may be refused."""
        # A step was placed on the very stops that it is tied to; wheels slip, and loops may be found in the
        # wrong room.
        return self is not EdgeKind.STEP


@dataclass(frozen=True, slots=True, eq=False)
class Edge:
    """Where ``later`` lies as seen from ``earlier``."""

    earlier: int
    later: int
    step: Pose2
    covariance: NDArray[np.float64]
    """``float64[3, 3]`` of x, y [m] and heading [rad], in the frame of ``later``."""
    kind: EdgeKind


@dataclass(frozen=True, slots=True, eq=False)
class EdgeTable:
    """Edges as columns, for everything that computes on all at once."""

    ends: NDArray[np.intp]
    """``intp[m, 2]``: earlier, later."""
    steps: NDArray[np.float64]
    """``float64[m, 3]``."""
    information: NDArray[np.float64]
    """``float64[m, 3, 3]``: inverse covariances."""
    robust: NDArray[np.bool_]
    """``bool[m]``."""

    @classmethod
    def of(cls, edges: Sequence[Edge]) -> "EdgeTable":
        """Put edges into columns, in their order."""
        steps = [(edge.step.x_m, edge.step.y_m, edge.step.heading_rad) for edge in edges]
        covariances = np.array([edge.covariance for edge in edges]).reshape(-1, 3, 3)
        return cls(
            np.array([(edge.earlier, edge.later) for edge in edges], np.intp).reshape(-1, 2),
            np.array(steps).reshape(-1, 3),
            # Inverted once for a solve: every step of it needs them.
            np.linalg.inv(covariances) if len(edges) else covariances,
            np.array([edge.kind.is_robust for edge in edges], np.bool_),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Linear:
    """The edges at some poses, to the first order."""

    residuals: NDArray[np.float64]
    """``float64[m, 3]``: where the later stop lies, seen from where the edge has it."""
    by_earlier: NDArray[np.float64]
    """``float64[m, 3, 3]``: derivative by the earlier pose (map frame)."""
    by_later: NDArray[np.float64]
    """``float64[m, 3, 3]``: by the later pose."""


def residuals(table: EdgeTable, poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``float64[m, 3]``: where each later stop lies, seen from where its edge has it."""
    return _linear(table, poses, derivatives=False).residuals


def linear(table: EdgeTable, poses: NDArray[np.float64]) -> Linear:
    """Return the edges at poses ``float64[n, 3]``, to the first order."""
    return _linear(table, poses, derivatives=True)


def _linear(table: EdgeTable, poses: NDArray[np.float64], *, derivatives: bool) -> Linear:
    earlier, later = poses[table.ends[:, 0]], poses[table.ends[:, 1]]
    # The frame in which the edge has the later stop is turned by both headings.
    turn = earlier[:, 2] + table.steps[:, 2]
    cosine, sine = np.cos(turn), np.sin(turn)
    off = later[:, :2] - earlier[:, :2]
    cosine_step, sine_step = np.cos(table.steps[:, 2]), np.sin(table.steps[:, 2])
    found = np.empty((len(off), 3))
    x, y = table.steps[:, 0], table.steps[:, 1]
    found[:, 0] = cosine * off[:, 0] + sine * off[:, 1] - (cosine_step * x + sine_step * y)
    found[:, 1] = -sine * off[:, 0] + cosine * off[:, 1] - (-sine_step * x + cosine_step * y)
    # Wrapped: a difference just beyond half a turn is a small one the other way.
    found[:, 2] = np.mod(later[:, 2] - turn + math.pi, math.tau) - math.pi
    if not derivatives:
        return Linear(found, found[:0], found[:0])
    by_later = np.zeros((len(off), 3, 3))
    by_later[:, 0, 0], by_later[:, 0, 1] = cosine, sine
    by_later[:, 1, 0], by_later[:, 1, 1] = -sine, cosine
    by_later[:, 2, 2] = 1.0
    # In the frame of the edge the two poses pull alike, but for the heading of the earlier one, which turns
    # that frame.
    by_earlier = -by_later
    by_earlier[:, 0, 2] = -sine * off[:, 0] + cosine * off[:, 1]
    by_earlier[:, 1, 2] = -cosine * off[:, 0] - sine * off[:, 1]
    return Linear(found, by_earlier, by_later)


def chi2(residuals_: NDArray[np.float64], table: EdgeTable) -> NDArray[np.float64]:
    """Return how much each edge is bent, ``float64[m]``: squares of residuals by their covariance."""
    squares: NDArray[np.float64] = np.einsum("mi,mij,mj->m", residuals_, table.information, residuals_)
    return squares
