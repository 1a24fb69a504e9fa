"""The front door: the daemon's answers without a daemon, refusals in words, nothing loaded that was not asked for."""

import doctest
import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import robotd
from robotd.contract.estimate import PoseState
from robotd.core.errors import MapError
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.core.reading import ReadingStatus
from robotd.grid.occupancy import OccupancyGrid
from robotd.library.map import Map, PoseLike
from robotd.localization.localizer import Localizer
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings
from robotd.maps.store import MapStore

DOCS = Path(__file__).parents[3] / "docs"
BEARINGS = np.radians(np.arange(0, 360, 1.2))
POSE = (2.2, 1.7, 0.5)


def room() -> Map:
    cells = np.zeros((80, 120), np.uint8)
    cells[[0, -1]] = cells[:, [0, -1]] = cells[:24, 80:100] = 255
    return Map.from_cells(cells, 0.05)


def sweep_at(pose: tuple[float, float, float] = POSE) -> robotd.Sweep:
    return robotd.Sweep.of(BEARINGS, room().expected_ranges(BEARINGS, pose), cutoff_m=8.0)


def test_a_front_door_says_what_the_daemon_would_say() -> None:
    settings, sweep = LocalizationSettings(), sweep_at()
    ready = ReadyMap.of(OccupancyGrid(room().spec, room().cells), settings)
    localizer = Localizer.at_stop(ready, "", settings.headings_all_round())
    localizer.add(*sweep.measured)
    assert room().localize(sweep) == localizer.estimate(0, final=True)


def test_a_known_heading_or_a_disk_leaves_only_what_lies_in_it() -> None:
    sweep = sweep_at()
    assert room().localize(sweep, heading_rad=0.5).state is PoseState.LOCALIZED
    assert room().localize(sweep, heading_rad=2.5).best is None
    assert room().localize(sweep, near_m=(2.0, 2.0, 0.6)).state is PoseState.LOCALIZED
    assert room().localize(sweep, near_m=(5.5, 3.0, 0.3)).best is None


def test_a_map_of_sweeps_finds_another_sweep() -> None:
    poses: list[PoseLike] = [(1.0, 1.0, 0.0), (3.0, 2.5, 1.0), Pose2(5.4, 3.0, 2.0)]
    made = Map.from_sweeps([sweep_at((1.0, 1.0, 0.0)), sweep_at((3.0, 2.5, 1.0)), sweep_at((5.4, 3.0, 2.0))], poses)
    best = made.localize(sweep_at()).best
    assert best is not None
    assert math.dist((best.x_m, best.y_m), POSE[:2]) < 0.03


def test_explaining_keeps_the_order_of_the_sweep_and_leaves_out_what_was_not_measured() -> None:
    ranges_m = room().expected_ranges(BEARINGS, POSE)
    ranges_m[[3, 7]] = math.nan, 0.2
    explanation = room().explain(robotd.Sweep.of(BEARINGS, ranges_m, cutoff_m=8.0), POSE)
    assert np.flatnonzero(~explanation.explained).tolist() == [3, 7]
    assert np.flatnonzero(np.isnan(explanation.expected_m)).tolist() == [3]
    assert explanation.share == 298 / 299
    # Where the sixth beam ended is a wall of the room.
    row, col = room().spec.cell_at(*(explanation.heads_m[5] + 1e-3 * (explanation.heads_m[5] - POSE[:2])))
    assert room().cells[row, col] == 255


def test_off_the_map_nothing_is_explained() -> None:
    explanation = room().explain(sweep_at(), (99.0, 1.0, 0.0))
    assert explanation.share == 0.0
    assert not explanation.explained.any()


def test_maps_come_from_the_store_and_from_files(tmp_path: Path) -> None:
    MapStore(tmp_path).save("kitchen", OccupancyGrid(room().spec, room().cells), {}, 0)
    stored = Map.from_store(tmp_path, "kitchen")
    np.testing.assert_array_equal(stored.cells, room().cells)
    pytest.importorskip("PIL")
    exported = Map.from_file(tmp_path / "kitchen" / "1" / "map.yaml")
    assert exported.spec == stored.spec
    np.testing.assert_array_equal(exported.cells > 127, room().cells > 127)  # three greys are left of 256 values
    bare = Map.from_file(tmp_path / "kitchen" / "1" / "map.pgm", resolution_m=0.05)
    np.testing.assert_array_equal(bare.cells, exported.cells)


