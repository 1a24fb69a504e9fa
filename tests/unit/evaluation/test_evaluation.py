"""What evaluation promises: the protocol to the letter, cases that mean the same in any process, bounded memory."""

import math
import pickle
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.core.pose import Pose2
from robotd.core.reading import ReadingStatus
from robotd.evaluation.division import Query, elsewhere, halves, interleaved
from robotd.evaluation.map_recipe import MapRecipe
from robotd.evaluation.recorded import Reach, map_of, readings_of
from robotd.evaluation.result import CaseResult
from robotd.evaluation.seeking import Seeking, SeekingSettings
from robotd.evaluation.verdict import CaseVerdict
from robotd.evaluation.which_program import program
from robotd.grid.settings import GridSettings
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.judge.judgement import Judgement
from robotd.localization.settings import LocalizationSettings
from robotd.logs.carmen import parse_carmen
from robotd.logs.scan import RecordedLog
from tests.support.recorded_room import drive_lines

REACH = Reach(range_max_m=4.0, clear_m=3.0)
CELLS = GridSettings(rows=1, cols=1, raise_alpha=0.5, lower_alpha=0.9)


@pytest.fixture(scope="module")
def log_text() -> str:
    return "\n".join(drive_lines(60))


@pytest.fixture
def log(log_text: str) -> RecordedLog:
    return parse_carmen(log_text.splitlines())


@given(scans=st.integers(1, 2600), cases=st.integers(1, 150), seed=st.integers(0, 5))
@settings(max_examples=30, deadline=None)
def test_a_log_is_divided_as_the_protocol_says(log_text: str, scans: int, cases: int, seed: int) -> None:
    scan = parse_carmen(log_text.splitlines()[:1]).scans[0]
    division = interleaved(RecordedLog((scan,) * scans, 80.0), cases, seed)
    kept = list(range(scans))[:: 4 if scans > 2000 else 1]
    odd = kept[1::2]
    chosen: Any = np.random.default_rng(seed).choice(len(odd), min(cases, len(odd)), replace=False) if odd else []
    assert [query.number for query in division.queries] == [odd[index] for index in chosen]
    assert len(division.map_scans) == len(kept[::2])


def test_what_came_back_is_a_hit_and_what_did_not_is_free_up_to_the_limit(log: RecordedLog) -> None:
    scan = next(scan for scan in log.scans if scan.missed.any())
    readings = readings_of(scan, REACH)
    beyond = int((scan.hit & (scan.ranges_m > REACH.range_max_m)).sum())
    missed = [reading for reading in readings if reading.status is ReadingStatus.MISS]
    assert len(missed) == int(scan.missed.sum()) + beyond
    assert {reading.range_m for reading in missed} == {REACH.clear_m}
    hits = [reading.range_m for reading in readings if reading.status is ReadingStatus.OK]
    assert hits == scan.ranges_m[scan.hit & (scan.ranges_m <= REACH.range_max_m)].tolist()


def test_a_beam_of_range_zero_says_nothing() -> None:
    [scan] = parse_carmen(["FLASER 4 0 1 1 1 0 0 0 0 0 0 1 h 1"]).scans
    assert [reading.range_m for reading in readings_of(scan, REACH)] == [1.0, 1.0, 1.0]


def test_the_map_holds_every_hit_where_the_log_has_it(log: RecordedLog) -> None:
    grid = map_of(log.scans, REACH, CELLS)
    occupied = np.argwhere(grid.cells > 200)
    x_m, y_m = np.array([grid.spec.centre_of(row, col) for row, col in occupied]).T
    assert (x_m.min(), x_m.max(), y_m.min(), y_m.max()) == pytest.approx((0.0, 5.0, 0.0, 3.0), abs=0.06)


@given(scans=st.integers(2, 2600), cases=st.integers(1, 50), seed=st.integers(0, 5))
@settings(max_examples=30, deadline=None)
def test_half_a_log_is_asked_of_the_other_half(log_text: str, scans: int, cases: int, seed: int) -> None:
    scan = parse_carmen(log_text.splitlines()[:1]).scans[0]
    kept = list(range(scans))[:: 4 if scans > 2000 else 1]
    division = halves(RecordedLog((scan,) * scans, 80.0), cases, seed)
    middle = (len(kept) + 1) // 2
    assert len(division.map_scans) == middle
    assert {query.number for query in division.queries} <= set(kept[middle:])
    assert len(division.queries) == min(cases, len(kept) - middle)
    assert all(query.is_near and query.truth == scan.laser_pose for query in division.queries)


