"""The smallest circle round points."""

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

_SLACK = 1e-9
"""A point is in a circle if it is outside by no more than this share of its radius: rounding, nothing else."""


def smallest_circle(points: Points) -> tuple[float, float, float]:
    """Return ``(x, y, radius)`` of the smallest circle that holds all points ``float64[n, 2]``, at least one.

    Two or three of the points decide it. They are found by taking in whichever point lies farthest outside, and then
    choosing again among the deciding ones: the radius grows with every step. O(n) a step; few steps in practice.
    """
    deciding = points[:1]
    circle = (float(points[0, 0]), float(points[0, 1]), 0.0)
    while True:
        outside = _distances(points, circle) - circle[2]
        farthest = int(outside.argmax())
        if outside[farthest] <= _SLACK * (1.0 + circle[2]):
            return circle
        larger, chosen = _smallest_of_few(np.concatenate((deciding, points[farthest : farthest + 1])))
        if larger[2] <= circle[2]:  # rounding has the last word
            return circle[0], circle[1], circle[2] + float(outside[farthest])
        circle, deciding = larger, chosen


def _smallest_of_few(points: Points) -> tuple[tuple[float, float, float], Points]:
    """Return the smallest circle round up to four points, and those that decide it."""
    candidates = []
    for chosen in (*combinations(points, 2), *combinations(points, 3)):
        circle = _through(*chosen)
        if circle is not None and (_distances(points, circle) <= circle[2] + _SLACK * (1.0 + circle[2])).all():
            candidates.append((circle, np.array(chosen)))
    return min(candidates, key=lambda candidate: candidate[0][2])


def _through(a: Points, b: Points, c: Points | None = None) -> tuple[float, float, float] | None:
    """Return the circle on a diameter, or the one through three points; None if these lie in a line."""
    to_b = b - a
    if c is None:
        return float(a[0] + to_b[0] / 2), float(a[1] + to_b[1] / 2), float(np.hypot(*to_b)) / 2
    to_c = c - a
    twice_area = 2.0 * float(to_b[0] * to_c[1] - to_b[1] * to_c[0])
    # In a line, two of the three decide, and they are tried as a diameter.
    if twice_area == 0.0:
        return None
    squares = np.array([to_b @ to_b, to_c @ to_c])
    x = float(to_c[1] * squares[0] - to_b[1] * squares[1]) / twice_area
    y = float(to_b[0] * squares[1] - to_c[0] * squares[0]) / twice_area
    return float(a[0]) + x, float(a[1]) + y, float(np.hypot(x, y))


def _distances(points: Points, circle: tuple[float, float, float]) -> Points:
    return np.hypot(points[:, 0] - circle[0], points[:, 1] - circle[1])
