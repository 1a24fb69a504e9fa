"""A reading cannot contradict itself."""

import math

import pytest

from robotd.core.pose import IDENTITY
from robotd.core.reading import RangeReading, ReadingStatus, Sweep


@pytest.mark.parametrize(
    ("status", "range_m"),
    [
        (ReadingStatus.OK, None),
        (ReadingStatus.MISS, None),
        (ReadingStatus.WEAK, 1.0),
        (ReadingStatus.OK, 0.0),
        (ReadingStatus.OK, -1.0),
        (ReadingStatus.OK, math.inf),
        (ReadingStatus.MISS, math.nan),
    ],
)
def test_contradictions_are_refused(status: ReadingStatus, range_m: float | None) -> None:
    with pytest.raises(ValueError, match="range"):
        RangeReading(0, 0.0, status, range_m)


def test_only_hits_and_misses_are_measured() -> None:
    readings = tuple(
        RangeReading(0, 0.0, status, 1.0 if status in {ReadingStatus.OK, ReadingStatus.MISS} else None)
        for status in ReadingStatus
    )
    sweep = Sweep(0, IDENTITY, readings)
    assert [reading.status for reading in sweep.measured] == [ReadingStatus.OK, ReadingStatus.MISS]
    assert sweep.count(ReadingStatus.WEAK) == 1