def test_a_query_is_near_where_a_scan_of_the_map_was_taken_nearby(log: RecordedLog) -> None:
    ahead, back = log.scans[10], log.scans[-10]
    division = interleaved(RecordedLog((ahead, ahead, ahead, back), 80.0), 2, 0)
    assert {query.number: query.is_near for query in division.queries} == {1: True, 3: False}


def test_on_another_buildings_map_nothing_is_right(log: RecordedLog, job: Seeking) -> None:
    queries = elsewhere(log, log, 3, 0).queries
    assert [query.truth for query in queries] == [None] * 3
    verdicts = {result.verdict for result in map(job, queries)}
    assert CaseVerdict.RIGHT not in verdicts
    assert CaseVerdict.WRONG_AND_SURE in verdicts  # it was its own map after all, so it is sure


def job_of(log: RecordedLog, **others: Any) -> Seeking:
    """The even scans make the map; ``others`` of the recipe, or of what is localized by."""
    recipe = MapRecipe(interleaved(log, 4, 0).map_scans, REACH, CELLS, None, 0)
    judged = SeekingSettings(REACH, LocalizationSettings(), Judgement(), ErrorModel(), 1)
    recipe = replace(recipe, **{name: value for name, value in others.items() if hasattr(recipe, name)})
    judged = replace(judged, **{name: value for name, value in others.items() if hasattr(judged, name)})
    return Seeking.of("room.log", recipe, judged, seed=0, commit=program(), protocol="interleaved")


@pytest.fixture
def job(log: RecordedLog) -> Seeking:
    return job_of(log)


def timeless(result: CaseResult) -> CaseResult:
    return replace(result, cpu_s=0.0, wall_s=0.0)


def in_another_process(job: Seeking, queries: Iterable[Query]) -> list[CaseResult]:
    """Be a schedule: send all of it out by bytes, and get it back so."""
    code = (
        "import pickle, sys; job, *queries = pickle.load(sys.stdin.buffer);"
        "pickle.dump([*map(job, queries)], sys.stdout.buffer)"
    )
    found = subprocess.run(
        [sys.executable, "-c", code], input=pickle.dumps((job, *queries)), capture_output=True, check=True, timeout=60.0
    )
    results: list[CaseResult] = pickle.loads(found.stdout)
    return results


def test_cases_mean_the_same_in_processes_of_their_own(log: RecordedLog, job: Seeking) -> None:
    queries = interleaved(log, 4, 0).queries
    elsewhere = in_another_process(job, queries)
    assert [timeless(result) for result in elsewhere] == [timeless(result) for result in map(job, queries)]
    assert len({result.key for result in elsewhere}) == len(queries)


def test_a_key_changes_with_whatever_the_answer_depends_on(log: RecordedLog, job: Seeking) -> None:
    moved = replace(log.scans[0], robot_pose=Pose2(0.0, 0.0, 0.5))
    shorter = replace(log.scans[0], ranges_m=log.scans[0].ranges_m - 0.01)
    others: list[dict[str, Any]] = [
        {"localization": LocalizationSettings(range_error_m=0.2)},
        {"scans": (moved, *job.recipe.scans[1:])},
        {"scans": (shorter, *job.recipe.scans[1:])},
        {"kind": "blurred"},
        {"grid": replace(CELLS, resolution_m=0.1)},
    ]
    digests = {job.digest, *(job_of(log, **other).digest for other in others)}
    assert len(digests) == 1 + len(others)
    assert job_of(log, threads=7).digest == job.digest


def test_the_truth_is_turned_with_the_map(log: RecordedLog) -> None:
    turned, query = job_of(log, kind="turned-30deg"), interleaved(log, 1, 0).queries[0]
    assert query.truth is not None
    assert turned(query).truth == Pose2(0.0, 0.0, math.radians(30.0)) @ query.truth


def test_a_result_is_small_and_comes_back_whole(log: RecordedLog, job: Seeking) -> None:
    result = job(interleaved(log, 1, 0).queries[0])
    packed = pickle.dumps(result)
    assert len(packed) < 4096
    assert pickle.loads(packed) == result
