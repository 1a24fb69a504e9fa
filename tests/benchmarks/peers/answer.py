"""A peer answers the questions of a file: ``python answer.py PEER QUESTIONS``, in an environment that has the peer.

Prints JSON: a list of ``{"what", "tracking", "errors_m", "seconds"}``. Knows NumPy and the peer, and nothing of us.
"""

import importlib
import json
import math
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Questions = Mapping[str, NDArray[Any]]
Answer = dict[str, object]
Locate = Callable[[int], tuple[float, float, float]]
"""From the number of a question to ``(x, y)`` and the seconds it took, what must be prepared once not counted."""


def karto(questions: Questions) -> Iterator[Answer]:
    """OpenKarto's correlative scan matcher: matches a sweep with other sweeps, in a square and a range of headings."""
    library = importlib.import_module("karto_scanmatcher")
    count = questions["ranges"].shape[1]
    cut_off_m = float(questions["cut_off_m"])
    laser = library.LaserScanConfig(
        -math.pi, math.pi - math.tau / count, math.tau / count, 0.05, cut_off_m, cut_off_m - 0.01, ""
    )

    def scan(ranges: NDArray[np.float64], pose: NDArray[np.float64], number: int) -> Any:
        at = library.Pose2(*pose.tolist())
        return library.LocalizedRangeScan(laser, np.roll(ranges, count // 2).tolist(), at, at, number, 0.0)

    stops = [
        scan(*stop, number)
        for number, stop in enumerate(zip(questions["stop_ranges"], questions["stops"], strict=True))
    ]

    def matcher(
        resolution_m: float, smear_m: float, side_m: float, half_rad: float, starts: NDArray[np.float64]
    ) -> Locate:
        config = library.ScanMatcherConfig()
        config.resolution, config.smear_deviation = resolution_m, smear_m
        config.search_size, config.coarse_search_angle_offset = side_m, half_rad
        config.range_threshold = cut_off_m
        wrapper = library.Wrapper(config)

        def locate(number: int) -> tuple[float, float, float]:
            query = scan(questions["ranges"][number], starts[number], len(stops))
            begin = time.perf_counter()
            best = wrapper.match_scan(query, stops, False, True).best_pose
            return best.x, best.y, time.perf_counter() - begin

        return locate

    priors = questions["priors"]
    middle = np.tile((*_middle_m(questions), 0.0), (len(priors), 1))
    for resolution_m, smear_m in ((0.05, 0.1), (0.01, 0.03)):
        near = matcher(resolution_m, smear_m, 0.6, math.radians(10.0), priors)
        yield _asked(f"cells of {1000 * resolution_m:g} mm", questions, near, len(priors), tracking=True)
    anywhere = matcher(0.05, 0.1, 12.8, math.pi, middle)
    yield _asked("cells of 50 mm, all of them and all headings", questions, anywhere, 10, tracking=False)


def amcl(questions: Questions) -> Iterator[Answer]:
    """Nav2's particle filter with its beam model; it begins with a normal distribution, never with a uniform one."""
    library = importlib.import_module("amcl")
    cells = np.where(questions["occupied"], 100, 0).tolist()
    grid = library.create_occupancy_grid_from_list(cells, float(questions["resolution_m"]), 0.0, 0.0)
    bearings = math.tau * np.arange(questions["ranges"].shape[1]) / questions["ranges"].shape[1]
    motion = library.MotionParameters(alpha1=0.2, alpha2=0.2, alpha3=0.2, alpha4=0.2, alpha5=0.2)
    laser = library.LaserParameters(
        z_hit=0.5,
        z_short=0.05,
        z_max=0.05,
        z_rand=0.5,
        sigma_hit=0.2,
        lambda_short=0.1,
        chi_outlier=0.0,
        max_beams=60,
    )

    def particles(
        least: int, most: int, updates: int, starts: NDArray[np.float64], sigmas: tuple[float, ...]
    ) -> Locate:
        def locate(number: int) -> tuple[float, float, float]:
            localizer = library.AMCL(least, most, 0.0, 0.0, motion, laser, "omni")
            localizer.set_map(grid)
            localizer.set_laser_pose(library.Vector3D(0.0, 0.0, 0.0))
            variances = [sigma**2 for sigma in sigmas]
            start = library.Vector3D(*starts[number].tolist())
            localizer.set_initial_pose(start, library.create_diagonal_covariance(*variances))
            beams = np.stack((questions["ranges"][number], bearings), axis=1).tolist()
            scan = library.create_laser_scan_from_list(beams, float(questions["cut_off_m"]))
            begin = time.perf_counter()
            for _ in range(updates):
                localizer.update(scan, library.Vector3D(0.0, 0.0, 0.0))
            found = localizer.get_pose_mean()
            return found.x, found.y, time.perf_counter() - begin

        return locate

    priors = questions["priors"]
    near = (0.17, 0.17, math.radians(6.0))
    for updates in (1, 10):
        locate = particles(500, 2000, updates, priors, near)
        what = f"500 to 2000 particles, 60 beams, sweep given {updates} x"
        yield _asked(what, questions, locate, 40, tracking=True)
    middle = np.tile((*_middle_m(questions), 0.0), (len(priors), 1))
    anywhere = particles(2000, 20_000, 10, middle, (2.5, 2.5, 3.0))
    yield _asked("2000 to 20 000 particles, 60 beams, sweep given 10 x", questions, anywhere, 5, tracking=False)


def _middle_m(questions: Questions) -> tuple[float, float]:
    rows, cols = questions["occupied"].shape
    return cols / 2 * float(questions["resolution_m"]), rows / 2 * float(questions["resolution_m"])


def _asked(what: str, questions: Questions, locate: Locate, count: int, *, tracking: bool) -> Answer:
    errors_m, seconds = [], []
    for number in range(count):
        x_m, y_m, took_s = locate(number)
        true_x_m, true_y_m, _ = questions["poses"][number]
        errors_m.append(math.hypot(x_m - true_x_m, y_m - true_y_m))
        seconds.append(took_s)
    return {"what": what, "tracking": tracking, "errors_m": errors_m, "seconds": seconds}


if __name__ == "__main__":
    with np.load(sys.argv[2]) as file:
        asked = dict(file)
    print(json.dumps(list({"karto": karto, "amcl": amcl}[sys.argv[1]](asked))))
