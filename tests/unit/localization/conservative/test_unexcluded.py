"""The conservative mode of the localizer: the true place is always among the answers."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from robotd.contract.area import Area
from robotd.contract.estimate import PoseEstimate, PoseState, Region
from robotd.core.grid_spec import GridSpec
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.readings import Readings
from robotd.localization.conservative import unexcluded
from robotd.localization.conservative.unexcluded import UnexcludedStop
from robotd.localization.even_headings import even_headings
from robotd.localization.localizer import Localizer
from robotd.localization.ready_map import ReadyMap
from robotd.localization.search.cell_disk import CellDisk
from robotd.localization.settings import LocalizationSettings
from tests.support.conservative_cases import Case, case_of

CASES = [case for case in map(case_of, range(160)) if case.slices <= 90 and len(case.readings) >= 6]
"""Few enough headings that what is left can be told."""


def settings_of(case: Case, outlier_share: float = 0.0) -> LocalizationSettings:
    return LocalizationSettings(
        range_error_m=case.range_error_m,
        heading_step_rad=2.0 * case.heading_error_rad,
        readings_min=1,
        regions_max=10_000,
        conservative=True,
        outlier_share=outlier_share,
    )


def map_of(case: Case, settings: LocalizationSettings) -> ReadyMap:
    """Return the case's map, of which all is known but what lies outside."""
    evidence = np.where(case.occupied, np.uint8(255), np.uint8(0))
    spec = GridSpec(case.resolution_m, 0.0, 0.0, case.occupied.shape)
    return ReadyMap.of(OccupancyGrid(spec, evidence), settings)


def estimate_of(case: Case, *wrong: RangeReading, outlier_share: float = 0.0) -> PoseEstimate:
    the_map = map_of(case, settings_of(case, outlier_share))
    localizer = Localizer.at_stop(the_map, "a map", even_headings(case.slices))
    localizer.add(*case.readings, *wrong)
    return localizer.estimate(0, final=True)


def holds(region: Region, cell: tuple[int, int]) -> bool:
    row, col = (number // region.cover.block_cells for number in cell)
    return any(run[0] == row and run[1] <= col <= run[2] for run in region.cover.runs)


def names_the_truth(case: Case, estimate: PoseEstimate) -> bool:
    return any(holds(region, case.cell) for region in estimate.regions)


@pytest.mark.parametrize("first", range(0, 50, 10))
def test_the_true_place_is_always_among_the_answers(first: int) -> None:
    told = 0
    for case in CASES[first : first + 10]:
        estimate = estimate_of(case)
        assert estimate.state is not PoseState.LOST
        assert estimate.regions_left_out == 0
        assert names_the_truth(case, estimate) or not estimate.regions  # more than can be told: ambiguous
        assert estimate.regions or estimate.state is PoseState.AMBIGUOUS
        told += bool(estimate.regions)
    assert told > 5


def test_so_many_readings_may_break_their_bounds_as_was_said() -> None:
    lost = 0
    for case in CASES[:10]:
        wrong = [RangeReading(0, 0.1 * k, ReadingStatus.OK, 0.01) for k in range(max(1, len(case.readings) // 8))]
        assert names_the_truth(case, allowed := estimate_of(case, *wrong, outlier_share=0.25)) or not allowed.regions
        lost += not names_the_truth(case, estimate_of(case, *wrong))
    assert lost >= 2


def empty(within: Area | None = None, headings: int = 8) -> UnexcludedStop:
    settings = LocalizationSettings(conservative=True, heading_step_rad=math.tau / 8)
    grid = OccupancyGrid(GridSpec(0.1, -1.0, -1.0, (20, 24)), vacant((20, 24)))
    sure = ReadyMap.of(grid, settings).sure
    assert sure is not None
    disk = None if within is None else CellDisk.of(within, grid.spec)
    stop = UnexcludedStop(sure, even_headings(headings), disk, outlier_share=0.0, threads=1)
    hit, miss = RangeReading(0, 0.3, ReadingStatus.OK, 0.8), RangeReading(0, 2.0, ReadingStatus.MISS, 0.4)
    stop.add(Readings.of((hit, miss)))
    return stop


def vacant(shape: tuple[int, int]) -> NDArray[np.uint8]:
    evidence = np.zeros(shape, np.uint8)
    evidence[[0, -1]] = evidence[:, [0, -1]] = 255
    return evidence


def test_counted_in_batches_when_asked_or_as_readings_come_the_answers_are_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    kept = empty().best_poses()
    monkeypatch.setattr(unexcluded, "FEW_HEADINGS", 0)
    monkeypatch.setattr(unexcluded, "MEMORY_BYTES", 1)
    asked = empty().best_poses()
    assert len(kept.poses) > 100
    assert kept.best_rank == asked.best_rank == 2
    np.testing.assert_array_equal(kept.poses, asked.poses)
    np.testing.assert_array_equal(kept.ranks, asked.ranks)


def test_more_answers_than_can_be_told_are_said_to_be_not_all(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(unexcluded, "POSES_TOLD_MAX", 10)
    found = empty().best_poses()
    assert not found.is_all
    assert len(found.poses) == 0


def test_within_an_area_only_cells_that_touch_it_are_answers() -> None:
    anywhere, inside = empty().best_poses(), empty(Area(0.1, 0.2, 0.35)).best_poses()
    assert 0 < len(inside.poses) < len(anywhere.poses)
    far = np.hypot(inside.poses[:, 2] * 0.1 - 0.95 - 0.1, inside.poses[:, 1] * 0.1 - 0.95 - 0.2)
    assert far.max() <= 0.35 + 0.0708
    assert len(empty(Area(50.0, 50.0, 1.0)).best_poses().poses) == 0
