"""The paper that all pictures are drawn on: a title, a note, a bar in metres, a legend; nothing of what they show.

Every picture is to scale, says so with the bar, and lies as the map lies: +x to the right, +y up (needs ``plots``).
"""

import io
import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle
from numpy.typing import NDArray

from robotd.cli.outputs import PNG, check, write
from robotd.core.grid_spec import GridSpec
from robotd.core.rectangle import Rectangle

Points = NDArray[np.float64]

INK = "#22303c"
_QUIET = "#6b7a86"
WALL = "#33414d"
FURNITURE = "#b9c4cc"
PATH = "#d9822b"
TRUTH = "#c8102e"
ESTIMATE = "#0b63ce"
_EVIDENCE = LinearSegmentedColormap.from_list("evidence", ["#ffffff", "#c3cad0", "#000000"])
_LONG_SIDE_INCH = 9.0
_DPI = 150
_NICE_STEPS = (1.0, 2.0, 5.0)


def known_box(spec: GridSpec, occupancy: NDArray[np.uint8], margin_m: float = 0.3) -> Rectangle:
    """Return the part of the map that holds more than one value, with a margin; the whole map if there is none."""
    known = np.argwhere(occupancy != occupancy[0, 0])
    if not len(known):
        known = np.array([[0, 0], [spec.rows - 1, spec.cols - 1]])
    (row_min, col_min), (row_max, col_max) = known.min(axis=0), known.max(axis=0)
    x_min, y_min = spec.centre_of(row_min - 0.5, col_min - 0.5)
    x_max, y_max = spec.centre_of(row_max + 0.5, col_max + 0.5)
    return Rectangle(x_min - margin_m, y_min - margin_m, x_max + margin_m, y_max + margin_m)


def bar_length_m(width_m: float) -> float:
    """Return a round length of about a fifth of a width.

    >>> [bar_length_m(width_m) for width_m in (4.0, 9.0, 30.0)]
    [1.0, 2.0, 5.0]
    """
    decade = 10.0 ** math.floor(math.log10(width_m / 5.0))
    steps = [decade * step for step in (*_NICE_STEPS, 10.0)]
    return min(steps, key=lambda length: abs(length - width_m / 5.0))


def extent_of(spec: GridSpec) -> tuple[float, float, float, float]:
    """Return the outer edges of a grid as matplotlib wants them: ``x_min_m, x_max_m, y_min_m, y_max_m``."""
    x_min, y_min = spec.centre_of(-0.5, -0.5)
    x_max, y_max = spec.centre_of(spec.rows - 0.5, spec.cols - 0.5)
    return x_min, x_max, y_min, y_max


def paper(title: str, box: Rectangle, note: str) -> Axes:
    """Return empty axes to scale over a box, with a title, a line that explains, and a bar in metres."""
    x_min, y_min, x_max, y_max = (float(edge) for edge in box)
    pad = 0.03 * max(x_max - x_min, y_max - y_min)
    width, height = x_max - x_min + 2 * pad, y_max - y_min + 2 * pad
    scale = _LONG_SIDE_INCH / max(width, height)
    size = (max(width * scale, 5.0), height * scale + 1.1)
    # Not through pyplot, which keeps every figure alive and may want a window.
    figure = Figure(figsize=size, dpi=_DPI, facecolor="white")
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.02, 0.6 / size[1], 0.96, height * scale / size[1]))
    axes.set_aspect("equal")
    axes.set(xlim=(x_min - pad, x_max + pad), ylim=(y_min - pad, y_max + pad))
    _ticks(axes)
    axes.set_facecolor("#f3f5f6")
    for spine in axes.spines.values():
        spine.set_visible(False)
    left = axes.get_position().x0
    figure.text(left, 1.0 - 0.36 / size[1], title, fontsize=15, fontweight="bold", color=INK)
    figure.text(left, 0.22 / size[1], note, fontsize=9, color=_QUIET)
    _scale_bar(axes, width, size)
    return axes


def _ticks(axes: Axes) -> None:
    """Say metres along both sides, within the picture: they cover little, and leave it as large as it was."""
    axes.tick_params(direction="in", length=3, labelsize=7, labelcolor=_QUIET, color=_QUIET)
    axes.tick_params(axis="x", pad=-12)
    axes.tick_params(axis="y", pad=-4)
    axes.xaxis.set_major_formatter("{x:g} m")
    axes.yaxis.set_major_formatter("{x:g} m")
    for label in axes.get_yticklabels():
        label.set_horizontalalignment("left")


def _scale_bar(axes: Axes, width_m: float, size: tuple[float, float]) -> None:
    """Draw the bar under the right corner, outside the picture: it covers nothing."""
    length = bar_length_m(width_m)
    right, _ = axes.get_xlim()[1], axes.get_ylim()[0]
    transform = axes.get_xaxis_transform()
    below = -0.2 / (axes.get_position().height * size[1])
    bar = LineCollection([[(right - length, below), (right, below)]], colors=INK, linewidths=3, transform=transform)
    bar.set_clip_on(False)
    axes.add_collection(bar, autolim=False)
    label = f"{length:g} m"
    axes.text(right - length / 2, 1.7 * below, label, transform=transform, ha="center", va="top", fontsize=9, color=INK)


def legend(axes: Axes, marks: list[tuple[str, str, str]]) -> None:
    """Say beside the title what the marks mean, ``(sign, label, colour)``: there it covers nothing."""
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
            ncols=len(handles),
            frameon=False,
            fontsize=9,
            labelcolor=INK,
        )


def save(axes: Axes, file: Path) -> None:
    """Write the paper to a PNG file, in a directory that is made if it is not there.

    Raises:
        RobotdError: a file is there that is no PNG, or it cannot be written.
    """
    figure = axes.get_figure()
    assert isinstance(figure, Figure)
    check(file, PNG)
    # Whole in memory first: a picture that failed half-way must not take the place of a good one.
    drawn = io.BytesIO()
    figure.savefig(drawn, format="png")
    write(file, drawn.getvalue())


def evidence(axes: Axes, spec: GridSpec, occupancy: NDArray[np.uint8], *, opacity: float = 1.0) -> None:
    """Lay a map ``uint8[rows, cols]`` on the paper: white is free, grey is unknown, black is occupied."""
    # A cell is shown as a cell: smoothed, it would look like evidence that nobody has.
    axes.imshow(
        occupancy,
        cmap=_EVIDENCE,
        vmin=0,
        vmax=255,
        extent=extent_of(spec),
        origin="lower",
        interpolation="none",
        alpha=opacity,
    )


def numbered_stop(axes: Axes, number: int, x_m: float, y_m: float, robot_radius_m: float = 0.0) -> None:
    """Mark where the robot stopped, with its number, and if a radius is given, how much room it takes."""
    if robot_radius_m:
        axes.add_patch(Circle((x_m, y_m), robot_radius_m, facecolor=PATH, alpha=0.16, edgecolor="none", zorder=3))
    axes.plot(x_m, y_m, "o", markersize=15, color="white", markeredgecolor=PATH, markeredgewidth=1.8, zorder=4)
    axes.text(x_m, y_m, str(number), ha="center", va="center_baseline", fontsize=8.5, color=INK, zorder=5)
