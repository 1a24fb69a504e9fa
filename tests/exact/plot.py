"""Pictures of what ``make exact`` measures."""

from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from robotd.cli.exact_pictures import box_of, draw_ranks
from robotd.localization.exact.feasible import PolygonMap, ranked
from robotd.localization.exact.planar import PlanarSet
from robotd.localization.exact.rationals import rational
from tests.exact.growth import STEP_M, Growth
from tests.exact.scenes import POSE, readings

_COLOURS = {"0": "#0b63ce", "0.05": "#d9822b"}


def draw_growth(file: Path, edges: Sequence[Growth], many: Sequence[Growth]) -> None:
    """Draw time against edges and against readings, both axes logarithmic, with lines of slope 1."""
    figure = Figure(figsize=(11.0, 4.6), dpi=120, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2)
    _growth(left, edges, "one reading: time by edges n", "n")
    _growth(right, many, "time by readings m", "m")
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file)


def _growth(axes: Axes, rows: Sequence[Growth], title: str, size: str) -> None:
    for eps, colour in _COLOURS.items():
        own = [row for row in rows if row.eps == eps]
        sizes = [row.size for row in own]
        axes.plot(sizes, [row.seconds for row in own], "o-", color=colour, label=f"time, eps {eps} m")
        unit = own[-1].seconds / (own[-1].seconds / own[-1].constant)
        work = [unit * row.seconds / row.constant for row in own]
        axes.plot(sizes, work, ":", color=colour, label=f"(N + s) log N, eps {eps} m")
        scale = own[0].seconds / own[0].bound
        axes.plot(sizes, [scale * row.bound for row in own], "--", color=colour, alpha=0.4, label="the theorem's bound")
    axes.set(title=title, xlabel=size, ylabel="s", xscale="log", yscale="log")
    axes.legend(fontsize=8)
    axes.grid(alpha=0.3)


def draw_laboratory(file: Path, walls: PlanarSet) -> None:
    """Draw the rank of 24 rounded readings everywhere in the laboratory, and where the robot really is."""
    ranks = ranked(PolygonMap(walls, rational("0.1")), readings(walls, POSE, 24, step_m=STEP_M))
    draw_ranks(file, "24 readings, eps 0.1 m", walls, ranks, box=box_of(walls), truth_m=POSE.floats)
