"""``map stops`` on a store, without a daemon."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from robotd.cli.main import main
from robotd.core.map_stop import MapStop
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Slant, Sweep, Tilt
from robotd.grid.map_stops import MapStops
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.maps.store import MapStore

GRID = GridSettings(rows=80, cols=80)
SPEC = GRID.spec_covering(((0.0, 0.0),), 1.0)


def swept(number: int, in_odom: Pose2) -> Sweep:
    readings = tuple(RangeReading(n, 0.3 * n, ReadingStatus.OK, 1.0) for n in range(20))
    return Sweep(number, in_odom, (*readings, RangeReading(99, 6.1, ReadingStatus.WEAK, None)))


@pytest.fixture
def maps(tmp_path: Path) -> Path:
    level = swept(0, Pose2(5.0, 5.0, 0.0))
    slants = tuple(Slant(tilt, level.readings[:5]) for tilt in (Tilt(-0.24, 2.1), Tilt(0.105, 4.0)))
    first = MapStop.of(replace(level, slants=slants), Pose2(0.0, 0.0, 0.0))
    second = MapStop.of(swept(1, Pose2(5.5, 5.0, 0.0)), Pose2(0.4, 0.0, 0.1))
    stops = MapStops(GRID).with_stop(first).with_stop(second)
    store = MapStore(tmp_path / "maps")
    store.save("lab", stops.grid_on(SPEC), {}, 1, stops)
    store.save("drawn", OccupancyGrid(SPEC), {}, 2)
    return tmp_path / "maps"


def test_each_stop_says_where_it_is_and_how_far_it_corrects_odometry(
    maps: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["map", "stops", "lab", "--maps", str(maps), "--json"]) == 0
    first, second = json.loads(capsys.readouterr().out)
    assert (first["stop"], first["off_m"], first["readings"]) == (0, 0.0, 20)
    assert second["x_m"] == 0.4
    assert second["off_m"] == pytest.approx(0.1)
    assert second["off_rad"] == pytest.approx(0.1)
    assert main(["map", "stops", "lab", "--maps", str(maps)]) == 0
    *_, before, last = (line.split() for line in capsys.readouterr().out.splitlines())
    assert before == ["0", "0.000", "0.000", "0.0", "20", "-13.8,", "6.0", "0", "0.00"]
    assert last == ["1", "0.400", "0.000", "5.7", "20", "100", "5.73"]
    assert (first["tilts_rad"], second["tilts_rad"]) == ([-0.24, 0.105], [])


def test_a_map_whose_stops_are_not_known_says_so(maps: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["map", "stops", "drawn", "--maps", str(maps)]) == 1
    assert "not known of which stops" in capsys.readouterr().err
