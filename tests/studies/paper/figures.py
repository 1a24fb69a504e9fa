"""Figs. 4, 6 and 14-20 of [BrownDonald2000]_, drawn by the functions that carry its rasterized algorithms out."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon, Rectangle

from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.footprints import dilate, disk_footprint
from robotd.grid.translation import translated
from robotd.localization.reference.directional_flood import directional_flood
from robotd.localization.reference.flooded_poses import (
    flooded_blocked_set,
    flooded_endpoint_set,
    flooded_feasible_poses,
)
from robotd.localization.reference.floods import UNREACHED, Metric, flood
from robotd.localization.reference.pixelized_vector import ray_offsets
from robotd.localization.reference.probe import Probe, probe_of
from tests.studies.paper.poses_figures import POSES_FIGURES
from tests.studies.paper.sheet import BOTH, FIRST, INK, OBSTACLE, RED, SECOND, Mask, arrow, fill, shade, sheet, write

EPS = 2
"""Error radius of figs. 17-20, in cells."""
BEARING_RAD = np.radians(24.0)
LENGTH_CELLS = 11.0


def shape_m() -> Mask:
    """Return the map M of figs. 17-20, ``bool[rows, cols]``."""
    cells = np.zeros((20, 26), np.bool_)
    cells[13:17, 15:21] = True
    cells[11:13, 18:21] = True
    cells[4:6, 20:23] = True
    return cells


def probe_z() -> Probe:
    """Return the probe z of figs. 17-20, drawn as localization draws it."""
    reading = RangeReading(0, float(BEARING_RAD), ReadingStatus.OK, LENGTH_CELLS)
    return probe_of(reading, 0.0, resolution_m=1.0, error_radius_cells=EPS + 0.5, reach_cells=1000)


def draw_figures(directory: Path) -> None:
    """Write one picture for each figure."""
    for name, (title, panels) in FIGURES.items():
        figure = Figure(figsize=(4.1 * len(panels), 3.9), dpi=90, facecolor="white")
        FigureCanvasAgg(figure)
        figure.suptitle(title, fontsize=10, fontweight="bold", color=INK, y=0.98)
        every = figure.subplots(1, len(panels), squeeze=False)[0]
        figure.subplots_adjust(left=0.01, right=0.99, bottom=0.09, top=0.9, wspace=0.04)
        for axes, (caption, draw) in zip(every, panels, strict=True):
            draw(axes)
            axes.set_xlabel(caption, fontsize=8, color=INK)
        figure.savefig(directory / f"{name}.png", format="png", metadata={"Software": None})


def _convolved(axes: Axes) -> None:
    p = np.zeros((14, 18), np.bool_)
    p[6:10, 7:12] = True
    p[10:12, 10:12] = True
    q = np.zeros((7, 7), np.bool_)
    q[3, 3] = q[3, 4] = q[4, 5] = q[4, 6] = True
    sheet(axes, p.shape)
    fill(axes, dilate(p, q[::-1, ::-1]), FIRST)
    fill(axes, p, OBSTACLE)
    for row, col in np.argwhere(q).tolist():
        axes.add_patch(Rectangle((col - 3, row - 3), 1, 1, facecolor=SECOND, edgecolor=INK, linewidth=0.6))


def _contours(metric: Metric) -> Callable[[Axes], None]:
    def draw(axes: Axes) -> None:
        sources = np.zeros((18, 18), np.bool_)
        sources[7:9, 6:12] = True
        sources[9:12, 9] = True
        numbers = flood(sources, metric, limit=5)
        sheet(axes, sources.shape)
        shade(axes, numbers)
        fill(axes, sources, OBSTACLE)
        write(axes, np.where(sources, UNREACHED, numbers))

    return draw


def _octagons(axes: Axes) -> None:
    sources = np.zeros((23, 23), np.bool_)
    sources[11, 11] = True
    numbers = flood(sources, Metric.OCTAGON, limit=10)
    sheet(axes, sources.shape)
    shade(axes, numbers)
    write(axes, numbers)
    for radius in (2, 5, 8, 10):
        axes.add_patch(Circle((11.5, 11.5), radius + 0.5, fill=False, edgecolor=RED, linewidth=1.0, zorder=6))


def _grazing(axes: Axes) -> None:
    """Fig. 16 (a): a vector that begins at the edge of an object and leads out of it, and whose cells lie in it."""
    corners = np.array([(1.0, 1.0), (15.0, 5.6), (15.0, 1.0)])
    rows, cols = np.mgrid[:9, :18]
    left, right = corners[0], corners[1]
    slope = (right[1] - left[1]) / (right[0] - left[0])
    below = rows + 0.5 <= left[1] + slope * (cols + 0.5 - left[0]) + 0.5
    solid = below & (rows >= 1) & (cols >= 1) & (cols < 15)
    start, angle = np.array((3.5, left[1] + slope * 2.5 + 0.05)), float(np.arctan(slope)) + 0.03
    chain = ray_offsets(angle, 10.0) + np.floor(start[::-1]).astype(np.intp)
    body = np.zeros_like(solid)
    body[tuple(chain.T)] = True
    sheet(axes, solid.shape)
    fill(axes, solid, OBSTACLE)
    fill(axes, body, FIRST)
    fill(axes, body & solid, BOTH)
    axes.add_patch(Polygon(corners, closed=True, fill=False, edgecolor=INK, linewidth=1.2, zorder=6))
    arrow(axes, tuple(start), tuple(start + 10.0 * np.array((np.cos(angle), np.sin(angle)))))


def _overlap_of_chains(axes: Axes) -> None:
    """Fig. 16 (b): a chain, and its copy one cell on in the dominant direction."""
    chain = ray_offsets(float(np.arctan2(5, 12)), 13.0)
    one, other = (np.zeros((9, 18), np.bool_) for _ in range(2))
    one[chain[:, 0] + 1, chain[:, 1] + 1] = True
    other[chain[:, 0] + 1, chain[:, 1] + 2] = True
    sheet(axes, one.shape)
    fill(axes, one & ~other, FIRST)
    fill(axes, other & ~one, SECOND)
    fill(axes, one & other, BOTH)
    axes.plot([1.5, 2.5], [1.5, 1.5], "*", color=INK, markersize=8)


def _corner(axes: Axes) -> None:
    """Two obstacle cells that touch at a corner: the flood numbers what the look-ahead would miss."""
    chain = np.array([(0, 0), (0, 1), (1, 2), (1, 3), (1, 4), (1, 5)])
    sources = np.zeros((3, 7), np.bool_)
    sources[2, 6] = sources[1, 5] = True
    numbers = directional_flood(sources, chain)
    missed = np.zeros_like(sources)
    missed[1, 1:4] = True
    sheet(axes, sources.shape)
    fill(axes, numbers != UNREACHED, FIRST)
    fill(axes, missed, SECOND)
    fill(axes, sources, OBSTACLE)
    write(axes, np.where(sources, UNREACHED, numbers))


def _map_and_probe(axes: Axes) -> None:
    probe, tail = probe_z(), np.array((3, 2))
    body, ball = (np.zeros_like(shape_m()) for _ in range(2))
    body[tuple((probe.body + tail).T)] = True
    assert probe.head is not None
    ball[probe.head[0] + tail[0], probe.head[1] + tail[1]] = True
    ball = dilate(ball, disk_footprint(EPS + 0.5))
    sheet(axes, body.shape)
    fill(axes, ball, SECOND)
    fill(axes, body, FIRST)
    fill(axes, shape_m(), OBSTACLE)
    along = LENGTH_CELLS * np.array((np.cos(BEARING_RAD), np.sin(BEARING_RAD)))
    start = tail[::-1] + 0.5
    arrow(axes, tuple(start), tuple(start + along))


def _endpoints(axes: Axes) -> None:
    probe = probe_z()
    assert probe.head is not None
    moved = translated(shape_m(), *probe.head, outside=0)
    numbers = flood(moved, Metric.OCTAGON, limit=EPS)
    sheet(axes, moved.shape)
    fill(axes, numbers != UNREACHED, SECOND)
    fill(axes, shape_m(), OBSTACLE)
    write(axes, numbers)


def _blocked(axes: Axes) -> None:
    numbers = directional_flood(shape_m(), probe_z().body)
    sheet(axes, numbers.shape)
    fill(axes, numbers != UNREACHED, FIRST)
    fill(axes, shape_m(), OBSTACLE)
    write(axes, numbers)


def _feasible(axes: Axes) -> None:
    # On a wide margin of free cells, so that the paper's obstacle outside the grid is out of reach.
    margin, window = 30, (slice(30, -30), slice(30, -30))
    occupied, probe = np.pad(shape_m(), margin), probe_z()
    assert probe.head is not None
    endpoints = flooded_endpoint_set(occupied, probe.head, EPS)[window]
    feasible = flooded_feasible_poses(occupied, probe, EPS)[window]
    assert np.array_equal(feasible, endpoints & ~flooded_blocked_set(occupied, probe.body)[window])
    sheet(axes, feasible.shape)
    fill(axes, endpoints, "#f7e3c8")
    fill(axes, feasible, BOTH)
    fill(axes, shape_m(), OBSTACLE)
    moved = translated(shape_m(), *probe.head, outside=0)
    write(axes, np.where(feasible, flood(moved, Metric.OCTAGON, limit=EPS), UNREACHED))


FIGURES: dict[str, tuple[str, tuple[tuple[str, Callable[[Axes], None]], ...]]] = {
    **POSES_FIGURES,
    "fig-14": (
        "Fig. 14: discrete convolution",
        (("P grey, Q orange; blue and grey: their Minkowski difference", _convolved),),
    ),
    "fig-15": (
        "Fig. 15: floods, number by number",
        (
            ("(a) L1: 4 neighbours", _contours(Metric.L1)),
            ("(a) L infinity: 8 neighbours", _contours(Metric.L_INFINITY)),
            ("(b) octagons: 8, 4, 4 in turn; red: L2 circles", _octagons),
        ),
    ),
    "fig-16": (
        "Fig. 16: the directional flood, and why a look-ahead",
        (
            ("(a) out of the object, but its cells (green) are in it", _grazing),
            ("(b) a chain (blue) and its copy one cell on (orange); green: both", _overlap_of_chains),
            ("obstacles touch at a corner; orange: what the look-ahead misses", _corner),
        ),
    ),
    "fig-17": ("Fig. 17: M, z, eps", (("blue: the body of z, orange: its head and eps round it", _map_and_probe),)),
    "fig-18": ("Fig. 18: D, M moved by -z and flooded", (("numbers: steps of the flood, eps = 2", _endpoints),)),
    "fig-19": ("Fig. 19: E, M flooded against z", (("numbers: how far along z the obstacle is met", _blocked),)),
    "fig-20": ("Fig. 20: FP = D - E", (("green: feasible; pale: in D, but under E", _feasible),)),
}
"""By file: a title, and panels with their captions."""
