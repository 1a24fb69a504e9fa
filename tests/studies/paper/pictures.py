"""A test as the paper shows it, side by side: the hand-drawn map, the robot's map, the localization ([BrownDonald2000]_
figs. 23, 24, 26-31)."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading
from robotd.grid.occupancy import OccupancyGrid
from tests.studies.paper.exact import exact_panel
from tests.studies.paper.robot import ROBOT_RADIUS_M
from tests.studies.paper.rooms import Room, Test
from tests.studies.paper.trials import Outcome

Panel = tuple[str, Callable[[Axes], None]]
"""What stands below it, and what draws it."""

_INK = "#22303c"
_FURNITURE = "#b9c4cc"
_ROBOT = "#c8102e"
_BEST = "#0b63ce"
_STOPS = "#d9822b"
_SIDE_INCH = 3.6
_DPI = 100


def draw_test(
    file: Path, test: Test, truth: Pose2, grid: OccupancyGrid, outcome: Outcome, counted: Sequence[RangeReading]
) -> None:
    """Draw one test: the circle is the true robot, to scale; arrows point at the regions of black cells.

    Beside the robot's answer stands that of the exact algorithm to the same readings, on the walls as they are.
    """
    consistent = f"black: {outcome.consistent} of {outcome.counted} readings consistent"
    panels: tuple[Panel, ...] = (
        ("(a) hand-drawn map, with the stops", lambda axes: _hand_drawn(axes, test.room)),
        ("(b) the robot's map", lambda axes: _cells(axes, grid, grid.cells, 255)),
        (f"(c) localization; {consistent}", lambda axes: _localization(axes, grid, outcome)),
        exact_panel(test.room, counted, truth.heading_rad),
    )
    draw_panels(file, f"Test {test.number}: {test.room.name}, {test.probes} probes", test.room, truth, panels)


def draw_panels(file: Path, title: str, room: Room, truth: Pose2, panels: tuple[Panel, ...]) -> None:
    """Draw panels of the same part of the map side by side, the true robot in all of them."""
    figure = Figure(figsize=(len(panels) * _SIDE_INCH, _SIDE_INCH + 0.75), dpi=_DPI, facecolor="white")
    FigureCanvasAgg(figure)
    figure.suptitle(title, color=_INK, fontsize=12, fontweight="bold", y=0.985)
    every = figure.subplots(1, len(panels), squeeze=False)[0]
    figure.subplots_adjust(left=0.005, right=0.995, bottom=0.08, top=0.91, wspace=0.02)
    for axes, (caption, draw) in zip(every, panels, strict=True):
        draw(axes)
        _frame(axes, room, caption)
        axes.add_patch(
            Circle((truth.x_m, truth.y_m), ROBOT_RADIUS_M, fill=False, edgecolor=_ROBOT, linewidth=1.3, zorder=9)
        )
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, format="png", metadata={"Software": None})


def _frame(axes: Axes, room: Room, caption: str) -> None:
    spec = room.spec
    middle = np.array(spec.centre_of((spec.rows - 1) / 2, (spec.cols - 1) / 2))
    (left, bottom), (right, top) = (middle + sign * room.crop_cells / 2 * spec.resolution_m for sign in (-1, 1))
    axes.set(xlim=(left, right), ylim=(bottom, top), xticks=[], yticks=[], aspect="equal")
    axes.set_xlabel(caption, fontsize=8.5, color=_INK)


def _hand_drawn(axes: Axes, room: Room) -> None:
    walls = sorted(room.world.wall, key=lambda wall: -float(np.ptp(np.array(wall.points_m), axis=0).max()))
    for number, wall in enumerate(walls):
        face = _FURNITURE if number else "white"
        axes.add_patch(Polygon(wall.points_m, closed=True, facecolor=face, edgecolor=_INK, linewidth=1.2))
    start = room.world.start_pose
    x_m, y_m = np.array(((start.x_m, start.y_m), *room.stops_m)).T
    axes.plot(x_m, y_m, "D", markersize=3.5, color=_STOPS, markeredgewidth=0)


def _localization(axes: Axes, grid: OccupancyGrid, outcome: Outcome) -> None:
    _cells(axes, grid, outcome.rank, outcome.consistent)
    for centre_m in outcome.centres_m:
        axes.annotate(
            "",
            centre_m,
            xytext=(9, 9),
            textcoords="offset points",
            arrowprops={"arrowstyle": "->", "color": _BEST, "linewidth": 1.1, "shrinkB": 2},
        )


def _cells(axes: Axes, grid: OccupancyGrid, cells: NDArray[np.uint8] | NDArray[np.uint16], most: int) -> None:
    """Draw a grid, white for 0 and black for the most."""
    spec = grid.spec
    left, bottom = spec.centre_of(-0.5, -0.5)
    right, top = spec.centre_of(spec.rows - 0.5, spec.cols - 0.5)
    extent = (left, right, bottom, top)
    axes.imshow(cells, cmap="gray_r", vmin=0, vmax=most, extent=extent, origin="lower", interpolation="none")
