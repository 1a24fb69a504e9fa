"""Pictures of rooms, maps and localizations, as PNG files (needs the extra ``plots``).

Pure drawing: arrays in, a file out, no window and no state. Every picture is to scale, says so with a bar
in metres, and lies as the map lies: +x to the right, +y up.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.grid.spec import GridSpec

Points = NDArray[np.float64]
Box = tuple[float, float, float, float]
"""``x_min_m, y_min_m, x_max_m, y_max_m``"""

_INK = "#22303c"
_QUIET = "#6b7a86"
_WALL = "#33414d"
_FURNITURE = "#b9c4cc"
_PATH = "#d9822b"
_TRUTH = "#c8102e"
_ESTIMATE = "#0b63ce"
_EVIDENCE = LinearSegmentedColormap.from_list("evidence", ["#ffffff", "#c3cad0", "#000000"])
_LONG_SIDE_INCH = 9.0
_DPI = 150
_NICE_STEPS = (1.0, 2.0, 5.0)


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
    axes = _paper(title, (*corners.min(axis=0), *corners.max(axis=0)), "the true room, with the stops in their order")
    for number, wall in enumerate(sorted(walls_m, key=_extent_m, reverse=True)):
        style = {"facecolor": _FURNITURE, "linewidth": 1.2} if number else {"facecolor": "white", "linewidth": 3.0}
        axes.add_patch(Polygon(wall, closed=True, edgecolor=_WALL, zorder=1 + (number > 0), **style))
    axes.add_collection(LineCollection(list(open_walls_m), colors=_WALL, linewidths=2.0, zorder=2), autolim=False)
    way = np.array(stops_m, dtype=np.float64).reshape(-1, 2) if path_m is None else path_m
    axes.plot(way[:, 0], way[:, 1], color=_PATH, linewidth=1.6, alpha=0.9, zorder=3, solid_joinstyle="round")
    for number, (x_m, y_m) in enumerate(stops_m):
        _stop(axes, number, x_m, y_m, robot_radius_m)
    _save(axes, file)


def draw_map(
    file: Path,
    title: str,
    spec: GridSpec,
    occupancy: NDArray[np.uint8],
    *,
    stops_m: Sequence[tuple[float, float]] = (),
) -> None:
    """Draw the robot's map ``uint8[rows, cols]``: white is free, grey is unknown, black is occupied."""
    note = f"the robot's map; cells of {spec.resolution_m * 1000:g} mm; white free, grey unknown, black occupied"
    axes = _paper(title, known_box(spec, occupancy), note)
    axes.imshow(occupancy, cmap=_EVIDENCE, vmin=0, vmax=255, extent=_extent(spec), origin="lower", interpolation="none")
    for x_m, y_m in stops_m:
        axes.plot(x_m, y_m, "o", markersize=4.5, color=_PATH, markeredgecolor="white", markeredgewidth=0.8)
    _save(axes, file)


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
    axes = _paper(title, box, f"white: no reading explained; black: {greatest} explained, the most")
    axes.imshow(
        rank, cmap="gray_r", vmin=0, vmax=max(greatest, 1), extent=_extent(spec), origin="lower", interpolation="none"
    )
    if obstacles is not None:
        _overlay(axes, spec, obstacles)
    if truth is not None:
        _robot(axes, truth)
    if estimate is not None:
        axes.plot(estimate.x_m, estimate.y_m, "+", markersize=15, markeredgewidth=2.0, color=_ESTIMATE)
    _legend(axes, truth=truth is not None, estimate=estimate is not None)
    _save(axes, file)


def known_box(spec: GridSpec, occupancy: NDArray[np.uint8], margin_m: float = 0.3) -> Box:
    """Return the part of the map that holds more than one value, with a margin; the whole map if there is none."""
    known = np.argwhere(occupancy != occupancy[0, 0])
    if not len(known):
        known = np.array([[0, 0], [spec.rows - 1, spec.cols - 1]])
    (row_min, col_min), (row_max, col_max) = known.min(axis=0), known.max(axis=0)
    x_min, y_min = spec.centre_of(row_min - 0.5, col_min - 0.5)
    x_max, y_max = spec.centre_of(row_max + 0.5, col_max + 0.5)
    return x_min - margin_m, y_min - margin_m, x_max + margin_m, y_max + margin_m


def bar_length_m(width_m: float) -> float:
    """Return a round length of about a fifth of a width.

    >>> [bar_length_m(width_m) for width_m in (4.0, 9.0, 30.0)]
    [1.0, 2.0, 5.0]
    """
    decade = 10.0 ** math.floor(math.log10(width_m / 5.0))
    steps = [decade * step for step in (*_NICE_STEPS, 10.0)]
    return min(steps, key=lambda length: abs(length - width_m / 5.0))


