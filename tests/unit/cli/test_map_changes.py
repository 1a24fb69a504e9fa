"""``map changes`` on a store, without a daemon: what is gone, what has come, and versions that are of other stops."""

import json
import math
from pathlib import Path

import pytest

from robotd.cli.main import main
from robotd.core.map_stop import MapStop
from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.map_stops import MapStops
from robotd.grid.settings import GridSettings
from robotd.maps.store import MapStore

GRID = GridSettings(rows=120, cols=120)
SPEC = GRID.spec_covering(((0.0, 0.0),), 1.0)


def stop(number: int, chest_rad: float) -> MapStop:
    """Return a stop that sees a chest 1 m off in a direction, and walls 2 m to all other sides."""
    bearings = [math.tau * at / 240 - math.pi for at in range(240)]
    readings = (
        RangeReading(number, bearing, ReadingStatus.OK, 1.0 if abs(bearing - chest_rad) < 0.2 else 2.0)
        for bearing in bearings
    )
    return MapStop.of(Sweep(number, IDENTITY, tuple(readings)), Pose2(0.01 * number, 0.0, 0.0))


@pytest.fixture
def maps(tmp_path: Path) -> Path:
    store = MapStore(tmp_path / "maps")
    before, after = [stop(number, 0.0) for number in range(3)], [stop(number, 1.5) for number in range(3, 6)]
    for stops in (before, before + after, after):
        made = MapStops(GRID, tuple(stops))
        store.save("lab", made.grid_on(SPEC), {}, 1, made)
    return tmp_path / "maps"


def test_what_is_gone_and_what_has_come_is_listed_with_its_box(maps: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["map", "changes", "lab", "--version", "2", "--maps", str(maps), "--json"]) == 0
    gone, came = json.loads(capsys.readouterr().out)
    assert (gone["change"], came["change"]) == ("gone", "came")
    assert 0.9 < gone["box"]["west_m"] < gone["box"]["east_m"] < 1.2
    assert 0.9 < came["box"]["south_m"] < came["box"]["north_m"] < 1.2
    assert main(["map", "changes", "lab", "--version", "2", "--since", "1", "--maps", str(maps)]) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines() if line.split()][-2:] == ["gone", "came"]


def test_a_map_against_itself_has_no_changes(maps: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["map", "changes", "lab", "--version", "2", "--since", "2", "--maps", str(maps)]) == 0
    assert "nothing changed" in capsys.readouterr().out


def test_versions_of_other_stops_are_no_sessions_of_one_map(maps: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["map", "changes", "lab", "--maps", str(maps)]) == 1
    assert "version 3 does not go on with version 2: it is made of other stops" in capsys.readouterr().err
