"""Figs. 1, 5, 7-13, 32 and 33 of [BrownDonald2000]_, drawn by the functions that they explain."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from robotd.cli.pictures.exact_sets import box_of, fill, outline
from robotd.exact.beams import Beam
from robotd.exact.feasible import PolygonMap, feasible_poses, of_rank, ranked
from robotd.exact.planar import PlanarSet
from robotd.exact.polygons import Polygon, ring_of, solid
from robotd.exact.rationals import rational
from robotd.exact.sweep import arrange
from tests.studies.exact.scenes import crossed_bars, halving_readings
from tests.studies.exact.sweep_figures import draw_depths, draw_sweep

_MAP, _RED, _BLUE, _FEASIBLE, _INK = "#c3cad0", "#f3b562", "#9cc9e8", "#c8102e", "#22303c"

Panel = tuple[str, Callable[[Axes], None]]
"""What stands above it, and what draws it."""


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure of the paper."""

    name: str
    caption: str
    draw: Callable[[Path], None]


def draw_panels(file: Path, planar: PlanarSet, panels: Sequence[Panel], columns: int, *, margin: float = 0.3) -> None:
    """Draw panels that show the same part of the plane, in rows."""
    west, south, east, north = box_of(planar, margin)
    rows = -(-len(panels) // columns)
    size = (3.4 * columns, 3.4 * rows * (north - south) / (east - west) + 0.4 * rows)
    figure = Figure(figsize=size, dpi=110, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    for number, (title, draw) in enumerate(panels, 1):
        axes = figure.add_subplot(rows, columns, number)
        axes.set(xlim=(west, east), ylim=(south, north), xticks=[], yticks=[], aspect="equal")
        axes.set_title(title, fontsize=10, loc="left", color=_INK)
        draw(axes)
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file)


def blocked_set(polygon_map: PolygonMap, beam: Beam) -> PlanarSet:
    """Return E as one set."""
    return arrange(polygon_map.blocked_parts(beam)).select(bool)


# Fig. 1: a room that is not symmetric, and three readings taken in it.
ROOM_1 = solid(
    [Polygon(ring_of([(5, 0), (6, 0), (6, 1), (5, 1)]))], room=ring_of([(0, 0), (8, 0), (8, 5), (3, 5), (3, 4), (0, 4)])
)
READINGS_1 = {
    "x": Beam(rational(-2), rational(0)),
    "y": Beam(rational(0), rational(-1)),
    "z": Beam(rational(3), rational(0)),
}


def draw_1(file: Path) -> None:
    """Draw how three readings leave one point."""
    exact = PolygonMap(ROOM_1, rational(0))
    sets = {name: feasible_poses(exact, beam) for name, beam in READINGS_1.items()}
    x, y, z = READINGS_1
    both = arrange([sets[x], sets[y]]).select(lambda mask: mask == 0b11)
    all_of_them = of_rank(ranked(exact, list(READINGS_1.values())), 3)
    panels: list[Panel] = [("(a) the map M", partial(_feasible, PlanarSet()))]
    for letters, name, step in (("bc", x, None), ("de", y, ("f", "{x, y}", both)), ("gh", z, None)):
        panels.append((f"({letters[0]}) {name}", partial(_reading, READINGS_1[name])))
        panels.append((f"({letters[1]}) FP(M, {name})", partial(_feasible, sets[name])))
        if step is not None:
            panels.append((f"({step[0]}) FP(M, {step[1]})", partial(_feasible, step[2])))
    panels.append(("(i) FP(M, {x, y, z})", partial(_feasible, all_of_them)))
    draw_panels(file, ROOM_1, panels, 3)


def _feasible(planar: PlanarSet, axes: Axes) -> None:
    fill(axes, ROOM_1, _MAP)
    fill(axes, planar, _FEASIBLE, zorder=3.0)


def _reading(beam: Beam, axes: Axes) -> None:
    _arrow(axes, (4.0, 2.2), beam)


def _arrow(axes: Axes, start: tuple[float, float], beam: Beam) -> None:
    end = start[0] + float(beam.dx), start[1] + float(beam.dy)
    axes.annotate("", xy=end, xytext=start, arrowprops={"arrowstyle": "-|>", "color": _INK, "shrinkA": 0, "shrinkB": 0})


# Fig. 5: D, E and FP of one reading, over polygons that are not convex.
MAP_5 = solid(
    [
        Polygon(ring_of([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)])),
        Polygon(ring_of([(3, 3), (5, 2), (6, 4), (4, 5)])),
        Polygon(ring_of([(6, 0), (7, 0), ("6.5", "1.5")])),
    ]
)
READING_5 = Beam(rational("1.2"), rational("-0.5"))


def draw_5(file: Path) -> None:
    """Draw how FP comes of D and E."""
    exact = PolygonMap(MAP_5, rational(0))
    red, blue = exact.endpoint_set(READING_5), blocked_set(exact, READING_5)

    def shown(*, with_d: bool, with_e: bool, with_fp: bool) -> Callable[[Axes], None]:
        def draw(axes: Axes) -> None:
            fill(axes, MAP_5, _MAP, alpha=0.9)
            if with_d:
                fill(axes, red, _RED, alpha=0.6, zorder=2.0)
                outline(axes, red, _INK, zorder=4.0, width=0.6)
            if with_e:
                fill(axes, blue, _BLUE, alpha=0.75, zorder=3.0)
            if with_fp:
                fill(axes, feasible_poses(exact, READING_5), _FEASIBLE, zorder=5.0)
            if not with_d and not with_fp:
                _arrow(axes, (2.0, 2.6), READING_5)

        return draw

    panels: list[Panel] = [
        ("(a) M and z", shown(with_d=False, with_e=False, with_fp=False)),
        ("(b) D(M, z)", shown(with_d=True, with_e=False, with_fp=False)),
        ("(c) D(M, z) and E(M, z)", shown(with_d=True, with_e=True, with_fp=False)),
        ("(d) FP(M, z) = D - E", shown(with_d=False, with_e=False, with_fp=True)),
    ]
    draw_panels(file, MAP_5, panels, 2, margin=1.3)


