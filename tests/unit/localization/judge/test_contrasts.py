"""How far a place stands out from others: by no single reading, and by no luck of the map."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from robotd.localization.judge.climbing import Hill
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.judge.second_look import _contrast_with_nowhere, _contrasts
from robotd.localization.judge.second_look_settings import SecondLookSettings

APART_M = 10.0


class Said:
    """A likelihood that says what it is told to: the logarithms of poses 0, 1, 2... are rows."""

    def __init__(self, *rows: list[float], sharpness: float = 0.0, elsewhere: float = 0.0) -> None:
        self._rows, self._elsewhere = np.array(rows), elsewhere
        self.model = ErrorModel(map_sharpness_sigma=sharpness)

    def logs(self, sight: Any, poses: NDArray[np.float64]) -> NDArray[np.float64]:
        logs: NDArray[np.float64] = self._rows[(poses[:, 0] / APART_M).astype(int)]
        return logs

    def elsewhere_logs(self, sight: Any) -> NDArray[np.float64]:
        return np.full(self._rows.shape[1], self._elsewhere)


@dataclass
class OfHits:
    """The sight of some hits, and then of nothing but misses."""

    is_hit: NDArray[np.bool_]


def contrast_with_nowhere(said: Said, beforehand: float) -> float:
    hill = Hill(said, OfHits(np.ones(16, np.bool_)), np.ones(16))  # type: ignore[arg-type]  # stand-ins
    return _contrast_with_nowhere(hill, np.zeros(3), beforehand)


def contrast_of(*rows: list[float], sharpness: float = 0.0, misses: int = 0) -> float:
    poses = np.array([[APART_M * number, 0.0, 0.0] for number in range(len(rows))])
    sight = OfHits(np.arange(len(rows[0])) < len(rows[0]) - misses)
    elsewhere, beside = _contrasts(Hill(Said(*rows, sharpness=sharpness), sight, np.ones(len(rows[0]))), poses)  # type: ignore[arg-type]  # stand-ins
    assert beside == math.inf
    return elsewhere


def test_no_single_reading_decides_however_loud_it_is() -> None:
    assert contrast_of([50.0, 0.0, 0.0], [0.0, 0.0, 0.0]) == pytest.approx(1.0)
    assert contrast_of([50.0, 0.0, 0.0], [0.0, 0.0, 0.0]) < SecondLookSettings().contrast_min


def test_many_readings_that_agree_decide_and_those_that_contradict_each_other_do_not() -> None:
    nothing = [0.0] * 16
    assert contrast_of([1.0] * 16, nothing) == pytest.approx(4.0)
    assert contrast_of([1.0] * 9 + [-1.0] * 7, nothing) == pytest.approx(0.5)


def test_the_nearest_rival_counts_and_one_that_is_the_same_in_all_is_no_contrast() -> None:
    nothing = [0.0] * 4
    assert contrast_of([1.0] * 4, nothing, [1.0, 1.0, 0.0, 0.0]) == pytest.approx(math.sqrt(2.0))
    assert contrast_of(nothing, nothing) == 0.0


def test_small_differences_in_all_readings_are_no_more_than_luck_of_the_map() -> None:
    nothing = [0.0] * 100
    assert contrast_of([0.1] * 100, nothing) == pytest.approx(10.0)
    assert contrast_of([0.1] * 100, nothing, sharpness=0.1) < 1.0
    assert contrast_of([0.5] * 100, nothing, sharpness=0.1) > 3.0


def test_misses_have_no_such_luck_as_there_is_no_wall_to_be_shown_sharply() -> None:
    """In a hall most beams meet nothing: they were held against the few that tell two bays apart."""
    nothing, told = [0.0] * 100, [3.0] * 5 + [0.0] * 95
    of_hits = contrast_of(told, nothing, sharpness=0.11)
    assert contrast_of(told, nothing, sharpness=0.11, misses=70) > 1.4 * of_hits
    assert contrast_of(told, nothing, misses=70) == contrast_of(told, nothing)


def test_what_lies_beside_must_stand_out_too_but_no_luck_of_the_map_is_held_against_it() -> None:
    """It is seen on the same walls, so the map shows both as sharply: a step along a corridor, on belief alone."""
    said = Said([0.1] * 100, [0.0] * 100, sharpness=0.1)
    hill = Hill(said, OfHits(np.ones(100, np.bool_)), np.ones(100))  # type: ignore[arg-type]  # stand-ins
    poses = np.array([[APART_M - 0.1, 2.0, 0.0], [APART_M + 0.4, 2.0, 0.1]])
    elsewhere, beside = _contrasts(hill, poses)
    assert elsewhere == math.inf
    assert beside == pytest.approx(10.0)


def test_nowhere_is_a_rival_and_the_stronger_the_more_places_the_map_has() -> None:
    said = Said([1.0] * 16, sharpness=0.1)
    assert contrast_with_nowhere(said, 0.0) == pytest.approx(4.0)
    assert contrast_with_nowhere(said, 12.0) == pytest.approx(1.0)
    assert contrast_with_nowhere(Said([1.0] * 16, elsewhere=1.0), 12.0) == 0.0