def test_what_is_wrong_is_said(tmp_path: Path) -> None:
    with pytest.raises(MapError, match="at least one sweep"):
        Map.from_sweeps([], [])
    with pytest.raises(ValueError, match="shorter"):
        Map.from_sweeps([sweep_at(), sweep_at()], [(0.0, 0.0, 0.0)])
    with pytest.raises(MapError, match="too large"):
        Map.from_sweeps([sweep_at()] * 2, [(0.0, 0.0, 0.0), (9e3, 0.0, 0.0)])
    with pytest.raises(ValueError, match=r"expected uint8\[rows, cols\]"):
        Map.from_cells(np.zeros(4, np.uint8), 0.05)
    with pytest.raises(ValueError, match="expected uint8"):
        Map.from_cells(np.zeros((4, 4)), 0.05)  # type: ignore[arg-type]  # as a notebook would
    pytest.importorskip("PIL")
    with pytest.raises(MapError, match=r"nowhere\.yaml.*cannot be read"):
        Map.from_file(tmp_path / "nowhere.yaml")
    (tmp_path / "plan.pgm").write_bytes(b"P5 1 1 255 \x00")
    with pytest.raises(MapError, match="resolution"):
        Map.from_file(tmp_path / "plan.pgm")


@given(st.lists(st.tuples(st.floats(-7, 7), st.floats(allow_nan=True)), max_size=9), st.floats(0.1, 50.0))
def test_ranges_are_read_as_rep_117_says(beams: list[tuple[float, float]], cutoff_m: float) -> None:
    sweep = robotd.Sweep.of([bearing for bearing, _ in beams], [range_m for _, range_m in beams], cutoff_m)
    for (bearing_rad, range_m), reading in zip(beams, sweep.readings, strict=True):
        assert reading.bearing_rad == bearing_rad
        if math.isnan(range_m):
            assert reading.status is ReadingStatus.NOT_MEASURED
        elif range_m <= 0.0:
            assert reading.status is ReadingStatus.TOO_NEAR
        elif range_m < cutoff_m:
            assert (reading.status, reading.range_m) == (ReadingStatus.OK, range_m)
        else:
            assert (reading.status, reading.range_m) == (ReadingStatus.MISS, cutoff_m)


@pytest.mark.parametrize(
    ("bearings", "ranges", "cutoff_m"), [([0.0], [1.0, 2.0], 6.0), ([math.inf], [1.0], 6.0), ([0.0], [1.0], math.nan)]
)
def test_columns_that_cannot_be_a_sweep_are_refused(
    bearings: list[float], ranges: list[float], cutoff_m: float
) -> None:
    with pytest.raises(ValueError, match=r"shorter|longer|finite|positive"):
        robotd.Sweep.of(bearings, ranges, cutoff_m)


def test_reprs_are_short() -> None:
    sweep, the_map = sweep_at(), room()
    estimate = the_map.localize(sweep)
    assert repr(the_map) == "Map(120 x 80 cells of 50 mm, 100% seen)"
    assert str(estimate).startswith("localized at x 2.")
    for told in (sweep, the_map, the_map.explain(sweep, POSE), estimate):
        assert len(repr(told)) < 1200
    assert str(the_map.localize(robotd.Sweep.of([0.0], [1.0], 6.0))) == "lost; 0 of 1 readings explained"


def test_the_page_is_true() -> None:
    assert doctest.testfile(str(DOCS / "library.md"), module_relative=False).failed == 0


def test_the_notebook_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    plt = pytest.importorskip("matplotlib.pyplot")
    monkeypatch.setenv("MPLBACKEND", "agg")
    plt.switch_backend("agg")
    told: list[str] = []
    names: dict[str, Any] = {"print": lambda *words: told.append(" ".join(map(str, words)))}
    for cell in json.loads((DOCS / "examples" / "localize.ipynb").read_text())["cells"]:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)  # our own notebook
    axes = plt.gca()
    assert axes.get_xlabel() == "x [m]"
    assert len(axes.collections[0].get_offsets()) == 300
    plt.close("all")
    assert [line.partition(" ")[0].rstrip(";") for line in told] == ["localized", "lost"]


def test_the_package_itself_loads_no_engine() -> None:
    code = "import robotd, sys; print([name for name in sys.modules if name.startswith('robotd.')])"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "[]"
    assert {"Map", "Sweep", "Pose2"} <= set(dir(robotd))
    with pytest.raises(AttributeError, match="Mop"):
        robotd.Mop  # type: ignore[attr-defined]  # noqa: B018  # a slip
    assert robotd.Map is Map
    assert GridSpec(0.05, 0.0, 0.0, (80, 120)) == room().spec
