"""The exact answer on the true walls contains the truth whenever the readings are right."""

import math

from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.exact.feasible import best_rank, of_rank
from robotd.exact.locate import contains
from robotd.exact.points import Point
from robotd.exact.rationals import rational
from tests.studies.paper.exact import exact_ranks, obstacles_of
from tests.studies.paper.robot import true_ranges_m
from tests.studies.paper.rooms import LABORATORY, TESTS


def test_true_readings_are_all_explained_where_the_robot_is() -> None:
    pose = Pose2(2.4, 5.5, 0.3)
    ranges_m = true_ranges_m(LABORATORY.world, pose, 12)
    readings = [
        RangeReading(0, math.tau * number / 12, ReadingStatus.OK, range_m) for number, range_m in enumerate(ranges_m)
    ]
    ranks = exact_ranks(obstacles_of(LABORATORY), readings, pose.heading_rad)
    assert best_rank(ranks) == 12
    truth = Point(rational("2.4"), rational("5.5"))
    assert contains(of_rank(ranks, 12), truth)
    assert not contains(of_rank(ranks, 12), truth.moved(rational(1), rational(0)))


def test_every_room_of_the_paper_is_a_map_of_polygons() -> None:
    for room in {test.room.name: test.room for test in TESTS}.values():
        start = room.world.start
        assert not contains(obstacles_of(room), Point(rational(str(start.x_m)), rational(str(start.y_m))))
