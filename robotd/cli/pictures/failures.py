"""Pictures of the cases that were not right: the map, the scan where it was taken and where it was sought.

Needs the extra ``plots``.
"""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from robotd.cli.pictures.sheet import ESTIMATE, PATH, TRUTH, Points, evidence, known_box, legend, paper, save
from robotd.core.pose import Pose2
from robotd.evaluation.report import LogReport
from robotd.evaluation.verdict import Case

_POINTER = 0.04
"""Length of what shows a heading, as a share of the picture's width."""


def draw_failures(directory: Path, report: LogReport) -> None:
    """Draw each failure of a log into a file of its own, named by log, scan and verdict."""
    name = report.log.split(".")[0]
    for case in report.failures:
        file = directory / f"{name}-{case.query.number:05}-{case.verdict}.png"
        axes = _map(f"{name}, scan {case.query.number}: {case.verdict.replace('_', ' ')}", report, case)
        _answers(axes, case)
        save(axes, file)


def _map(title: str, report: LogReport, case: Case) -> Axes:
    estimate, spec, cells = case.estimate, report.grid.spec, report.grid.cells
    off = "" if case.error_m is None else f", {case.error_m:.2f} m off"
    share = f"{estimate.best_rank or 'too few'} of {estimate.readings} readings explained"
    note = f"{share}, {len(estimate.regions)} regions{off}"
    axes = paper(title, known_box(spec, cells), note)
    evidence(axes, spec, cells, opacity=0.6)
    return axes


def _answers(axes: Axes, case: Case) -> None:
    """Draw the scan where it was taken and where the best answer has it, and all other answers."""
    answers = [region.centre for region in case.estimate.regions]
    claimed = case.estimate.best or (answers[0] if answers else None)
    rivals = answers[1:]
    _scan(axes, case, case.truth, TRUTH)
    _pointer(axes, case.truth, TRUTH, "o")
    if claimed is not None:
        _scan(axes, case, claimed, ESTIMATE)
        _pointer(axes, claimed, ESTIMATE, "x")
    for rival in rivals:
        _pointer(axes, rival, PATH, "^")
    legend(axes, [("o", "truth", TRUTH), ("x", "claimed", ESTIMATE), ("^", f"{len(rivals)} rivals", PATH)])


def _scan(axes: Axes, case: Case, laser: Pose2, colour: str) -> None:
    points_m = _points_m(case, laser)
    axes.plot(points_m[:, 0], points_m[:, 1], ".", markersize=2.0, color=colour)


def _points_m(case: Case, laser: Pose2) -> Points:
    """Return where the beams that met something would have met it, map frame, ``float64[n, 2]``."""
    scan = case.query.scan
    angles_rad = scan.angles_rad[scan.hit] + laser.heading_rad
    steps = np.stack((np.cos(angles_rad), np.sin(angles_rad)), axis=1)
    points_m: Points = np.array([laser.x_m, laser.y_m]) + scan.ranges_m[scan.hit, None] * steps
    return points_m


def _pointer(axes: Axes, pose: Pose2, colour: str, sign: str) -> None:
    """Draw a place and which way it looks, at a size that is seen on any map."""
    left, right = axes.get_xlim()
    nose = pose.transform(_POINTER * (right - left), 0.0)
    axes.plot([pose.x_m, nose[0]], [pose.y_m, nose[1]], color=colour, linewidth=1.5, solid_capstyle="round")
    axes.plot(pose.x_m, pose.y_m, sign, markersize=9, markerfacecolor="none", markeredgewidth=1.8, color=colour)
