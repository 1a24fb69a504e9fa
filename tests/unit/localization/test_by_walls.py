"""The heading from walls: the same answer under few headings, and under all where walls do not tell."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest

from robotd.contract.estimate import PoseEstimate
from robotd.contract.walls_verdict import WallsVerdict
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.localization import by_walls
from robotd.localization.at_stop import estimator_at_stop
from robotd.localization.by_walls import ByWalls
from robotd.localization.heading_search import HeadingSearch
from robotd.localization.localizer import Localizer
from robotd.localization.orientation.separated_orientation import Axis
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings
from tests.support.mapped_room import mapped_room

BY_WALLS = LocalizationSettings(heading=HeadingSearch.WALLS)


def asked(the_map: ReadyMap, readings: tuple[RangeReading, ...]) -> PoseEstimate:
    estimator = estimator_at_stop(the_map, "room", the_map.settings.headings_all_round())
    estimator.add(*readings)
    return estimator.estimate(0, final=True)


def of_all(readings: tuple[RangeReading, ...]) -> PoseEstimate:
    return asked(ReadyMap.of(mapped_room()[0], LocalizationSettings()), readings)


def test_walls_name_the_true_heading_and_few_others(monkeypatch: pytest.MonkeyPatch) -> None:
    grid, readings, truth = mapped_room()
    tried: list[int] = []
    at_stop = Localizer.at_stop

    def counted(the_map: ReadyMap, map_id: str, headings_rad: Sequence[float], *rest: Any, **others: Any) -> Localizer:
        tried.append(len(headings_rad))
        return at_stop(the_map, map_id, headings_rad, *rest, **others)

    monkeypatch.setattr(Localizer, "at_stop", counted)
    found = asked(ReadyMap.of(grid, BY_WALLS), readings)
    assert found.walls is WallsVerdict.USABLE
    assert found.best is not None
    assert found.best.distance_m(truth) < 0.05
    assert abs(math.remainder(found.best.heading_rad - truth.heading_rad, math.tau)) < 0.01
    assert min(tried) < 60 < max(tried)


def test_where_a_wrong_axis_explains_nothing_all_headings_are_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    grid, readings, _ = mapped_room()
    monkeypatch.setattr(by_walls, "_axis_of", lambda the_map: Axis(math.radians(33.0), 1.0))
    found = asked(ReadyMap.of(grid, BY_WALLS), readings)
    assert found.walls is WallsVerdict.NO_POSE
    assert replace(found, walls=None) == of_all(readings)


def test_where_walls_name_no_heading_all_are_tried() -> None:
    grid, readings, _ = mapped_room()
    # Every other reading far shorter than the next: points on no line.
    torn = tuple(
        replace(reading, range_m=0.35 * (reading.range_m or 0.0)) if number % 2 else reading
        for number, reading in enumerate(readings)
        if reading.status is ReadingStatus.OK
    )[:40]
    found = asked(ReadyMap.of(grid, BY_WALLS), torn)
    assert found.walls in {WallsVerdict.READINGS_CLUTTERED, WallsVerdict.LITTLE_IN_SIGHT}
    assert replace(found, walls=None) == of_all(torn)


def test_walls_are_asked_where_nothing_is_known_and_no_proof_is_wanted() -> None:
    grid = mapped_room()[0]
    for settings, headings_rad, kind in (
        (BY_WALLS, BY_WALLS.headings_all_round(), ByWalls),
        (BY_WALLS, BY_WALLS.headings_near(0.3), Localizer),
        (LocalizationSettings(), BY_WALLS.headings_all_round(), Localizer),
        (replace(BY_WALLS, conservative=True), BY_WALLS.headings_all_round(), Localizer),
    ):
        assert type(estimator_at_stop(ReadyMap.of(grid, settings), "", headings_rad)) is kind


def test_a_reading_that_measured_nothing_is_refused_and_none_is_taken() -> None:
    grid, readings, _ = mapped_room()
    estimator = estimator_at_stop(ReadyMap.of(grid, BY_WALLS), "", BY_WALLS.headings_all_round())
    with pytest.raises(ValueError, match="device_error"):
        estimator.add(readings[0], RangeReading(0, 0.0, ReadingStatus.DEVICE_ERROR, None))
    assert estimator.estimate(0, final=False).readings == 0
