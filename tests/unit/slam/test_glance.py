"""A few readings between two stops say where the robot is, or leave odometry its word."""

import numpy as np

from robotd.core.motion_error import Travel
from robotd.core.pose import Pose2
from robotd.slam.glance import glanced
from robotd.slam.survey import Survey, SurveySettings
from tests.support.surveyed_room import odometry_of, room, sweep_at, way_round

WALLS, POSES = room(), way_round()[:8]


def surveyed() -> Survey:
    random = np.random.default_rng(3)
    survey = Survey.begun(sweep_at(WALLS, POSES[0], random), POSES[0], SurveySettings(loops=None))
    for pose, travel in zip(POSES[1:], odometry_of(POSES, np.random.default_rng(4)), strict=False):
        survey, _ = survey.stepped(sweep_at(WALLS, pose, random), travel)
    return survey


def test_twenty_readings_bring_it_back_to_where_it_is() -> None:
    survey, truth = surveyed(), POSES[-1] @ Pose2(0.9, 0.1, 0.4)
    since = survey.graph.pose(len(POSES) - 1)
    lie = Travel(Pose2(0.8, 0.05, 0.36), 0.95, 0.4)
    pose, is_found = glanced(survey, sweep_at(WALLS, truth, np.random.default_rng(5), beams=20), since, lie)
    assert is_found
    by_odometry = since @ lie.step
    assert by_odometry.distance_m(truth) > 0.09
    assert pose.distance_m(truth) < 0.5 * by_odometry.distance_m(truth)


def test_where_the_map_does_not_explain_them_odometry_has_its_word() -> None:
    survey = surveyed()
    since, travel = survey.graph.pose(len(POSES) - 1), Travel(Pose2(0.5, 0.0, 0.0), 0.5, 0.0)
    elsewhere = sweep_at(WALLS, Pose2(9.5, 6.0, 1.0), np.random.default_rng(6), beams=20)
    pose, is_found = glanced(survey, elsewhere, since, travel)
    assert not is_found
    assert pose == since @ survey.bias.corrected(travel)
    assert glanced(survey, elsewhere[:4], since, travel) == (pose, False)
