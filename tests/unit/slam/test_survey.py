import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from robotd.core.motion_error import Travel
from robotd.core.pose import Pose2
from robotd.grid.readings import Readings
from robotd.localization.outcome import Outcome
from robotd.slam.loops import LoopSettings
from robotd.slam.survey import Decision, LoopClosed, LoopHeld, Reconciled, StopPlaced, Survey, SurveySettings
from tests.support.surveyed_room import odometry_of, room, sweep_at, way_round

WALLS = room()
POSES = way_round(2)
ROUND = len(way_round())


def sweeps(seed: int = 1) -> list[Readings]:
    random = np.random.default_rng(seed)
    return [sweep_at(WALLS, pose, random) for pose in POSES]


@cache
def walked(settings: SurveySettings | None = None) -> tuple[Survey, list[Decision]]:
    return walk(settings)


def walk(
    settings: SurveySettings | None = None, seed: int = 2, stops: int = len(POSES)
) -> tuple[Survey, list[Decision]]:
    seen = sweeps()
    survey = Survey.begun(seen[0], POSES[0], settings)
    decisions: list[Decision] = []
    for readings, travel in zip(seen[1:stops], odometry_of(POSES, np.random.default_rng(seed)), strict=False):
        survey, more = survey.stepped(readings, travel)
        decisions += more
    return survey, decisions


def worst_m(survey: Survey) -> float:
    return max(survey.graph.pose(stop).distance_m(pose) for stop, pose in enumerate(POSES))


def test_twice_round_a_room_with_bad_odometry_comes_out_to_centimetres() -> None:
    survey, decisions = walked()
    assert worst_m(survey) < 0.12
    outcomes = [one.placed.outcome for one in decisions if isinstance(one, StopPlaced)]
    assert len(outcomes) == len(POSES) - 1
    assert Outcome.CONTRADICTS not in outcomes
    drifted = POSES[0]
    for travel in odometry_of(POSES, np.random.default_rng(2)):
        drifted @= travel.step
    assert drifted.distance_m(POSES[-1]) > 1.0


def test_the_same_sweeps_give_the_same_bits() -> None:
    one, other = walk(stops=34)[0], walk(stops=34)[0]
    assert one.graph.poses.tobytes() == other.graph.poses.tobytes()


def drifted_round(survey: Survey, drift: Pose2) -> Survey:
    """Return the survey with everything since half a round moved: as if its steps had been wrong there."""
    graph, half = survey.graph, ROUND // 2
    poses, about = graph.poses.copy(), graph.pose(half)
    for stop in range(half, len(poses)):
        moved = about @ drift @ about.inverse() @ graph.pose(stop)
        poses[stop] = moved.x_m, moved.y_m, moved.heading_rad
    edges = list(graph.edges)
    bent = edges[half - 1]
    edges[half - 1] = replace(bent, step=bent.step @ drift, covariance=100.0 * bent.covariance)
    return replace(survey, graph=replace(graph, poses=poses, edges=tuple(edges)))


def test_a_large_loop_is_held_until_a_second_stop_agrees_and_then_bends_the_map_back() -> None:
    seen, travels = sweeps(), odometry_of(POSES, np.random.default_rng(2))
    loops = LoopSettings(behind=15)
    survey = Survey.begun(seen[0], POSES[0], SurveySettings(loops=None))
    for readings, travel in zip(seen[1:ROUND], travels, strict=False):
        survey, _ = survey.stepped(readings, travel)
    survey = drifted_round(survey, Pose2(0.3, 0.35, 0.04))
    survey = replace(survey, settings=SurveySettings(loops=loops))
    kinds: list[type[Decision]] = []
    for readings, travel in zip(seen[ROUND : ROUND + 12], travels[ROUND - 1 :], strict=False):
        survey, decisions = survey.stepped(readings, travel)
        kinds += [type(one) for one in decisions if not isinstance(one, StopPlaced)]
        if Reconciled in kinds:
            break
    assert kinds[0] is LoopHeld  # one stop alone is never believed that far
    assert kinds.count(LoopClosed) >= 2
    assert Reconciled in kinds
    worst = max(survey.graph.pose(stop).distance_m(POSES[stop]) for stop in range(len(survey.graph.stops)))
    assert worst < 0.25


def test_three_sweeps_that_contradict_open_a_segment_and_the_map_stays_clean() -> None:
    survey, _ = walked()
    count = np.sum([stop.is_laid for stop in survey.graph.stops])
    box = Readings(np.column_stack((np.arange(300) * math.tau / 300, np.full(300, 1.6), *np.zeros((3, 300)))))
    outcomes = []
    for _ in range(3):
        survey, decisions = survey.stepped(box, Travel(Pose2(0.0, 0.0, 0.2), 0.0, 0.2))
        outcomes += [one.placed.outcome for one in decisions if isinstance(one, StopPlaced)]
    assert outcomes == [Outcome.CONTRADICTS] * 3
    assert [stop.is_laid for stop in survey.graph.stops[-3:]] == [False, False, True]
    assert [stop.segment for stop in survey.graph.stops[-4:]] == [0, 0, 0, 1]
    assert np.sum([stop.is_laid for stop in survey.graph.stops]) == count + 1


def test_a_sweep_of_few_readings_is_kept_and_placed_by_odometry() -> None:
    seen = sweeps()
    survey = Survey.begun(seen[0], POSES[0])
    travel = odometry_of(POSES, np.random.default_rng(2))[0]
    survey, (placed,) = survey.stepped(seen[1][:5], travel)
    assert isinstance(placed, StopPlaced)
    assert placed.placed.outcome is Outcome.NEW_GROUND
    assert survey.graph.pose(1) == POSES[0] @ travel.step


def test_without_loops_none_is_closed() -> None:
    _, decisions = walked(SurveySettings(loops=None))
    assert all(isinstance(one, StopPlaced) for one in decisions)


@pytest.mark.parametrize("turn_rad", [0.0, 1.0])
def test_moving_all_stops_tells_how_far(turn_rad: float) -> None:
    survey = Survey.begun(sweeps()[0], POSES[0])
    moved, told = survey.moved_to(survey.graph.poses + np.array([0.3, 0.4, turn_rad]))
    assert told.stops_moved == 1
    assert told.largest_move_m == pytest.approx(0.5)
    assert moved.graph.pose(0).heading_rad == pytest.approx(POSES[0].heading_rad + turn_rad)
