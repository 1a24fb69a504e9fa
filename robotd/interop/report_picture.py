"""The map, the way and what was found on it, as one SVG that stands by itself in a page."""

import base64
from collections.abc import Iterator
from html import escape

import numpy as np

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.ways import PlannedStop, StopState
from robotd.core.grid_spec import GridSpec
from robotd.grid.tables import NO_INFORMATION
from robotd.interop.mission_facts import MissionFacts
from robotd.interop.plain_png import grey_png

_WIDTH_PX = 900
_MARGIN_M = 0.5
_MARK_SHARE = 0.012
"""Of the longer side: how large a mark is."""
_COLOURS = {StopState.SWEPT: "#1f5fbf", StopState.UNREACHED: "#c8590a"}
"""Blue to orange, which nobody takes for each other; the marks differ in shape, too."""


def picture(facts: MissionFacts) -> str:
    """Return the SVG; empty if no map was in use."""
    spec = facts.spec
    if spec is None or facts.cells.shape != spec.shape:
        return ""
    width_m, height_m = spec.cols * spec.resolution_m, spec.rows * spec.resolution_m
    left_m, top_m, shown_width_m, shown_height_m = _shown(facts, spec)
    mark_m = _MARK_SHARE * max(shown_width_m, shown_height_m)
    marks = "".join(_marks(facts, spec, mark_m))
    height_px = round(_WIDTH_PX * shown_height_m / shown_width_m)
    return (
        f'<svg viewBox="{left_m:.3f} {top_m:.3f} {shown_width_m:.3f} {shown_height_m:.3f}"'
        f' width="{_WIDTH_PX}" height="{height_px}" role="img">'
        "<title>The map, the way driven, stops and looks round</title>"
        f'<image href="{_data_uri(facts)}" width="{width_m:.3f}" height="{height_m:.3f}"'
        f' style="image-rendering:pixelated" preserveAspectRatio="none"/>{marks}</svg>'
    )


def _shown(facts: MissionFacts, spec: GridSpec) -> tuple[float, float, float, float]:
    """Return left, top, width and height of what is known or marked, with a margin, as places of the picture."""
    rows, cols = np.nonzero(facts.cells != NO_INFORMATION)
    corners = zip((rows.min(), rows.max()), (cols.min(), cols.max()), strict=True) if len(rows) else ()
    known_m = [spec.centre_of(int(row), int(col)) for row, col in corners]
    stops_m = [(stop.x_m, stop.y_m) for span in facts.missions.values() if span.plan for stop in span.plan.stops]
    way_m = [point for way in facts.ways_m for point in way]
    points_m = [*known_m, *stops_m, *way_m] or [spec.centre_of(spec.rows // 2, spec.cols // 2)]
    x_m, y_m = zip(*(_at(spec, *point) for point in points_m), strict=True)
    left_m, top_m = min(x_m) - _MARGIN_M, min(y_m) - _MARGIN_M
    return left_m, top_m, max(x_m) + _MARGIN_M - left_m, max(y_m) + _MARGIN_M - top_m


def _data_uri(facts: MissionFacts) -> str:
    # Dark is what is occupied; a picture begins at the largest y.
    png = grey_png(255 - facts.cells[::-1])
    return f"data:image/png;base64,{base64.b64encode(png).decode()}"


def _marks(facts: MissionFacts, spec: GridSpec, mark_m: float) -> Iterator[str]:
    for way_m in facts.ways_m:
        points = " ".join("{:.3f},{:.3f}".format(*_at(spec, *point)) for point in way_m)
        yield f'<polyline points="{points}" fill="none" stroke="#1f5fbf" stroke-width="{mark_m / 3:.4f}"/>'
    for span in facts.missions.values():
        for number, stop in enumerate(span.plan.stops if span.plan else ()):
            yield _stop(spec, number, stop, mark_m)
    for look in facts.looks:
        yield from _look(spec, look, mark_m)


def _stop(spec: GridSpec, number: int, stop: PlannedStop, mark_m: float) -> str:
    x, y = _at(spec, stop.x_m, stop.y_m)
    colour = _COLOURS.get(stop.state, "#666666")
    title = escape(f"stop {number}: {stop.state}" + (f", {stop.reason}" if stop.reason else ""))
    shape = (
        f'<path d="M{x - mark_m:.3f} {y - mark_m:.3f}l{2 * mark_m:.3f} {2 * mark_m:.3f}'
        f'm0 {-2 * mark_m:.3f}l{-2 * mark_m:.3f} {2 * mark_m:.3f}"'
        if stop.state is StopState.UNREACHED
        else f'<circle cx="{x:.3f}" cy="{y:.3f}" r="{mark_m:.3f}"'
    )
    return f'{shape} fill="none" stroke="{colour}" stroke-width="{mark_m / 3:.4f}"><title>{title}</title>{_end(shape)}'


def _end(shape: str) -> str:
    return "</path>" if shape.startswith("<path") else "</circle>"


def _look(spec: GridSpec, look: PoseEstimate, mark_m: float) -> Iterator[str]:
    """Yield a square at each place that it came to: full if that was the only one."""
    fill = "#1f5fbf" if look.state is PoseState.LOCALIZED else "none"
    for pose in [look.best] if look.best is not None else [region.pose for region in look.regions]:
        x, y = _at(spec, pose.x_m, pose.y_m)
        yield (
            f'<rect x="{x - mark_m / 2:.3f}" y="{y - mark_m / 2:.3f}" width="{mark_m:.3f}" height="{mark_m:.3f}"'
            f' fill="{fill}" stroke="#c8590a" stroke-width="{mark_m / 6:.4f}"><title>{escape(str(look))}</title></rect>'
        )


def _at(spec: GridSpec, x_m: float, y_m: float) -> tuple[float, float]:
    return x_m - spec.origin_x_m, spec.origin_y_m + spec.rows * spec.resolution_m - y_m