def _extent_m(wall: Points) -> float:
    return float(np.ptp(wall, axis=0).max())


def _stop(axes: Axes, number: int, x_m: float, y_m: float, robot_radius_m: float) -> None:
    if robot_radius_m:
        axes.add_patch(Circle((x_m, y_m), robot_radius_m, facecolor=_PATH, alpha=0.16, edgecolor="none", zorder=3))
    axes.plot(x_m, y_m, "o", markersize=15, color="white", markeredgecolor=_PATH, markeredgewidth=1.8, zorder=4)
    axes.text(x_m, y_m, str(number), ha="center", va="center_baseline", fontsize=8.5, color=_INK, zorder=5)


def _extent(spec: GridSpec) -> tuple[float, float, float, float]:
    x_min, y_min = spec.centre_of(-0.5, -0.5)
    x_max, y_max = spec.centre_of(spec.rows - 0.5, spec.cols - 0.5)
    return x_min, x_max, y_min, y_max


def _paper(title: str, box: Box, note: str) -> Axes:
    """Return empty axes to scale over a box, with a title, a line that explains, and a bar in metres."""
    x_min, y_min, x_max, y_max = (float(edge) for edge in box)
    pad = 0.03 * max(x_max - x_min, y_max - y_min)
    width, height = x_max - x_min + 2 * pad, y_max - y_min + 2 * pad
    scale = _LONG_SIDE_INCH / max(width, height)
    size = (max(width * scale, 5.0), height * scale + 1.1)
    figure = Figure(figsize=size, dpi=_DPI, facecolor="white")
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.02, 0.6 / size[1], 0.96, height * scale / size[1]))
    axes.set_aspect("equal")
    axes.set(xlim=(x_min - pad, x_max + pad), ylim=(y_min - pad, y_max + pad), xticks=[], yticks=[])
    axes.set_facecolor("#f3f5f6")
    for spine in axes.spines.values():
        spine.set_visible(False)
    left = axes.get_position().x0
    figure.text(left, 1.0 - 0.36 / size[1], title, fontsize=15, fontweight="bold", color=_INK)
    figure.text(left, 0.22 / size[1], note, fontsize=9, color=_QUIET)
    _scale_bar(axes, width, size)
    return axes


def _scale_bar(axes: Axes, width_m: float, size: tuple[float, float]) -> None:
    """Draw the bar under the right corner, outside the picture: it covers nothing."""
    length = bar_length_m(width_m)
    right, _ = axes.get_xlim()[1], axes.get_ylim()[0]
    transform = axes.get_xaxis_transform()
    below = -0.2 / (axes.get_position().height * size[1])
    bar = LineCollection([[(right - length, below), (right, below)]], colors=_INK, linewidths=3, transform=transform)
    bar.set_clip_on(False)
    axes.add_collection(bar, autolim=False)
    label = f"{length:g} m"
    axes.text(
        right - length / 2, 1.7 * below, label, transform=transform, ha="center", va="top", fontsize=9, color=_INK
    )


def _overlay(axes: Axes, spec: GridSpec, obstacles: NDArray[np.bool_]) -> None:
    """Lay the obstacles over the ranks in a colour that no rank has."""
    tint = np.zeros((*obstacles.shape, 4))
    tint[obstacles] = (0.36, 0.62, 0.78, 1.0)
    axes.imshow(tint, extent=_extent(spec), origin="lower", interpolation="none")


def _robot(axes: Axes, mark: Mark) -> None:
    pose = mark.pose
    nose = pose.transform(mark.radius_m, 0.0)
    axes.add_patch(Circle((pose.x_m, pose.y_m), mark.radius_m, fill=False, edgecolor=_TRUTH, linewidth=2.0))
    axes.plot([pose.x_m, nose[0]], [pose.y_m, nose[1]], color=_TRUTH, linewidth=2.0, solid_capstyle="round")


def _legend(axes: Axes, *, truth: bool, estimate: bool) -> None:
    """Say beside the title what the marks mean: there it covers nothing."""
    marks = [("o", "true robot, to scale", _TRUTH)] * truth + [("+", "estimate", _ESTIMATE)] * estimate
    handles = [
        Line2D(
            [],
            [],
            marker=sign,
            label=label,
            color=colour,
            linestyle="",
            markersize=11,
            markerfacecolor="none",
            markeredgewidth=2,
        )
        for sign, label, colour in marks
    ]
    if handles:
        axes.legend(
            handles=handles,
            loc="lower right",
            bbox_to_anchor=(1.0, 1.0),
            ncols=2,
            frameon=False,
            fontsize=9,
            labelcolor=_INK,
        )


def _save(axes: Axes, file: Path) -> None:
    figure = axes.get_figure()
    assert isinstance(figure, Figure)
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, format="png")
