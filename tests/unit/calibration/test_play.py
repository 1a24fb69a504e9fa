"""The play of a head's gears, in simulated rooms and in sweeps of a real one."""

import contextlib
import csv
import math
import os
from collections import defaultdict
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.calibration.head_zero import combined, play
from robotd.calibration.heads import SweepHeads
from robotd.core.errors import CalibrationError
from robotd.sim.buildings.world import load_world
from tests.unit.calibration.rooms import seen_from

OFFICE = load_world("office")
DATA = os.environ.get("ROBOTD_DATA")


@settings(max_examples=8, deadline=None)
@given(play_rad=st.floats(0.0, 0.2), seed=st.integers(0, 999))
def test_the_play_is_found(play_rad: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    one_way, other_way = (seen_from(OFFICE, OFFICE.start_pose, rng) for _ in range(2))
    found_rad, error_rad = play(one_way.heads(play_rad / 2.0), other_way.heads(-play_rad / 2.0))
    assert found_rad == pytest.approx(play_rad, abs=0.012)
    assert 0.0 < error_rad < 0.01


def test_disagreement_widens_the_error() -> None:
    assert combined([(0.1, 0.01), (0.1, 0.01)]) == pytest.approx((0.1, 0.01 / math.sqrt(2.0)))
    mean, error = combined([(0.0, 0.01), (0.2, 0.01)])
    assert (mean, error) == pytest.approx((0.1, 0.1))


@pytest.mark.real_data
@pytest.mark.skipif(DATA is None, reason="ROBOTD_DATA is not set")
def test_a_real_head_has_5_degrees() -> None:
    """A TF-Luna on a stepper in a flat: six stops, each swept both ways; the note beside it says 5.4 degrees."""
    sweeps: dict[str, list[tuple[float, float]]] = defaultdict(list)
    with (Path(str(DATA)) / "pibot-tfluna-stops" / "stops.csv").open() as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            sweeps[row["stop"]].append((float(row["angle_deg"]), float(row["range_cm"]) / 100.0))
    plays = []
    for stop, readings in sweeps.items():
        # From the fourth stop nearly all walls are beyond the instrument's reach, and that is said.
        with pytest.raises(CalibrationError) if stop == "4" else contextlib.nullcontext():
            plays.append(play(_heads(readings[1:200]), _heads(readings[201:])))
    assert len(plays) == 5
    found_rad, error_rad = combined(plays)
    assert abs(math.degrees(found_rad)) == pytest.approx(5.4, abs=0.5)
    assert math.degrees(error_rad) < 0.5


def _heads(readings: list[tuple[float, float]]) -> SweepHeads:
    # Clockwise from ahead, in degrees; zeros and ranges beyond what the instrument reaches are no readings.
    good = np.array([(math.remainder(-math.radians(deg), math.tau), m) for deg, m in readings if 0.2 < m < 8.0])
    return SweepHeads.of(good[:, 0], good[:, 1], np.zeros((len(good), 2)))
