"""Cells on squared paper: what the figures of the paper's algorithms are drawn with."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from robotd.localization.reference.floods import UNREACHED

Mask = NDArray[np.bool_]

OBSTACLE, FIRST, SECOND, BOTH = "#5b6770", "#9cc9e8", "#f3b562", "#b7d98c"
INK, RED = "#22303c", "#c8102e"
_LINES = "#d5dbe0"


def sheet(axes: Axes, shape: tuple[int, ...]) -> None:
    """Rule a sheet of cells."""
    rows, cols = shape
    axes.set(xlim=(0, cols), ylim=(0, rows), aspect="equal", xticks=range(cols + 1), yticks=range(rows + 1))
    axes.grid(color=_LINES, linewidth=0.5)
    axes.set_axisbelow(True)
    axes.tick_params(length=0, labelbottom=False, labelleft=False)


def fill(axes: Axes, cells: Mask, colour: str) -> None:
    """Fill cells."""
    for row, col in np.argwhere(cells).tolist():
        axes.add_patch(Rectangle((col, row), 1, 1, facecolor=colour, edgecolor="white", linewidth=0.4))


def shade(axes: Axes, numbers: NDArray[np.int32]) -> None:
    """Fill cells by their numbers, in two shades in turn."""
    for number in range(int(numbers.max()) + 1):
        fill(axes, numbers == number, FIRST if number % 2 else "#dcecf7")


def write(axes: Axes, numbers: NDArray[np.int32]) -> None:
    """Write the numbers of cells that have one."""
    for row, col in np.argwhere(numbers != UNREACHED).tolist():
        axes.text(
            col + 0.5, row + 0.45, str(numbers[row, col]), ha="center", va="center", fontsize=5.5, color=INK, zorder=7
        )


def arrow(axes: Axes, start: tuple[float, float], head: tuple[float, float], colour: str = RED) -> None:
    """Draw a vector, ``(x, y)`` in cells."""
    axes.annotate("", head, start, arrowprops={"arrowstyle": "->", "color": colour, "linewidth": 1.4, "shrinkA": 0})
