"""A stop gives back the sweep that it was made of, and its beams are those of that sweep."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.core.map_stop import MapStop
from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.readings import Readings
from tests.support.made_maps import made_readings

sweeps = st.builds(
    lambda seed, count, number: Sweep(number, Pose2(1.0, -2.0, 0.5), made_readings(np.random.default_rng(seed), count)),
    st.integers(0, 10**6),
    st.integers(0, 40),
    st.integers(0, 2**40),
)


@given(sweep=sweeps)
def test_a_sweep_comes_back(sweep: Sweep) -> None:
    stop = MapStop.of(sweep, IDENTITY)
    assert stop.sweep == sweep
    assert MapStop.of(stop.sweep, IDENTITY) == stop
    assert stop != MapStop.of(sweep, Pose2(0.0, 0.0, 1e-9))


@given(sweep=sweeps)
def test_its_beams_are_those_of_the_sweep(sweep: Sweep) -> None:
    stop = MapStop.of(sweep, IDENTITY)
    hits = [reading for reading in sweep.readings if reading.status is ReadingStatus.OK]
    assert stop.beams(misses=True).tobytes() == Readings.of(sweep.measured).rows.tobytes()
    assert stop.beams(misses=False).tobytes() == Readings.of(hits).rows.tobytes()
    assert stop.beams(misses=True).flags.c_contiguous


@pytest.mark.parametrize("numbers", [(2**63, None), (0, 2**63), (0, -(2**63) - 1)])
def test_numbers_that_do_not_fit_are_refused(numbers: tuple[int, int | None]) -> None:
    reading = RangeReading(numbers[0], 0.0, ReadingStatus.OK, 1.0, numbers[1])
    with pytest.raises(OverflowError):
        MapStop.of(Sweep(0, IDENTITY, (reading,)), IDENTITY)
