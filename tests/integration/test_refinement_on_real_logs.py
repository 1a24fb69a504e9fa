"""Real buildings, maps made of every second scan: a refined pose is nearer to the corrected one than its cell is."""

import math
from pathlib import Path

import numpy as np
import pytest

from robotd.core.pose import Pose2
from robotd.evaluation.division import interleaved
from robotd.evaluation.recorded import Reach, map_of, readings_of
from robotd.grid.readings import Readings
from robotd.grid.settings import GridSettings
from robotd.grid.ternary import TernaryMap
from robotd.grid.wall_field import WallField
from robotd.localization.fit.refinement import PoseBox, refine
from robotd.localization.fit.refinement_settings import RefinementSettings
from robotd.localization.fit.tracking import Tracked, TrackingSettings, track
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.obstacles.levels import Levels
from robotd.localization.obstacles.unknown_cells import UnknownCells
from robotd.localization.search.bounded_search import SearchMap, best_poses
from robotd.localization.search.cell_disk import CellDisk
from robotd.sim.buildings.log_file import read_log

pytestmark = [pytest.mark.slow, pytest.mark.real_data]

LOGS = {"intel": "intel/intel.corrected.log.gz", "fr079": "fr079/fr079.corrected.log.gz"}
ERROR_RADIUS_CELLS = 1.5
PRIOR_M, PRIOR_RAD = 0.3, math.radians(10.0)


REACH = Reach(range_max_m=20.0, clear_m=8.0)
TABLES = {"LILY's tables": GridSettings(), "gentler tables": GridSettings(raise_alpha=0.5, lower_alpha=0.9)}

NEARER = {"LILY's tables": 1.0, "gentler tables": 0.75}
"""LILY's tables forget a wall after one grazing beam: a map so thin tells no more than its cells."""


class Building:
    """One log, made ready."""

    def __init__(self, log: Path, settings: GridSettings) -> None:
        division = interleaved(read_log(log), cases=60, seed=0)
        ternary = TernaryMap.from_grid(map_of(division.map_scans, REACH, settings))
        obstacles = Obstacles.of_map(ternary, UnknownCells.BLOCKS_ONLY, ERROR_RADIUS_CELLS, blocked_by=2)
        self.spec = ternary.spec
        self.search = SearchMap.of(Levels.of(obstacles, ternary.spec, ERROR_RADIUS_CELLS))
        self.field = WallField.of(ternary.spec, ternary.occupied, obstacles.blocking)
        self.queries = [
            (Readings.of(readings_of(query.scan, REACH)), query.scan.laser_pose) for query in division.queries
        ]

    def best_cell(self, readings: Readings, near: Pose2) -> Pose2:
        """Return the middle of the poses that explain most readings, headings a third of a degree apart."""
        headings_rad = near.heading_rad + np.radians(np.arange(-9.0, 10.0) / 3.0)
        row, col = self.spec.cell_at(near.x_m, near.y_m)
        found = best_poses(self.search, readings, headings_rad, slack=0, prior=CellDisk(row, col, 8.0)).poses
        x_m, y_m = self.spec.centre_of(float(found[:, 1].mean()), float(found[:, 2].mean()))
        return Pose2(x_m, y_m, float(headings_rad[found[:, 0]].mean()))


def somewhere_near(pose: Pose2, random: np.random.Generator, half_m: float, half_rad: float) -> Pose2:
    x, y, turn = random.uniform(-1.0, 1.0, 3).tolist()
    return Pose2(pose.x_m + half_m * x, pose.y_m + half_m * y, pose.heading_rad + half_rad * turn)


@pytest.mark.parametrize("tables", TABLES)
@pytest.mark.parametrize("name", LOGS)
def test_a_refined_pose_is_nearer_than_its_cell_and_tracking_finds_it(laser_data: Path, name: str, tables: str) -> None:
    building, random = Building(laser_data / LOGS[name], TABLES[tables]), np.random.default_rng(0)
    by_cell_m, refined_m, tracked_m = [], [], []
    for readings, truth in building.queries:
        cell = building.best_cell(readings, somewhere_near(truth, random, 0.1, math.radians(0.2)))
        box = PoseBox.around(cell, 0.15, 0.02)
        by_cell_m.append(cell.distance_m(truth))
        refined_m.append(refine(building.field, readings, [box], RefinementSettings()).pose(0).distance_m(truth))
        prior = PoseBox.around(somewhere_near(truth, random, PRIOR_M, PRIOR_RAD), PRIOR_M, PRIOR_RAD)
        found = track(building.field, readings, prior, TrackingSettings(), RefinementSettings())
        if isinstance(found, Tracked):
            tracked_m.append(found.pose.distance_m(truth))
    for title, errors_m in (("cell", by_cell_m), ("refined", refined_m), ("tracked", tracked_m)):
        median_m, often_m = np.percentile(errors_m, (50, 90)).tolist()
        print(f"{name}, {tables}, {title}: {len(errors_m)} of {len(by_cell_m)}, {median_m:.4f} / {often_m:.4f} m")
    assert np.median(refined_m) <= NEARER[tables] * np.median(by_cell_m)
    assert np.percentile(refined_m, 90) <= NEARER[tables] * np.percentile(by_cell_m, 90)
    # The corrected poses themselves are good to 2 to 5 cm.
    assert np.median(refined_m) < 0.045
    assert len(tracked_m) >= 0.85 * len(building.queries)
    assert np.median(tracked_m) < 0.045
    assert np.mean(np.array(tracked_m) < 0.3) == 1.0
