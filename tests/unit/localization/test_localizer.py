"""The localizer: right where the room is unlike itself, honest where it is not, lost where it has never been."""

import math
from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

from robotd.contract.area import Area
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.binary import BinaryMap
from robotd.grid.occupancy import OccupancyGrid
from robotd.localization.fit.refinement_settings import RefinementSettings, Walls
from robotd.localization.judge.judgement import Judgement
from robotd.localization.localizer import Localizer
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings

SETTINGS = LocalizationSettings()
DRAWN = Judgement(RefinementSettings(walls=Walls.FACES))
SPEC = GridSpec(0.05, -1.0, -2.0, (100, 160))


def ready(binary: BinaryMap, settings: LocalizationSettings = SETTINGS) -> ReadyMap:
    """Return a drawn map, of which all is known, made ready."""
    return ReadyMap.of(OccupancyGrid(binary.spec, np.where(binary.occupied, np.uint8(255), np.uint8(0))), settings)


def room(*boxes: tuple[float, float, float, float]) -> BinaryMap:
    """Return a room that fills the grid, with boxes ``(x_min, y_min, x_max, y_max)`` standing in it."""
    occupied = np.ones(SPEC.shape, np.bool_)
    occupied[1:-1, 1:-1] = False
    for x_min, y_min, x_max, y_max in boxes:
        low, high = SPEC.cell_at(x_min, y_min), SPEC.cell_at(x_max, y_max)
        occupied[low[0] : high[0], low[1] : high[1]] = True
    return BinaryMap(SPEC, occupied)


LAB = room((1.0, -1.0, 2.2, -0.2), (3.5, 1.5, 5.0, 3.0), (5.0, -2.0, 5.6, -1.1), (-1.0, 2.2, 0.1, 3.0))


def seen_from(binary: BinaryMap, pose: Pose2, number: int, cut_off_m: float = 6.0) -> Iterator[RangeReading]:
    """Yield what a noisy laser measures: sigma 2 cm, 5 % of the ranges nonsense."""
    random = np.random.default_rng(11)
    row, col = (pose.y_m - SPEC.origin_y_m) / SPEC.resolution_m, (pose.x_m - SPEC.origin_x_m) / SPEC.resolution_m
    for bearing in np.arange(number) * math.tau / number:
        range_m = walk(binary.occupied, row, col, pose.heading_rad + bearing) * SPEC.resolution_m + random.normal(
            0, 0.02
        )
        if random.random() < 0.05:
            range_m = random.uniform(0.3, cut_off_m)
        if range_m > cut_off_m:
            yield RangeReading(0, bearing, ReadingStatus.MISS, cut_off_m)
        else:
            yield RangeReading(0, bearing, ReadingStatus.OK, range_m)


def walk(occupied: NDArray[np.bool_], row: float, col: float, bearing: float) -> float:
    """Return the distance to the first occupied cell in steps of a tenth of a cell."""
    length = 0.0
    while not occupied[math.floor(row + length * math.sin(bearing)), math.floor(col + length * math.cos(bearing))]:
        length += 0.1
    return length


def localized(
    binary: BinaryMap, pose: Pose2, number: int = 60, settings: LocalizationSettings = SETTINGS
) -> PoseEstimate:
    localizer = Localizer.at_stop(ready(binary, settings), "a map", (pose.heading_rad,), judgement=DRAWN)
    for reading in seen_from(binary, pose, number):
        localizer.add(reading)
    return localizer.estimate(7, final=True)


@pytest.mark.parametrize(
    "pose", [Pose2(0.0, 0.0, 0.0), Pose2(3.03, 0.41, 2.2), Pose2(6.1, 2.02, -1.0), Pose2(4.3, -1.2, 0.4)]
)
def test_a_noisy_sweep_finds_the_robot_to_a_cell(pose: Pose2) -> None:
    estimate = localized(LAB, pose)
    assert estimate.state is PoseState.LOCALIZED
    assert estimate.best is not None
    assert estimate.best.distance_m(pose) < 0.03
    assert estimate.best.heading_rad == pytest.approx(pose.heading_rad)
    assert estimate.regions[0].pose == estimate.best
    assert estimate.regions[0].centre.distance_m(pose) < 0.06
    assert estimate.regions[0].explained.count(True) == estimate.best_rank
    assert (estimate.time_ns, estimate.final, estimate.map_id, estimate.readings) == (7, True, "a map", 60)


def test_a_room_like_itself_is_ambiguous_and_both_places_are_told() -> None:
    """An empty room turned by half a turn is itself: 24 misses and hits cannot tell, with a heading of either kind."""
    two_bays = room((2.925, -2.0, 3.125, 3.0))
    estimate = localized(two_bays, Pose2(0.9, 0.5, 0.0))
    assert estimate.state is PoseState.AMBIGUOUS
    assert estimate.best is None
    found = sorted(region.centre.x_m for region in estimate.regions)
    assert found[0] == pytest.approx(0.9, abs=0.1)
    assert found[-1] == pytest.approx(4.95, abs=0.1)


