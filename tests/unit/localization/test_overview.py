"""The coarse look finds where to look again: near to what the full count finds, and with nothing left out unsaid."""

import math
from dataclasses import asdict

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.spec import GridSpec
from robotd.grid.ternary import TernaryMap
from robotd.localization.overview import Overview, OverviewSettings, pooled
from robotd.localization.shortlist import near
from robotd.sim.walls import Walls, ray_cast

ROOM = ((0.0, 0.0), (6.0, 0.0), (6.0, 3.0), (4.0, 3.0), (4.0, 4.0), (0.0, 4.0))
WALLS = Walls.of((one, other, math.inf) for one, other in zip(ROOM, (*ROOM[1:], ROOM[0]), strict=True))


def room_map(resolution_m: float) -> TernaryMap:
    spec = GridSpec(resolution_m, -0.5, -0.5, (round(5.0 / resolution_m), round(7.0 / resolution_m)))
    rows, cols = np.indices(spec.shape)
    x_m, y_m = -0.5 + (cols + 0.5) * resolution_m, -0.5 + (rows + 0.5) * resolution_m

    def within(margin_m: float) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
        low, wide, high = margin_m, 6.0 - margin_m, 4.0 - margin_m
        main = (x_m > low) & (x_m < wide) & (y_m > low) & (y_m < high - 1.0)
        return main | ((x_m > low) & (x_m < wide - 2.0) & (y_m > low) & (y_m < high))

    vacant = within(0.0)
    return TernaryMap(spec, within(-resolution_m) & ~vacant, vacant)


def sweep(pose: Pose2, count: int = 120) -> list[RangeReading]:
    bearings_rad = np.arange(count) * (math.tau / count)
    at = (pose.x_m, pose.y_m)
    ranges_m = [ray_cast(WALLS, at, pose.heading_rad + bearing_rad) for bearing_rad in bearings_rad]
    pairs = zip(bearings_rad.tolist(), ranges_m, strict=True)
    return [RangeReading(0, bearing_rad, ReadingStatus.OK, range_m) for bearing_rad, range_m in pairs]


@pytest.mark.parametrize("seed", range(6))
def test_the_right_place_is_among_the_first_starts(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pose = Pose2(rng.uniform(0.5, 3.5), rng.uniform(0.5, 2.5), rng.uniform(-3, 3))
    starts = Overview.of(room_map(0.05), OverviewSettings()).starts(sweep(pose))
    best = starts.poses[np.argsort(-starts.ranks, kind="stable")[:50]]
    assert near(best, np.array([pose.x_m, pose.y_m, pose.heading_rad]), 0.2, 0.07).any()
    assert starts.is_all
    assert starts.readings <= OverviewSettings().readings_max


def test_memory_in_batches_and_threads_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    overview, readings = Overview.of(room_map(0.05), OverviewSettings(headings=90)), sweep(Pose2(2.0, 1.5, 0.4))
    whole = overview.starts(readings)
    threaded = overview.starts(readings, threads=2)
    monkeypatch.setattr("robotd.localization.overview._MEMORY_BYTES", 100_000)
    batched = overview.starts(readings)
    for other in (threaded, batched):
        assert np.array_equal(whole.poses, other.poses)
        assert np.array_equal(whole.ranks, other.ranks)


def test_no_more_starts_than_wanted_and_none_better_left_out() -> None:
    readings = sweep(Pose2(2.0, 1.5, 0.4))
    many = Overview.of(room_map(0.05), OverviewSettings(poses_max=5000)).starts(readings)
    few = Overview.of(room_map(0.05), OverviewSettings(poses_max=20)).starts(readings)
    assert len(few.poses) <= 20
    assert few.is_all
    assert (many.ranks >= few.ranks.min()).sum() == len(few.ranks)


def test_where_too_many_poses_explain_everything_it_is_said_that_these_are_not_all() -> None:
    starts = Overview.of(room_map(0.05), OverviewSettings(poses_max=50)).starts(sweep(Pose2(2.0, 1.5, 0.4), 1))
    assert not starts.is_all
    assert 25 < len(starts.poses) <= 50
    assert np.ptp(starts.poses[:, 0]) > 1.5


def test_where_hopelessly_many_poses_do_none_need_be_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robotd.localization.overview._POSES_AT_ONCE", 100)
    starts = Overview.of(room_map(0.05), OverviewSettings()).starts(sweep(Pose2(2.0, 1.5, 0.4), 1))
    assert not starts.is_all
    assert len(starts.poses) == 0


def test_without_readings_there_is_nothing_to_say() -> None:
    starts = Overview.of(room_map(0.05), OverviewSettings()).starts([])
    assert len(starts.poses) == 0


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32), st.integers(1, 20), st.integers(1, 20), st.integers(1, 4))
def test_larger_cells_hold_what_any_of_theirs_does(seed: int, rows: int, cols: int, factor: int) -> None:
    value = np.random.default_rng(seed).choice(3, (rows, cols), p=[0.1, 0.3, 0.6])
    ternary = TernaryMap(GridSpec(0.05, 1.0, 2.0, (rows, cols)), value == 0, value == 1)
    larger = pooled(ternary, factor)
    assert larger.spec.resolution_m == pytest.approx(0.05 * factor)
    for row in range(larger.spec.rows):
        for col in range(larger.spec.cols):
            part = value[row * factor : (row + 1) * factor, col * factor : (col + 1) * factor]
            assert larger.occupied[row, col] == (part == 0).any()
            assert larger.unknown[row, col] == (part == 2).all()


@pytest.mark.parametrize("name", list(asdict(OverviewSettings())))
def test_impossible_settings_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match=name):
        OverviewSettings(**{name: -1})
