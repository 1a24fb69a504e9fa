"""Pictures of maps in the making, as PNG files (needs the extra ``plots``): the way, the stops, what is open, loops."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.collections import LineCollection
from numpy.typing import NDArray

from robotd.cli.pictures.sheet import (
    ESTIMATE,
    PATH,
    TRUTH,
    Points,
    evidence,
    known_box,
    legend,
    numbered_stop,
    paper,
    save,
)
from robotd.contract.explored import WHYS, LeftOpen
from robotd.contract.ways import Point
from robotd.core.grid_spec import GridSpec


def draw_explored(
    file: Path,
    title: str,
    spec: GridSpec,
    occupancy: NDArray[np.uint8],
    *,
    stops_m: Sequence[Point],
    way_m: Points,
    left: Sequence[LeftOpen],
) -> None:
    """Draw a map as it was made: the way driven, the stops in their order, and what is left open with the reason.

    Args:
        file: the PNG to write.
        title: what to write above.
        spec: where the map lies.
        occupancy: ``uint8[rows, cols]``.
        stops_m: where the robot stopped, in order.
        way_m: the way it went, ``float64[n, 2]``.
        left: openings into the unknown that it did not look behind.
    """
    colours = f"cells of {spec.resolution_m * 1000:g} mm; white free, grey unknown, black occupied"
    meant = [f"{why.replace('_', ' ')}: {WHYS.get(why, why)}" for why in sorted({opening.why for opening in left})]
    note = "\n".join((colours, *meant))
    axes = paper(title, known_box(spec, occupancy), note)
    evidence(axes, spec, occupancy)
    axes.plot(way_m[:, 0], way_m[:, 1], color=PATH, linewidth=1.6, zorder=3, solid_joinstyle="round")
    for number, (x_m, y_m) in enumerate(stops_m):
        numbered_stop(axes, number, x_m, y_m)
    middle_m = sum(axes.get_xlim()) / 2.0
    for opening in left:
        axes.plot(opening.x_m, opening.y_m, "D", markersize=9, markerfacecolor="none", color=TRUTH, zorder=6)
        # Towards the middle, where there is room for words.
        is_left = opening.x_m < middle_m
        axes.annotate(
            f"{opening.width_m:.1f} m, {opening.why.replace('_', ' ')}",
            (opening.x_m, opening.y_m),
            (7 if is_left else -7, 5),
            textcoords="offset points",
            horizontalalignment="left" if is_left else "right",
            fontsize=7.5,
            color=TRUTH,
            zorder=6,
        )
    legend(axes, [("D", "left open", TRUTH)] if left else [])
    save(axes, file)


def draw_stops(
    file: Path,
    title: str,
    note: str,
    spec: GridSpec,
    occupancy: NDArray[np.uint8],
    *,
    way_m: Points,
    loops_m: Sequence[tuple[Point, Point]] = (),
) -> None:
    """Draw a map of many stops: the way from stop to stop, and the loops that tie them.

    Args:
        file: the PNG to write.
        title: what to write above.
        note: what to write below.
        spec: where the map lies.
        occupancy: ``uint8[rows, cols]``.
        way_m: the stops in order, ``float64[n, 2]``.
        loops_m: the ends of each loop that was closed.
    """
    axes = paper(title, known_box(spec, occupancy), note)
    evidence(axes, spec, occupancy)
    axes.plot(way_m[:, 0], way_m[:, 1], color=PATH, linewidth=1.0, marker=".", markersize=2.5, zorder=3)
    axes.add_collection(LineCollection(list(loops_m), colors=ESTIMATE, linewidths=1.6, zorder=4), autolim=False)
    legend(axes, [("_", "loops closed", ESTIMATE)] if loops_m else [])
    save(axes, file)
