"""Pictures of rooms, maps and localizations, as PNG files (needs the extra ``plots``).

Pure drawing: arrays in, a file out, no window and no state. Every picture is to scale, says so with a bar
in metres, and lies as the map lies: +x to the right, +y up.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import Circle, Polygon
from numpy.typing import NDArray

from robotd.cli.pictures.sheet import (
    ESTIMATE,
    FURNITURE,
    PATH,
    TRUTH,
    WALL,
    Points,
    evidence,
    extent_of,
    known_box,
    legend,
    numbered_stop,
    paper,
    save,
)
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.core.rectangle import Rectangle


@dataclass(frozen=True, slots=True)
class Mark:
    """A robot to draw: a circle to scale with its heading for the truth, a cross for an estimate."""

    pose: Pose2
    radius_m: float


def draw_room(
    file: Path,
    title: str,
    walls_m: Sequence[Points],
    *,
    open_walls_m: Sequence[Points] = (),
    stops_m: Sequence[tuple[float, float]] = (),
    path_m: Points | None = None,
    robot_radius_m: float = 0.0,
) -> None:
    """Draw the true room: its walls, and the stops with their numbers.

    Args:
        file: the PNG to write.
        title: what to write above.
        walls_m: closed polygons ``float64[n, 2]``; the largest is the room, the others stand in it.
        open_walls_m: walls that enclose nothing, ``float64[n, 2]``.
        stops_m: where the robot stopped, in order.
        path_m: the way it went ``float64[n, 2]``; straight from stop to stop if None.
        robot_radius_m: if given, each stop shows how much room the robot takes.
    """
    corners = np.concatenate([*walls_m, *open_walls_m])
    shown = Rectangle(*corners.min(axis=0).tolist(), *corners.max(axis=0).tolist())
    axes = paper(title, shown, "the true room, with the stops in their order")
    for number, wall in enumerate(sorted(walls_m, key=_extent_m, reverse=True)):
        style = {"facecolor": FURNITURE, "linewidth": 1.2} if number else {"facecolor": "white", "linewidth": 3.0}
        axes.add_patch(Polygon(wall, closed=True, edgecolor=WALL, zorder=1 + (number > 0), **style))
    axes.add_collection(LineCollection(list(open_walls_m), colors=WALL, linewidths=2.0, zorder=2), autolim=False)
    way = np.array(stops_m, dtype=np.float64).reshape(-1, 2) if path_m is None else path_m
    axes.plot(way[:, 0], way[:, 1], color=PATH, linewidth=1.6, alpha=0.9, zorder=3, solid_joinstyle="round")
    for number, (x_m, y_m) in enumerate(stops_m):
        numbered_stop(axes, number, x_m, y_m, robot_radius_m)
    save(axes, file)


def draw_map(
    file: Path,
    title: str,
    spec: GridSpec,
    occupancy: NDArray[np.uint8],
    *,
    stops_m: Sequence[tuple[float, float]] = (),
    robot: Pose2 | None = None,
) -> None:
    """Draw the robot's map ``uint8[rows, cols]``: white is free, grey is unknown, black is occupied."""
    note = f"the robot's map; cells of {spec.resolution_m * 1000:g} mm; white free, grey unknown, black occupied"
    axes = paper(title, known_box(spec, occupancy), note)
    evidence(axes, spec, occupancy)
    for x_m, y_m in stops_m:
        axes.plot(x_m, y_m, "o", markersize=4.5, color=PATH, markeredgecolor="white", markeredgewidth=0.8)
    if robot is not None:
        _robot(axes, Mark(robot, _ROBOT_RADIUS_M))
    save(axes, file)


_ROBOT_RADIUS_M = 0.2
"""How large a robot is drawn whose size is not told."""


def draw_localization(
    file: Path,
    title: str,
    spec: GridSpec,
    rank: NDArray[np.integer],
    *,
    obstacles: NDArray[np.bool_] | None = None,
    truth: Mark | None = None,
    estimate: Pose2 | None = None,
) -> None:
    """Draw a rank grid ``int[rows, cols]`` as the paper does ([BrownDonald2000]_ fig. 10 and after).

    White cells are feasible for no reading, darker ones for more, black ones for the most. ``obstacles``
    ``bool[rows, cols]`` is the map the robot is sought in, the true robot a circle to scale, the estimate a cross.
    """
    greatest = int(rank.max())
    known = np.where(rank > 0, 255, 128) if obstacles is None else np.where(obstacles | (rank > 0), 255, 128)
    box = known_box(spec, known.astype(np.uint8))
    axes = paper(title, box, f"white: no reading explained; black: {greatest} explained, the most")
    axes.imshow(
        rank, cmap="gray_r", vmin=0, vmax=max(greatest, 1), extent=extent_of(spec), origin="lower", interpolation="none"
    )
    if obstacles is not None:
        _overlay(axes, spec, obstacles)
    if truth is not None:
        _robot(axes, truth)
    if estimate is not None:
        axes.plot(estimate.x_m, estimate.y_m, "+", markersize=15, markeredgewidth=2.0, color=ESTIMATE)
    _legend(axes, truth=truth is not None, estimate=estimate is not None)
    save(axes, file)


def _extent_m(wall: Points) -> float:
    return float(np.ptp(wall, axis=0).max())


def _overlay(axes: Axes, spec: GridSpec, obstacles: NDArray[np.bool_]) -> None:
    """Lay the obstacles over the ranks in a colour that no rank has."""
    tint = np.zeros((*obstacles.shape, 4))
    tint[obstacles] = (0.36, 0.62, 0.78, 1.0)
    axes.imshow(tint, extent=extent_of(spec), origin="lower", interpolation="none")


def _robot(axes: Axes, mark: Mark) -> None:
    pose = mark.pose
    nose = pose.transform(mark.radius_m, 0.0)
    axes.add_patch(Circle((pose.x_m, pose.y_m), mark.radius_m, fill=False, edgecolor=TRUTH, linewidth=2.0))
    axes.plot([pose.x_m, nose[0]], [pose.y_m, nose[1]], color=TRUTH, linewidth=2.0, solid_capstyle="round")


def _legend(axes: Axes, *, truth: bool, estimate: bool) -> None:
    marks = [("o", "true robot, to scale", TRUTH)] * truth + [("+", "estimate", ESTIMATE)] * estimate
    legend(axes, marks)
