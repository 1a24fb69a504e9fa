"""Refinement below the cell, tracking from a prior, and the wall field made ready again."""

import math
import time
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid import kernels
from robotd.grid.kernels.twins import TWINS
from robotd.grid.readings import Readings
from robotd.grid.wall_field import WallField
from robotd.grid.window import CellWindow
from robotd.localization.fit.refinement import DISTANCES, Heads, PoseBox, expected_ranges, refine
from robotd.localization.fit.refinement_settings import RefinementSettings, Walls
from robotd.localization.fit.tracking import Tracked, TrackingSettings, track
from tests.benchmarks import workload
from tests.benchmarks.timing import Timing, timed

DRAWN = RefinementSettings(walls=Walls.FACES, map_error_m=0.0, map_error_rad=0.0)
"""The workloads' cells are the truth."""
POSES = 200
PRIOR_M, PRIOR_RAD = 0.3, math.radians(10.0)
RIGHT_M = 0.05

Query = tuple[Readings, Pose2]


def timings() -> Iterator[Timing]:
    """Workloads S and L: 200 random poses, headings too."""
    for name, occupied, spec, goals in (
        ("S", workload.room(), workload.SPEC, (5.0, 0.5)),
        ("L", workload.building(), workload.LARGE, (6.0, 4.0)),
    ):
        field = WallField.of(spec, occupied, occupied)
        poses = workload.poses_in(occupied, POSES)
        queries = [
            (Readings.of(workload.sweep_of(occupied, seed, pose).measured), pose) for seed, pose in enumerate(poses)
        ]
        yield from refining(name, field, queries, goal_mm=goals[0])
        yield from tracking(name, field, queries)
        yield from ready_again(name, spec, occupied, goal_ms=goals[1])


def refining(room: str, field: WallField, queries: list[Query], *, goal_mm: float) -> Iterator[Timing]:
    """From a start up to half a cell and half a degree off, within one cell and one degree."""
    random = np.random.default_rng(0)
    half_m, half_rad = field.spec.resolution_m / 2, math.radians(0.5)

    def one(query: Query) -> float:
        readings, truth = query
        start = _off(truth, random, half_m, half_rad)
        box = PoseBox.around(start, 2 * half_m, 2 * half_rad)
        return refine(field, readings, [box], DRAWN).pose(0).distance_m(truth)

    yield _each(f"{room}, a pose refined: refine(); goal {goal_mm:g} mm", one, queries)
    readings, truth = queries[0]
    box = PoseBox.around(truth, half_m, half_rad)
    heads = Heads.of(readings, field.spec.resolution_m).at_cells
    at = np.array([truth.x_m, truth.y_m, truth.heading_rad])
    for count in (1, 50):
        yield timed(f"{room}, {count} boxes: refine()", partial(refine, field, readings, [box] * count, DRAWN), 50)
        ranges = partial(expected_ranges, field, readings, np.tile(at, (count, 1)), 1)
        yield timed(f"{room}, {count} poses: expected_ranges()", ranges, 50)
    start = np.array([at[0] / 0.05 + 0.4, at[1] / 0.05 - 0.3, at[2] + 0.005])
    boxes = np.concatenate((start, start - 1.0, start + 1.0))[None]
    for name, module in (("in use", kernels.in_use()), ("NumPy twin", TWINS)):
        fit = partial(module.fit.fit_poses, field.codes, DISTANCES[Walls.FACES], heads, boxes, 4.0)
        yield timed(f"{room}, one box, kernel, {name}", fit, 20)


def tracking(room: str, field: WallField, queries: list[Query]) -> Iterator[Timing]:
    """From a prior within 0.3 m and 10 degrees: the whole call."""
    random = np.random.default_rng(0)

    def one(query: Query) -> float:
        readings, truth = query
        prior = PoseBox.around(_off(truth, random, PRIOR_M, PRIOR_RAD), PRIOR_M, PRIOR_RAD)
        found = track(field, readings, prior, TrackingSettings(), DRAWN)
        return found.pose.distance_m(truth) if isinstance(found, Tracked) else math.inf

    yield _each(f"{room}, prior within 0.3 m and 10 deg: track(); goal 5 mm", one, queries, goal_ms=0.2)


def ready_again(room: str, spec: GridSpec, occupied: NDArray[np.bool_], *, goal_ms: float) -> Iterator[Timing]:
    """The field of a map, and after a sweep of 6 m changed it round its middle."""
    field = WallField.of(spec, occupied, occupied)
    middle, reach = spec.rows // 2, min(120, spec.rows // 2)
    changed = CellWindow(middle - reach, middle + reach, middle - reach, middle + reach)
    size = f"{(field.codes.nbytes + field.skips.nbytes) / occupied.size:.2f} bytes a cell"
    whole = timed(f"{room}, wall field made whole", partial(WallField.of, spec, occupied, occupied), 30)
    yield Timing(whole.name, whole.seconds, note=size)
    renew = partial(field.updated, occupied, occupied, changed)
    yield timed(f"{room}, wall field after a sweep of 6 m", renew, 30, goal_ms=goal_ms)


def _off(pose: Pose2, random: np.random.Generator, half_m: float, half_rad: float) -> Pose2:
    x, y, turn = random.uniform(-1.0, 1.0, 3).tolist()
    return Pose2(pose.x_m + half_m * x, pose.y_m + half_m * y, pose.heading_rad + half_rad * turn)


def _each(
    name: str, error_of: Callable[[Query], float], queries: list[Query], *, goal_ms: float | None = None
) -> Timing:
    """Time every query once, and say how far the answers are from the truth [mm]."""
    error_of(queries[0])
    seconds, errors_m = [], []
    for query in queries:
        begin = time.perf_counter()
        errors_m.append(error_of(query))
        seconds.append(time.perf_counter() - begin)
    right = np.array(errors_m)[np.array(errors_m) < RIGHT_M]
    note = (
        f"right {100 * len(right) / len(queries):.1f} % of {len(queries)}; error mean {1e3 * right.mean():.1f} mm, "
        f"90 % {1e3 * np.percentile(right, 90):.1f}, greatest {1e3 * right.max():.1f}"
    )
    return Timing(name, tuple(seconds), goal_ms, note)
