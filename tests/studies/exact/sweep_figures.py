"""Figs. 32 and 33 of [BrownDonald2000]_: what the sweep line meets, and how deep the plane is covered."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from robotd.cli.pictures.exact_sets import fill, outline
from robotd.exact.arrangement import Arrangement
from robotd.exact.planar import PlanarSet, area_within, segment
from robotd.exact.points import Point
from robotd.exact.polygons import ring_of
from robotd.exact.rationals import rational
from robotd.exact.sweep import arrange

_INK, _LINE, _RED, _BLUE = "#22303c", "#c8102e", "#d9822b", "#0b63ce"
_SHOWN = (2, 5, 8)
"""Events of fig. 32, counted from the left."""

SEGMENTS = {
    "a": (("0", "1"), ("6", "4")),
    "b": (("1", "4"), ("5", "1")),
    "c": (("0.5", "2.5"), ("7", "2")),
    "d": (("2", "0.3"), ("6.5", "0.8")),
    "e": (("3", "4.5"), ("7", "3.2")),
}

POLYGONS = {
    "A": ring_of([(0, 1), (4, 0), (5, 3), (1, 4)]),
    "B": ring_of([(3, 1), (7, 1), (7, 3), (3, 3)]),
    "C": ring_of([(2, 2), (6, 2), (4, 5)]),
    "D": ring_of([(5, 0), (8, 2), ("6.5", 4)]),
    "E": ring_of([("0.5", "2.5"), (3, "2.5"), (3, 5), ("0.5", 5)]),
}
_RED_ONES = "ACD"
_NAMES = {"A": (1.9, 1.1), "B": (3.3, 1.15), "C": (4.0, 4.6), "D": (7.4, 2.1), "E": (0.7, 4.7)}
"""Where their names stand."""


def draw_sweep(file: Path) -> None:
    """Draw the sweep line at three events, and what it meets there from top to bottom."""
    arrangement = arrange([_segment(*ends) for ends in SEGMENTS.values()])
    figure, axes = _sheet()
    for (x, y), (end_x, end_y) in SEGMENTS.values():
        axes.plot([float(x), float(end_x)], [float(y), float(end_y)], color=_INK, linewidth=1.6)
    for name, ((x, y), _) in SEGMENTS.items():
        axes.text(float(x) - 0.2, float(y), name, color=_INK)
    for number in _SHOWN:
        at = arrangement.vertices[number].point
        axes.plot([at.x_float] * 2, [-0.2, 5.0], color=_LINE, linewidth=1.0)
        axes.plot(*at.floats, "o", color=_LINE)
        axes.text(at.x_float, 5.1, "\n".join(_met(arrangement, number)), ha="center", va="bottom", color=_LINE)
    axes.set(xlim=(-0.6, 7.6), ylim=(-0.2, 6.6))
    axes.set_title("at three events: the sweep line, and what it goes on with, topmost first", fontsize=10, loc="left")
    _save(figure, file)


def _segment(start: Sequence[str], end: Sequence[str]) -> PlanarSet:
    ends = [Point(rational(x), rational(y)) for x, y in (start, end)]
    return PlanarSet((segment(ends[0], ends[1], on=True, left=False, right=False),))


def _met(arrangement: Arrangement, number: int) -> list[str]:
    """Return the segments that the line meets just right of an event, topmost first."""
    crossing = [edge for edge in arrangement.edges if edge.start <= number < edge.end]
    at = arrangement.vertices[number].point
    crossing.sort(key=lambda edge: float(edge.support.height(at.x)), reverse=True)
    names = list(SEGMENTS)
    return [names[edge.mask.bit_length() - 1] for edge in crossing]


def draw_depths(file: Path) -> None:
    """Draw by how many polygons each face is covered: of all colours, and of red and blue apart."""
    arrangement = arrange([area_within([ring], closed=True) for ring in POLYGONS.values()])
    red = sum(1 << number for number, name in enumerate(POLYGONS) if name in _RED_ONES)
    figure = Figure(figsize=(12.0, 4.6), dpi=110, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2)
    _shade(left, arrangement, ~0, _INK)
    left.set_title("depth of coverage: the darker the deeper", fontsize=10, loc="left")
    _shade(right, arrangement, red, _RED)
    _shade(right, arrangement, ~red, _BLUE)
    right.set_title("A, C, D red, B, E blue: a depth for each colour", fontsize=10, loc="left")
    for axes in (left, right):
        for name, ring in POLYGONS.items():
            outline(axes, area_within([ring], closed=True), _INK)
            axes.text(*_NAMES[name], name, color=_INK, fontweight="bold", ha="center", va="center")
        axes.set(xlim=(-0.5, 8.5), ylim=(-0.5, 5.5), xticks=[], yticks=[], aspect="equal")
    _save(figure, file)


def _shade(axes: Axes, arrangement: Arrangement, colours: int, ink: str) -> None:
    for depth in range(1, len(POLYGONS) + 1):
        fill(axes, arrangement.select(partial(_is_deep, depth, colours)), ink, alpha=0.25)


def _is_deep(least: int, colours: int, mask: int) -> bool:
    return (mask & colours).bit_count() >= least


def _sheet() -> tuple[Figure, Axes]:
    figure = Figure(figsize=(8.0, 6.0), dpi=110, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    axes.set(xticks=[], yticks=[], aspect="equal")
    return figure, axes


def _save(figure: Figure, file: Path) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file)