# Figs. 7-11: three readings with an error radius among three squares.
MAP_7 = solid([Polygon(ring_of([(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)])) for x, y in ((0, 3), (4, 3), (2, 0))])
EPS_7 = rational("0.35")
READINGS_7 = (
    Beam(rational("-1.4"), rational("1.2")),
    Beam(rational("1.4"), rational("1.2")),
    Beam(rational(0), rational("-0.8")),
)
_ROBOT_7 = (2.5, 1.8)


def draw_7(file: Path) -> None:
    """Draw the map, the readings and their uncertain ends."""

    def draw(axes: Axes) -> None:
        fill(axes, MAP_7, _MAP)
        for number, beam in enumerate(READINGS_7, 1):
            end = _ROBOT_7[0] + float(beam.dx), _ROBOT_7[1] + float(beam.dy)
            axes.add_patch(Circle(end, float(EPS_7), facecolor="white", edgecolor=_FEASIBLE, alpha=0.6, zorder=2.0))
            _arrow(axes, _ROBOT_7, beam)
            axes.text(end[0] + 0.4, end[1], f"z{number}", color=_FEASIBLE, ha="left", va="center")

    draw_panels(file, MAP_7, [("M, z1 to z3 and their error radius", draw)], 1, margin=1.0)


def draw_one_of_7(number: int, file: Path) -> None:
    """Draw D_eps and E_eps of one of the readings: figs. 8 to 10."""
    polygon_map = PolygonMap(MAP_7, EPS_7)
    beam = READINGS_7[number]
    red, blue = polygon_map.endpoint_set(beam), blocked_set(polygon_map, beam)

    def draw(axes: Axes) -> None:
        fill(axes, red, _RED, alpha=0.8, zorder=2.0)
        fill(axes, blue, _BLUE, alpha=0.8, zorder=3.0)
        outline(axes, MAP_7, _INK, zorder=4.0, width=0.8)

    title = f"D (orange) and E (blue) of z{number + 1}; outlined: M"
    draw_panels(file, MAP_7, [(title, draw)], 1, margin=2.0)


def draw_11(file: Path) -> None:
    """Draw where all three hold, among the poses where each does."""
    polygon_map = PolygonMap(MAP_7, EPS_7)
    common = of_rank(ranked(polygon_map, READINGS_7), 3)

    def draw(axes: Axes) -> None:
        fill(axes, MAP_7, _MAP)
        for beam in READINGS_7:
            fill(axes, feasible_poses(polygon_map, beam), _RED, alpha=0.45, zorder=2.0)
        fill(axes, common, "white", zorder=3.0)
        outline(axes, common, _FEASIBLE, zorder=4.0, width=1.5)
        axes.plot(*_ROBOT_7, ".", color=_INK, zorder=5.0)

    draw_panels(file, MAP_7, [("white: FP(M, {z1, z2, z3}); dot: the robot", draw)], 1, margin=1.5)


def draw_12(file: Path) -> None:
    """Draw the map on which one reading is feasible in n^2 pieces, with and without an error radius."""
    walls, beam = crossed_bars(5)

    def shown(eps: str) -> Callable[[Axes], None]:
        def draw(axes: Axes) -> None:
            fill(axes, walls, _MAP)
            fill(axes, feasible_poses(PolygonMap(walls, rational(eps)), beam), _FEASIBLE, zorder=3.0)

        return draw

    draw_panels(file, walls, [("n = 40 edges, FP(M, z)", shown("0")), ("the same, eps = 0.05", shown("0.05"))], 2)


def draw_13(file: Path) -> None:
    """Draw readings that all cross each other."""
    walls, beams = halving_readings(6)

    def draw(axes: Axes) -> None:
        fill(axes, walls, _MAP)
        for beam in beams:
            _arrow(axes, (0.0, 0.0), beam)
            fill(axes, feasible_poses(PolygonMap(walls, rational(0)), beam), _FEASIBLE, zorder=3.0)

    draw_panels(file, walls, [("m = 6 readings and their FP(M, z)", draw)], 1)


FIGURES = (
    Picture("figure-01", "Fig. 1: three readings leave one point.", draw_1),
    Picture("figure-05", "Fig. 5: D, E and FP(M, z) = D - E; the edges of D that are in no open E survive.", draw_5),
    Picture("figure-07", "Fig. 7: a map, three readings, an error radius.", draw_7),
    Picture("figure-08", "Fig. 8: D and E of the first.", partial(draw_one_of_7, 0)),
    Picture("figure-09", "Fig. 9: D and E of the second.", partial(draw_one_of_7, 1)),
    Picture("figure-10", "Fig. 10: D and E of the third.", partial(draw_one_of_7, 2)),
    Picture("figure-11", "Fig. 11: where all three hold.", draw_11),
    Picture("figure-12", "Fig. 12: a map of n edges on which FP(M, z) has of the order of n^2 pieces.", draw_12),
    Picture("figure-13", "Fig. 13: m readings whose FP(M, z) cross in of the order of m^2 points.", draw_13),
    Picture("figure-32", "Fig. 32: the plane sweep at three events.", draw_sweep),
    Picture("figure-33", "Fig. 33: depth of coverage, all and by colour.", draw_depths),
)
