"""Pictures of exact sets: areas, segments, single points, and the rank of every face, to scale (needs ``plots``)."""

from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline

from robotd.cli.pictures.sheet import INK, TRUTH, paper, save
from robotd.core.rectangle import Rectangle
from robotd.exact.arrangement import Arrangement
from robotd.exact.closed_polylines import outline_loops, single_lines, single_points
from robotd.exact.feasible import best_rank, of_rank
from robotd.exact.planar import PlanarSet

SOLID = "#4a5763"
_BEST = "#0b63ce"
_SMALL = 1 / 200
"""What part of a picture's width is easily overlooked."""
_FAR_M = 1000.0
"""How far to fill a set that reaches to infinity; farther than any picture."""


def box_of(planar: PlanarSet, margin_m: float = 0.1) -> Rectangle:
    """Return a box around all borders of a set."""
    ends = [end.floats for border in planar.borders for end in (border.start, border.end)]
    xs, ys = [x for x, _ in ends] or [0.0], [y for _, y in ends] or [0.0]
    return Rectangle(min(xs) - margin_m, min(ys) - margin_m, max(xs) + margin_m, max(ys) + margin_m)


def fill(axes: Axes, planar: PlanarSet, colour: str, *, alpha: float = 1.0, zorder: float = 1.0) -> None:
    """Fill the areas of a set, and draw what else of it there is as lines and points."""
    loops = outline_loops(planar)
    if planar.far:
        west, south, east, north = box_of(planar, _FAR_M)
        loops.append([(west, south), (east, south), (east, north), (west, north)])
    outlines = [Outline([*loop, loop[0]], closed=True) for loop in loops]
    if outlines:
        whole = Outline.make_compound_path(*outlines)
        axes.add_patch(PathPatch(whole, facecolor=colour, edgecolor="none", alpha=alpha, zorder=zorder))
    lines = LineCollection(single_lines(planar), colors=colour, linewidths=2.0, alpha=alpha, zorder=zorder)
    axes.add_collection(lines, autolim=False)
    for x_m, y_m in single_points(planar):
        axes.plot(x_m, y_m, "o", markersize=5.0, color=colour, alpha=alpha, markeredgewidth=0.0, zorder=zorder)


def outline(axes: Axes, planar: PlanarSet, colour: str, *, zorder: float = 2.0, width: float = 1.0) -> None:
    """Draw the borders of a set's areas."""
    loops = [[*loop, loop[0]] for loop in outline_loops(planar)]
    axes.add_collection(LineCollection(loops, colors=colour, linewidths=width, zorder=zorder), autolim=False)


def draw_ranks(
    file: Path,
    title: str,
    obstacles: PlanarSet,
    ranks: Arrangement,
    *,
    box: Rectangle | None = None,
    truth_m: tuple[float, float] | None = None,
    least: int = 1,
) -> None:
    """Draw a map and over it how many readings hold where: darker is more, and blue is the most."""
    best = best_rank(ranks)
    fewer = f"; grey: fewer, from {least}, the darker the more" if least < best else ""
    note = f"exact; blue: all poses where {best} readings hold, the most{fewer}"
    box = box or box_of(obstacles)
    axes = paper(title, box, note)
    fill(axes, obstacles, SOLID, zorder=1.0)
    for rank in range(least, best):
        fill(axes, of_rank(ranks, rank), INK, alpha=min(0.5, 1.5 / best), zorder=2.0)
    if best > 0:
        poses = of_rank(ranks, best)
        fill(axes, poses, _BEST, zorder=3.0)
        _mark_small(axes, poses, (box.east_m - box.west_m) * _SMALL)
    if truth_m is not None:
        axes.plot(*truth_m, "o", markersize=16, markerfacecolor="none", markeredgecolor=TRUTH, markeredgewidth=2)
    save(axes, file)


def _mark_small(axes: Axes, planar: PlanarSet, size_m: float) -> None:
    """Put a dot where an area or a line of a set would be too small to be seen."""
    for line in (*outline_loops(planar), *single_lines(planar)):
        xs, ys = zip(*line, strict=True)
        if max(max(xs) - min(xs), max(ys) - min(ys)) < size_m:
            axes.plot(xs[0], ys[0], "o", markersize=5.0, color=_BEST, markeredgewidth=0.0, zorder=3.0)
