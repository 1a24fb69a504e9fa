"""Figs. 4 and 6 of [BrownDonald2000]_: which poses a reading leaves, and what a new obstacle changes of that."""

import math
from collections.abc import Callable
from functools import cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle
from numpy.typing import NDArray

from robotd.core.reading import RangeReading, ReadingStatus
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.reference.feasible_poses import feasible_poses
from robotd.localization.reference.probe import Probe, probe_of
from robotd.sim.physics.walls import WallSegments, ray_cast
from tests.studies.paper.sheet import BOTH, INK, OBSTACLE, RED, SECOND, Mask, arrow, fill, sheet

_EPS = 1.5
_HERE = (10.5, 8.5)
"""Where the robot of fig. 6 stands, ``(x, y)`` in cells."""
_HEADINGS_RAD = tuple(math.tau * number / 12 for number in range(12))
_ROOM = ((1.0, 1.0), (20.0, 1.0), (20.0, 12.0), (14.0, 12.0), (14.0, 15.0), (1.0, 15.0))
_NEW = ((13.0, 6.5), (15.5, 6.5), (15.5, 10.5), (13.0, 10.5))


def _poses(axes: Axes) -> None:
    """Fig. 4: one reading at three poses."""
    solid, length, bearing_rad = np.zeros((16, 24), np.bool_), 8.0, math.radians(20.0)
    solid[4:13, 17:22] = solid[3:5, 12:14] = True
    feasible = _feasible_far_from_the_edge(solid, _probe(length, bearing_rad, 1.0))
    sheet(axes, solid.shape)
    fill(axes, feasible, BOTH)
    fill(axes, solid, OBSTACLE)
    along = length * np.array((math.cos(bearing_rad), math.sin(bearing_rad)))
    for name, (row, col) in (("a", (8, 9)), ("b", (11, 1)), ("c", (2, 9))):
        assert feasible[row, col] == (name == "a")
        start = np.array((col + 0.5, row + 0.5))
        arrow(axes, tuple(start), tuple(start + along))
        axes.text(start[0] - 0.3, start[1] + 1.0, f"({name})", ha="right", va="center", fontsize=8, color=INK, zorder=8)


def _feasible_far_from_the_edge(solid: Mask, probe: Probe) -> Mask:
    """Return the feasible poses, with what lies beyond the sheet free for as far as any beam goes."""
    margin = 30
    feasible = feasible_poses(Obstacles.of(np.pad(solid, margin), 1.0), probe)
    return feasible[margin:-margin, margin:-margin]


def _met(axes: Axes, *, with_new: bool) -> None:
    """Fig. 6: twelve readings in a room, where something new stands or not, on the map of the room alone."""
    solid, readings = _walls_cells(), seen(with_new=with_new)
    ranks = rank_here(readings)
    sheet(axes, solid.shape)
    fill(axes, solid, OBSTACLE)
    fill(axes, ranks == ranks.max(), BOTH)
    axes.add_patch(Circle(_HERE, 1.2, fill=False, edgecolor=RED, linewidth=1.3, zorder=8))
    if with_new:
        x, y = np.array([*_NEW, _NEW[0]]).T
        axes.fill(x, y, color=SECOND, zorder=4)
    for heading_rad, range_cells in zip(_HEADINGS_RAD, readings, strict=True):
        head = (_HERE[0] + range_cells * math.cos(heading_rad), _HERE[1] + range_cells * math.sin(heading_rad))
        arrow(axes, _HERE, head)


def seen(*, with_new: bool) -> tuple[float, ...]:
    """Return the twelve ranges, in cells."""
    walls = _segments(_ROOM, _NEW) if with_new else _segments(_ROOM)
    return tuple(ray_cast(walls, _HERE, heading_rad) for heading_rad in _HEADINGS_RAD)


def rank_here(ranges_cells: tuple[float, ...]) -> NDArray[np.int64]:
    """Return how many of the readings each cell explains, on the map of the room alone."""
    obstacles = Obstacles.of(_walls_cells(), _EPS)
    probes = (_probe(length, heading, _EPS) for length, heading in zip(ranges_cells, _HEADINGS_RAD, strict=True))
    ranks = np.zeros(obstacles.free.shape, np.int64)
    for probe in probes:
        ranks += feasible_poses(obstacles, probe)
    return ranks


def at_the_robot() -> tuple[int, int]:
    """Return its cell."""
    return int(_HERE[1]), int(_HERE[0])


def _probe(length: float, heading_rad: float, eps: float) -> Probe:
    reading = RangeReading(0, 0.0, ReadingStatus.OK, length)
    return probe_of(reading, heading_rad, resolution_m=1.0, error_radius_cells=eps, reach_cells=1000)


@cache
def _walls_cells() -> Mask:
    """Return the room as cells: its walls are those that its outline runs through."""
    cells = np.zeros((17, 22), np.bool_)
    for begin, end in zip(_ROOM, (*_ROOM[1:], _ROOM[0]), strict=True):
        for share in np.linspace(0.0, 1.0, 200).tolist():
            x, y = (one + share * (other - one) for one, other in zip(begin, end, strict=True))
            cells[int(y), int(x)] = True
    return cells


def _segments(*outlines: tuple[tuple[float, float], ...]) -> WallSegments:
    return WallSegments.of(
        (begin, end, math.inf)
        for outline in outlines
        for begin, end in zip(outline, (*outline[1:], outline[0]), strict=True)
    )


def _without(axes: Axes) -> None:
    _met(axes, with_new=False)


def _with(axes: Axes) -> None:
    _met(axes, with_new=True)


POSES_FIGURES: dict[str, tuple[str, tuple[tuple[str, Callable[[Axes], None]], ...]]] = {
    "fig-04": (
        "Fig. 4: which poses a reading leaves",
        (("green: feasible, as (a); at (b) the head is free, at (c) the body is not", _poses),),
    ),
    "fig-06": (
        "Fig. 6: new obstacles",
        (
            ("(a) twelve readings; green: all are explained", _without),
            ("(b) something new stands there; green: nine are", _with),
        ),
    ),
}
"""By file: a title, and panels with their captions."""