def test_a_long_corridor_without_marks_is_ambiguous_though_its_region_is_one() -> None:
    corridor = room((-1.0, 1.0, 7.0, 3.0), (-1.0, -2.0, 7.0, -0.5))
    localizer = Localizer.at_stop(ready(corridor), "a map", (0.0,))
    for reading in seen_from(corridor, Pose2(3.0, 0.25, 0.0), 60, cut_off_m=1.5):
        localizer.add(reading)
    estimate = localizer.estimate(0, final=True)
    assert estimate.state is PoseState.AMBIGUOUS
    assert max(region.extent.x_max_m - region.extent.x_min_m for region in estimate.regions) > 2.0


def test_a_robot_that_was_turned_or_carried_elsewhere_is_lost() -> None:
    elsewhere = room((-1.0, -2.0, 0.0, 3.0), (6.0, -2.0, 7.0, 3.0), (2.0, 1.8, 2.2, 3.0), (3.5, -2.0, 3.7, -1.0))
    for binary, pose, believed_rad in ((LAB, Pose2(0.0, 0.0, 0.3), 1.1), (elsewhere, Pose2(3.0, 0.9, 0.3), 0.7)):
        localizer = Localizer.at_stop(ready(LAB), "a map", (believed_rad,))
        for reading in seen_from(binary, pose, 60):
            localizer.add(reading)
        estimate = localizer.estimate(0, final=True)
        assert estimate.state is PoseState.LOST
        assert (estimate.best, estimate.regions) == (None, ())
        assert estimate.readings == 60


@pytest.mark.parametrize("pose", [Pose2(3.03, 0.41, 2.2), Pose2(6.1, 2.02, -1.0)])
def test_a_robot_that_was_turned_by_nobody_knows_how_much_is_found(pose: Pose2) -> None:
    localizer = Localizer.at_stop(ready(LAB), "a map", SETTINGS.headings_all_round(), judgement=DRAWN)
    localizer.add(*seen_from(LAB, pose, 120))
    estimate = localizer.estimate(7, final=True)
    assert estimate.state is PoseState.LOCALIZED
    assert estimate.best is not None
    assert estimate.best.distance_m(pose) < 0.03
    assert math.remainder(estimate.best.heading_rad - pose.heading_rad, math.tau) == pytest.approx(0.0, abs=0.01)


def test_a_robot_in_one_of_two_places_that_look_alike_is_found_where_it_is_known_to_be() -> None:
    two_bays = room((2.925, -2.0, 3.125, 3.0))
    localizer = Localizer.at_stop(ready(two_bays), "a map", (0.0,), Area(0.0, 0.0, 2.5), judgement=DRAWN)
    localizer.add(*seen_from(two_bays, Pose2(0.9, 0.5, 0.0), 60))
    estimate = localizer.estimate(0, final=True)
    assert estimate.state is PoseState.LOCALIZED
    assert estimate.best is not None
    assert estimate.best.distance_m(Pose2(0.9, 0.5, 0.0)) < 0.05


def test_too_few_readings_say_nothing() -> None:
    assert localized(LAB, Pose2(0.0, 0.0, 0.0), SETTINGS.readings_min - 1).state is PoseState.LOST


def test_stops_on_one_map_know_nothing_of_each_other() -> None:
    the_map, poses = ready(LAB), (Pose2(0.0, 0.0, 0.0), Pose2(6.1, 2.0, 1.0))
    localizers = [Localizer.at_stop(the_map, "a map", (pose.heading_rad,)) for pose in poses]
    for localizer, pose in zip(localizers, poses, strict=True):
        localizer.add(*seen_from(LAB, pose, 60))
    for localizer, pose in zip(localizers, poses, strict=True):
        best = localizer.estimate(0, final=True).best
        assert best is not None
        assert best.distance_m(pose) < 0.06


def test_a_reading_that_measured_nothing_is_refused_and_none_with_it_is_taken() -> None:
    hit, nothing = RangeReading(0, 0.0, ReadingStatus.OK, 1.0), RangeReading(0, 0.0, ReadingStatus.WEAK, None)
    for headings_rad in ((0.0,), SETTINGS.headings_all_round()):
        localizer = Localizer.at_stop(ready(LAB), "a map", headings_rad)
        with pytest.raises(ValueError, match="weak"):
            localizer.add(hit, nothing)
        assert len(localizer.stop.readings) == 0


@pytest.mark.parametrize(
    "bad",
    [
        {"range_error_m": -0.1},
        {"localized_share": 0.0},
        {"rival_share": 1.0},
        {"readings_min": 0},
    ],
)
def test_impossible_settings_are_refused_by_name(bad: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(bad))):
        LocalizationSettings(**bad)  # type: ignore[arg-type]  # wrong on purpose
