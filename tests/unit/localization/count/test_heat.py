"""The picture of what each place explains: the same counted apart as counted on the way, in blocks, within bounds."""

import numpy as np
import pytest

from robotd.core.grid_spec import GridSpec
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.readings import Readings
from robotd.localization.count import heat as heat_module
from robotd.localization.count.heat import block_of, counted_apart
from robotd.localization.even_headings import even_headings
from robotd.localization.localizer import Localizer
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings

SPEC = GridSpec(0.1, -1.0, 2.0, (60, 90))


def room() -> OccupancyGrid:
    cells = np.full(SPEC.shape, 10, np.uint8)
    cells[[0, -1]] = cells[:, [0, -1]] = cells[20:25, 30:40] = 250
    return OccupancyGrid(SPEC, cells)


def readings() -> tuple[RangeReading, ...]:
    return tuple(RangeReading(0, at * 0.7, ReadingStatus.OK, 1.0 + 0.3 * at) for at in range(9))


@pytest.mark.parametrize("conservative", [False, True])
def test_it_is_the_same_whether_readings_are_counted_as_they_come_or_apart(conservative: bool) -> None:
    ready = ReadyMap.of(room(), LocalizationSettings(conservative=conservative))
    few, many = even_headings(8), even_headings(40)
    heats = []
    for headings_rad in (few, many):
        localizer = Localizer.at_stop(ready, "m", headings_rad)
        localizer.add(*readings())
        heat = localizer.heat()
        apart = counted_apart(ready.prepared, Readings.of(readings()), headings_rad)
        assert np.array_equal(heat.levels, apart.levels)
        assert (heat.spec, heat.block, heat.readings, heat.headings) == (SPEC, 1, 9, len(headings_rad))
        heats.append(heat.levels)
    assert heats[0].any()
    assert (heats[1] >= heats[0]).all()  # these eight headings are among the forty


def test_nothing_is_explained_by_no_readings() -> None:
    ready = ReadyMap.of(room(), LocalizationSettings())
    assert not Localizer.at_stop(ready, "m", even_headings(3)).heat().levels.any()
    assert not Localizer.at_stop(ready, "m", even_headings(40)).heat().levels.any()


def test_a_large_map_is_shown_in_blocks() -> None:
    assert [block_of(GridSpec(0.1, 0.0, 0.0, shape)) for shape in ((512, 9), (9, 513), (4096, 1))] == [1, 2, 8]


def test_where_all_headings_would_take_too_long_fewer_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    ready = ReadyMap.of(room(), LocalizationSettings())
    monkeypatch.setattr(heat_module, "_MOST_WORK", 9 * 40 * 60 * 90 // 4)
    heat = counted_apart(ready.prepared, Readings.of(readings()), even_headings(40))
    assert 1 <= heat.headings <= 10
    assert heat.levels.any()
