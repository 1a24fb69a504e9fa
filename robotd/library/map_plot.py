"""A map and what is believed on it, drawn with matplotlib (extra ``plots``)."""

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.patches import Circle as CirclePatch

from robotd.contract.estimate import PoseEstimate
from robotd.core.pose import Pose2
from robotd.grid.occupancy import OccupancyGrid
from robotd.library.explanation import Explanation

_EXPLAINED, _UNEXPLAINED, _ANSWER = "#0b63ce", "#d9822b", "#c8102e"
"""Told apart by those who cannot tell red from green."""


def plot_map(
    grid: OccupancyGrid, estimate: PoseEstimate | None, explanation: Explanation | None, axes: Axes | None
) -> Axes:
    """Draw a map, white free, grey unknown, black occupied; +x to the right, +y up, both in metres.

    Of an estimate each region's circle and best pose; of an explanation the readings' ends by whether they are
    explained.
    """
    drawn = plt.subplots(layout="constrained")[1] if axes is None else axes
    spec = grid.spec
    left_m, low_m = spec.origin_x_m, spec.origin_y_m
    extent = (left_m, left_m + spec.cols * spec.resolution_m, low_m, low_m + spec.rows * spec.resolution_m)
    drawn.imshow(grid.cells, cmap="gray_r", vmin=0, vmax=255, extent=extent, origin="lower", interpolation="none")
    drawn.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
    if explanation is not None:
        _ends(drawn, explanation)
    if estimate is not None:
        drawn.set_title(str(estimate), fontsize="small")
        for region in estimate.regions:
            circle = region.circle
            drawn.add_patch(CirclePatch((circle.x_m, circle.y_m), circle.radius_m, fill=False, color=_ANSWER))
            _arrow(drawn, region.pose, 0.05 * (extent[1] - extent[0]))
    return drawn


def _ends(axes: Axes, explanation: Explanation) -> None:
    colours = np.where(explanation.explained, _EXPLAINED, _UNEXPLAINED)
    x_m, y_m = explanation.heads_m.T
    axes.scatter(x_m, y_m, s=6, c=colours, zorder=3)


def _arrow(axes: Axes, pose: Pose2, length_m: float) -> None:
    tip = pose.transform(length_m, 0.0)
    axes.annotate("", xy=tip, xytext=(pose.x_m, pose.y_m), arrowprops={"arrowstyle": "->", "color": _ANSWER})
