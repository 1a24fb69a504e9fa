"""Settings that cannot work on a map are named, with the value to take; readings that say nothing have an answer."""

import math

import numpy as np
import pytest

from robotd.contract.estimate import PoseState
from robotd.core.grid_spec import GridSpec
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.occupancy import OccupancyGrid
from robotd.localization.advice import advice_on
from robotd.localization.localizer import Localizer
from robotd.localization.obstacles.error_radius import ErrorRadius
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings

SPEC = GridSpec(0.2, 0.0, 0.0, (30, 40))
BEARINGS = [math.tau * number / 40 for number in range(40)]


def test_cells_that_round_away_more_than_the_error_radius_are_named_with_the_value_to_take() -> None:
    advice = advice_on(LocalizationSettings(), SPEC)
    assert advice is not None
    assert "localization.range_error_m = 0.075" in advice
    assert advice.endswith("take 0.2")
    assert advice_on(LocalizationSettings(range_error_m=0.2), SPEC) is None
    assert advice_on(LocalizationSettings(error_radius=ErrorRadius.BY_RANGE), SPEC) is None


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
