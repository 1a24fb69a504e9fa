"""Our own answers to the questions, one core."""

import math
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.grid.readings import Readings
from robotd.grid.wall_field import WallField
from robotd.localization.even_headings import even_headings
from robotd.localization.fit.refinement import PoseBox, refine
from robotd.localization.fit.refinement_settings import RefinementSettings, Walls
from robotd.localization.fit.tracking import Tracked, TrackingSettings, track
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.obstacles.levels import Levels
from robotd.localization.search.bounded_search import SearchMap, best_poses
from tests.benchmarks import workload
from tests.benchmarks.peers.questions import PRIOR_M, PRIOR_RAD, Questions

_HEADINGS = 300
_DRAWN = RefinementSettings(walls=Walls.FACES, map_error_m=0.0, map_error_rad=0.0)
"""The map is the truth, and its walls are the faces of its cells."""


def answers(questions: Questions) -> list[dict[str, object]]:
    """Return what :mod:`tests.benchmarks.peers.answer` prints for a peer."""
    field = WallField.of(workload.SPEC, questions.occupied, questions.occupied)
    radius_cells = workload.ERROR_RADIUS_CELLS
    search_map = SearchMap.of(Levels.of(Obstacles.of(questions.occupied, radius_cells), workload.SPEC, radius_cells))
    headings_rad = np.array(even_headings(_HEADINGS))

    def near(readings: Readings, prior: Pose2) -> Pose2 | None:
        box = PoseBox.around(prior, PRIOR_M, PRIOR_RAD)
        found = track(field, readings, box, TrackingSettings(), _DRAWN)
        return found.pose if isinstance(found, Tracked) else None

    def anywhere(readings: Readings, prior: Pose2) -> Pose2 | None:
        found = best_poses(search_map, readings, headings_rad, slack=0)
        boxes = [_box(pose, headings_rad) for pose in found.poses[:: 1 + len(found.poses) // 32].tolist()]
        refined = refine(field, readings, boxes, _DRAWN)
        return refined.pose(int(refined.residual_m.argmin()))

    return [
        _asked("track(), 300 readings", questions, near, tracking=True),
        _asked(f"best_poses() and refine(), 300 readings, {_HEADINGS} headings", questions, anywhere, tracking=False),
    ]


def _box(pose: list[int], headings_rad: NDArray[np.float64]) -> PoseBox:
    heading, row, col = pose
    x_m, y_m = workload.SPEC.centre_of(row, col)
    step_rad = math.tau / len(headings_rad)
    return PoseBox.around(Pose2(x_m, y_m, float(headings_rad[heading])), workload.RESOLUTION_M, step_rad)


def _asked(
    what: str, questions: Questions, locate: Callable[[Readings, Pose2], Pose2 | None], *, tracking: bool
) -> dict[str, object]:
    errors_m, seconds = [], []
    for pose, prior, sweep in zip(questions.poses, questions.priors, questions.sweeps, strict=True):
        readings = Readings.of(sweep.measured)
        begin = time.perf_counter()
        found = locate(readings, prior)
        seconds.append(time.perf_counter() - begin)
        errors_m.append(math.inf if found is None else found.distance_m(pose))
    return {"what": what, "tracking": tracking, "errors_m": errors_m, "seconds": seconds}
