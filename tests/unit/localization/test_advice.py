"""Settings that cannot work on a map are named, with the value to take; readings that say nothing have an answer."""

import math
from dataclasses import replace

import numpy as np
import pytest

from robotd.contract.estimate import PoseState
from robotd.core.grid_spec import GridSpec
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import BetweenBeams
from robotd.localization.advice import SweepFacts, advice_on
from robotd.localization.localizer import Localizer
from robotd.localization.obstacles.error_radius import ErrorRadius
from robotd.localization.radii import radii_of
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings

SPEC = GridSpec(0.2, 0.0, 0.0, (30, 40))
BEARINGS = [math.tau * number / 40 for number in range(40)]


CONSTANT = LocalizationSettings(error_radius=ErrorRadius.CONSTANT)
BY_RANGE = LocalizationSettings(error_radius=ErrorRadius.BY_RANGE)
SWEEP = SweepFacts(300, 6.0, BetweenBeams.SEEN)
FINE = GridSpec(0.05, 0.0, 0.0, (800, 800))


def test_cells_that_round_away_more_than_the_error_radius_are_named_with_the_value_to_take() -> None:
    advice = advice_on(CONSTANT, SPEC, SWEEP)
    assert advice is not None
    assert "localization.range_error_m = 0.075" in advice
    assert advice.endswith("take 0.2")
    assert advice_on(replace(CONSTANT, range_error_m=0.2), SPEC, SWEEP) is None
    assert advice_on(BY_RANGE, SPEC, SWEEP) is None


@pytest.mark.parametrize("error_radius", list(ErrorRadius))
@pytest.mark.parametrize("reach_m", [6.0, 30.0])
def test_headings_too_coarse_for_the_reach_are_named_and_the_value_to_take_is_enough(
    error_radius: ErrorRadius, reach_m: float
) -> None:
    settings = LocalizationSettings(error_radius=error_radius, heading_step_rad=0.3)
    advice = advice_on(settings, FINE, replace(SWEEP, reach_m=reach_m))
    assert advice is not None
    assert advice.startswith("localization.heading_step_rad = 0.3 ")
    taken = replace(settings, heading_step_rad=float(advice.rpartition(" ")[2]))
    assert advice_on(taken, FINE, replace(SWEEP, reach_m=reach_m)) is None
    # Not finer than it has to be: half as much again is too coarse.
    coarser = replace(taken, heading_step_rad=1.5 * taken.heading_step_rad)
    assert advice_on(coarser, FINE, replace(SWEEP, reach_m=reach_m)) is not None
    radii = radii_of(taken, FINE)
    aside_m = reach_m * taken.heading_step_rad / 2
    level = int(radii.levels(np.array([reach_m / FINE.resolution_m]))[0])
    assert aside_m <= 1.2 * radii.cells[level] * FINE.resolution_m


@pytest.mark.parametrize(
    ("sweep", "named", "enough"),
    [
        (replace(SWEEP, readings=90), "sweep.readings = 90 ", replace(SWEEP, readings=144)),
        (replace(SWEEP, between_beams=BetweenBeams.UNSEEN), 'grid.between_beams = "unseen"', SWEEP),
    ],
)
def test_beams_too_far_apart_for_a_map_without_holes_are_named(
    sweep: SweepFacts, named: str, enough: SweepFacts
) -> None:
    advice = advice_on(LocalizationSettings(), FINE, sweep)
    assert advice is not None
    assert advice.startswith(named)
    assert advice_on(LocalizationSettings(), FINE, enough) is None


def test_one_warning_at_a_time_names_the_gravest() -> None:
    advice = advice_on(replace(CONSTANT, heading_step_rad=0.5), SPEC, replace(SWEEP, readings=8))
    assert advice is not None
    assert "range_error_m" in advice
    assert "heading_step_rad" not in advice


def test_by_range_every_size_of_cells_goes_together_with_a_long_reach() -> None:
    for cell_m in (0.05, 0.1, 0.2):
        spec = GridSpec(cell_m, 0.0, 0.0, (200, 200))
        assert advice_on(BY_RANGE, spec, replace(SWEEP, reach_m=30.0)) is None


@pytest.mark.parametrize(
    ("status", "range_m"), [(ReadingStatus.MISS, 2.0), (ReadingStatus.OK, 1.0), (ReadingStatus.OK, 500.0)]
)
@pytest.mark.parametrize("has_walls", [True, False])
def test_readings_that_say_nothing_make_no_place_sure(status: ReadingStatus, range_m: float, has_walls: bool) -> None:
    """Misses alone, all ranges alike, ranges beyond the map; on a map with walls and without."""
    cells = np.zeros(SPEC.shape, np.uint8)
    cells[[0, -1]] = cells[:, [0, -1]] = 255 if has_walls else 0
    ready = ReadyMap.of(OccupancyGrid(SPEC, cells), LocalizationSettings(heading_step_rad=0.1))
    localizer = Localizer.at_stop(ready, "", ready.settings.headings_all_round())
    localizer.add(*(RangeReading(0, bearing, status, range_m) for bearing in BEARINGS))
    estimate = localizer.estimate(0, final=True)
    assert estimate.state in (PoseState.LOST, PoseState.AMBIGUOUS)
    assert estimate.best is None
