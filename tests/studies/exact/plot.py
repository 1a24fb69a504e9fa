"""Pictures of what ``make exact`` measures."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from robotd.cli.pictures.exact_sets import box_of, draw_ranks
from robotd.exact.feasible import PolygonMap, ranked
from robotd.exact.rationals import rational
from tests.studies.exact.growth import STEP_M, Growth
from tests.studies.exact.scenes import laboratory, readings

_COLOURS = ("#0b63ce", "#d9822b", "#2e7d32")
_STYLES = {"0": "o-", "0.05": "s:"}


def draw_growth(file: Path, edges: Sequence[Growth], many: Sequence[Growth]) -> None:
    """Draw time and s against edges and against readings, both axes logarithmic, beside what the theorems allow."""
    figure = Figure(figsize=(13.0, 8.4), dpi=110, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    (time_by_n, time_by_m), (s_by_n, s_by_m) = figure.subplots(2, 2)
    for eps, style in _STYLES.items():
        own = [row for row in edges if row.eps == eps]
        sizes = [row.edges for row in own]
        _time(time_by_n, sizes, own, style, f"eps {eps} m")
        s_by_n.plot(sizes, [row.crossings for row in own], style, color=_COLOURS[0], label=f"s, eps {eps} m")
        for colour, n in zip(_COLOURS, sorted({row.edges for row in many}), strict=False):
            own = [row for row in many if row.eps == eps and row.edges == n]
            sizes = [row.readings for row in own]
            _time(time_by_m, sizes, own, style, f"n {n}, eps {eps} m", colour)
            s_by_m.plot(sizes, [row.crossings for row in own], style, color=colour, label=f"s, n {n}, eps {eps} m")
    _finish(time_by_n, "one reading: time; dashed: (n + s) log n", "n", "s")
    _finish(time_by_m, "many readings: time; dashed: (m n^2 + s) log m n, fitted to the first", "m", "s")
    _finish(s_by_n, "one reading: s, the points where borders meet or cross", "n", "")
    _finish(s_by_m, "many readings: s", "m", "")
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file)


def _time(
    axes: Axes, sizes: Sequence[int], rows: Sequence[Growth], style: str, label: str, colour: str = _COLOURS[0]
) -> None:
    axes.plot(sizes, [row.seconds for row in rows], style, color=colour, label=label)
    scale = rows[0].seconds / rows[0].promise
    axes.plot(sizes, [scale * row.promise for row in rows], "--", color=colour, alpha=0.35)


def _finish(axes: Axes, title: str, size: str, unit: str) -> None:
    sizes = sorted({float(x) for line in axes.get_lines() for x in np.asarray(line.get_xdata())})
    axes.set(xlabel=size, ylabel=unit, xscale="log", yscale="log")
    axes.set_xticks(sizes, [f"{x:g}" for x in sizes])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_title(title, fontsize=10, loc="left")
    axes.legend(fontsize=8)
    axes.grid(alpha=0.3)


def draw_laboratory(file: Path) -> None:
    """Draw the rank of 24 rounded readings everywhere in the laboratory, and where the robot really is."""
    walls, pose = laboratory()
    ranks = ranked(PolygonMap(walls, rational("0.1")), readings(walls, pose, 24, step_m=STEP_M))
    draw_ranks(file, "24 readings, eps 0.1 m", walls, ranks, box=box_of(walls), truth_m=pose.floats)
