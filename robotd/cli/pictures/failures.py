"""Pictures of the cases that were not right: the map, the scan where it was taken and where it was sought.

Needs the extra ``plots``.
"""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from robotd.cli.pictures.sheet import ESTIMATE, PATH, TRUTH, Points, evidence, known_box, legend, paper, save
from robotd.core.pose import Pose2
from robotd.evaluation.result import CaseResult
from robotd.evaluation.seeking import Seeking
from robotd.evaluation.verdict import CaseVerdict
from robotd.logs.scan import Scan

_POINTER = 0.04
"""Length of what shows a heading, as a share of the picture's width."""


def draw_failure(directory: Path, job: Seeking, scan: Scan, result: CaseResult) -> None:
    """Draw a case into a file of its own, named by log, scan and verdict, unless it is right."""
    if result.verdict is CaseVerdict.RIGHT:
        return
    name = job.log.split(".")[0]
    axes = _map(f"{name}, {job.protocol}, scan {result.key.scan}: {result.verdict.replace('_', ' ')}", job, result)
    _answers(axes, scan, result)
    save(axes, directory / f"{_file_name(job)}-{result.key.scan:05}-{result.verdict}.png")


def _file_name(job: Seeking) -> str:
    """Return what tells the pictures of one task from those of another."""
    usual = job.protocol == "interleaved"
    name = job.log.split(".")[0] if usual else f"{job.log.split('.')[0]}-{job.protocol.split('.')[0]}"
    return f"{name}-{round(1000 * job.grid.spec.resolution_m)}mm".replace("=", "-")


def _map(title: str, job: Seeking, result: CaseResult) -> Axes:
    spec, cells = job.grid.spec, job.grid.cells
    off = "" if result.error_m is None else f", {result.error_m:.2f} m off"
    share = f"{result.best_rank or 'too few'} of {result.readings} readings explained"
    axes = paper(title, known_box(spec, cells), f"{share}, {len(result.answers)} regions{off}")
    evidence(axes, spec, cells, opacity=0.6)
    return axes


def _answers(axes: Axes, scan: Scan, result: CaseResult) -> None:
    """Draw the scan where it was taken and where the best answer has it, and all other answers."""
    claimed = result.best or (result.answers[0] if result.answers else None)
    rivals = result.answers[1:]
    if result.truth is not None:
        _scan(axes, scan, result.truth, TRUTH)
        _pointer(axes, result.truth, TRUTH, "o")
    if claimed is not None:
        _scan(axes, scan, claimed, ESTIMATE)
        _pointer(axes, claimed, ESTIMATE, "x")
    for rival in rivals:
        _pointer(axes, rival, PATH, "^")
    legend(axes, [("o", "truth", TRUTH), ("x", "claimed", ESTIMATE), ("^", f"{len(rivals)} rivals", PATH)])


def _scan(axes: Axes, scan: Scan, laser: Pose2, colour: str) -> None:
    points_m = _points_m(scan, laser)
    axes.plot(points_m[:, 0], points_m[:, 1], ".", markersize=2.0, color=colour)


def _points_m(scan: Scan, laser: Pose2) -> Points:
    """Return where the beams that met something would have met it, map frame, ``float64[n, 2]``."""
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
