"""Best poses and rivals by bounds, nothing known, and within a prior; the map prepared, whole and after a sweep."""

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.pose_set import PoseSet
from robotd.grid.readings import Readings
from robotd.grid.wall_field import WallField
from robotd.grid.window import CellWindow
from robotd.localization.even_headings import even_headings
from robotd.localization.fit.refinement import PoseBox, refine
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.obstacles.levels import Levels
from robotd.localization.search.bounded_search import SearchMap, best_poses
from robotd.localization.search.cell_disk import CellDisk
from tests.benchmarks import workload
from tests.benchmarks.sections.refining import DRAWN
from tests.benchmarks.timing import Timing, timed

HEADINGS = 300
SLACK, LEAST_RANK = 45, 150
_RIGHT_M, _RIGHT_RAD = 0.15, math.radians(2.0)


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A pose, and what is measured there."""

    pose: Pose2
    readings: Readings


def timings() -> Iterator[Timing]:
    """Workloads S and L."""
    for name, occupied, spec, goal_ms, prepare_ms in (
        ("S", workload.room(), workload.SPEC, 8.0, 2.0),
        ("L", workload.building(), workload.LARGE, 90.0, 20.0),
    ):
        obstacles = Obstacles.of(occupied, workload.ERROR_RADIUS_CELLS)
        levels = Levels.of(obstacles, spec, workload.ERROR_RADIUS_CELLS)
        ready = SearchMap.of(levels)
        poses = workload.poses_in(occupied, 200)
        cases = [
            Case(pose, Readings.of(workload.sweep_of(occupied, 100 + number, pose).measured))
            for number, pose in enumerate(poses)
        ]
        yield _everywhere(name, ready, WallField.of(spec, occupied, occupied), cases, goal_ms)
        yield _two_threads(name, ready, cases[0])
        yield _tracking(name, ready, cases[0])
        yield timed(f"{name}, map made ready to search", partial(SearchMap.of, levels), 5)
        row, col = (size // 2 for size in spec.shape)
        again = partial(ready.updated, levels, CellWindow(row - 60, row + 60, col - 60, col + 60))
        yield timed(f"{name}, ready again where 120 x 120 cells changed", again, 9, goal_ms=prepare_ms)


def _everywhere(name: str, ready: SearchMap, field: WallField, cases: list[Case], goal_ms: float) -> Timing:
    """Search, and refine the best; what is right is told of the cells, how far off of what was refined."""
    headings_rad, seconds, right, errors_m = np.array(even_headings(HEADINGS)), [], 0, []
    for case in cases:
        begin = time.perf_counter()
        found = best_poses(ready, case.readings, headings_rad, slack=SLACK, least_rank=LEAST_RANK)
        refined = refine(field, case.readings, [_box(found, ready.spec)], DRAWN).pose(0) if found.best_rank else None
        seconds.append(time.perf_counter() - begin)
        right += _is_right(found, ready.spec, case.pose)
        errors_m += [] if refined is None else [refined.distance_m(case.pose)]
    title = (
        f"{name}, best pose and rivals, nothing known, {HEADINGS} headings, {workload.READINGS} readings, one thread; "
        "the best refined"
    )
    note = f"{right} of {len(cases)} best poses right; refined: mean {1e3 * np.mean(errors_m):.1f} mm off"
    return Timing(title, tuple(seconds), goal_ms, f"{note}, greatest {1e3 * np.max(errors_m):.1f}")


def _box(found: PoseSet, spec: GridSpec) -> PoseBox:
    """Return a cell and a step of the headings to all sides of the first of the best."""
    heading, row, col = found.poses[found.ranks == found.best_rank][0].tolist()
    step_rad = math.tau / HEADINGS
    return PoseBox.around(Pose2(*spec.centre_of(row, col), heading * step_rad), spec.resolution_m, step_rad)


def _is_right(found: PoseSet, spec: GridSpec, pose: Pose2) -> bool:
    """Whether all poses of greatest rank lie by the truth."""
    best = found.poses[found.ranks == found.best_rank]
    x_m = spec.origin_x_m + (best[:, 2] + 0.5) * spec.resolution_m
    y_m = spec.origin_y_m + (best[:, 1] + 0.5) * spec.resolution_m
    turned_rad = (best[:, 0] * (math.tau / HEADINGS) - pose.heading_rad + math.pi) % math.tau - math.pi
    near = (np.hypot(x_m - pose.x_m, y_m - pose.y_m) < _RIGHT_M) & (np.abs(turned_rad) < _RIGHT_RAD)
    return len(best) > 0 and bool(near.all())


def _two_threads(name: str, ready: SearchMap, case: Case) -> Timing:
    headings_rad = np.array(even_headings(HEADINGS))
    run = partial(best_poses, ready, case.readings, headings_rad, slack=SLACK, least_rank=LEAST_RANK, threads=2)
    return timed(f"{name}, one of these, two threads", run, 15)


def _tracking(name: str, ready: SearchMap, case: Case) -> Timing:
    headings_rad = np.array([case.pose.heading_rad + k * (math.tau / HEADINGS) for k in range(-8, 9)])
    prior = CellDisk(case.pose.y_m / workload.RESOLUTION_M - 0.5, case.pose.x_m / workload.RESOLUTION_M - 0.5, 6.0)
    run = partial(best_poses, ready, case.readings, headings_rad, slack=SLACK, least_rank=LEAST_RANK, prior=prior)
    return timed(f"{name}, best poses within 0.3 m and 10 deg of a prior, by cells", run, 200)
