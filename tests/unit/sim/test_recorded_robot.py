import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.core.pose import IDENTITY, Pose2
from robotd.logs.carmen import parse_carmen
from robotd.sim.buildings.building import RecordedBuilding, RecordedStop, encode_recorded_building, select_stops
from robotd.sim.buildings.log_file import read_log
from robotd.sim.load import load_robot
from robotd.sim.recorded_robot import OdometrySource, Place, RecordedHead, RecordedLaser, RecordedRobot

FIRST = RecordedStop(
    scan=0,
    pose=Pose2(1.0, 2.0, 0.0),
    odometry=Pose2(0.0, 0.0, 0.0),
    kept_out=False,
    laser=IDENTITY,
    first_rad=-math.pi / 2,
    step_rad=math.pi / 4,
    ranges_m=(1.0, 2.0, None, 3.0, None),
    missed=(4,),
)
SECOND = replace(
    FIRST,
    scan=1,
    pose=Pose2(3.0, 2.0, 0.5),
    odometry=Pose2(2.0, 0.2, 0.4),
    kept_out=True,
    ranges_m=(5.0,) * 5,
    missed=(),
)
THIRD = replace(FIRST, scan=2, pose=Pose2(5.0, 2.0, 0.0), odometry=Pose2(4.0, 0.5, 0.0))
BUILDING = RecordedBuilding("made.log", (FIRST, SECOND, THIRD))


class Rig:
    """The three plants, without their boards."""

    def __init__(
        self, building: RecordedBuilding = BUILDING, odometry: OdometrySource = OdometrySource.CORRECTED
    ) -> None:
        self.place = Place(building, odometry)
        self.body = self.place.body
        self.head = RecordedHead(self.place)
        self.laser = RecordedLaser(self.place, self.head)
        self.laser.switch(on=True)
        self.now_us = 0
        self.body.advance(0)

    def drive(self, way_m: float, turn_rad: float = 0.0) -> None:
        """Turn at 1 rad/s, then go at 1 m/s, and stand."""
        turn, way = (0.0, math.copysign(1.0, turn_rad)), (math.copysign(1.0, way_m), 0.0)
        for command, amount in ((turn, turn_rad), (way, way_m)):
            self.body.command(*command)
            self.now_us += round(abs(amount) * 1e6)
            self.body.advance(self.now_us)
            self.body.command(0.0, 0.0)
            self.now_us += 1_000_000
            self.body.advance(self.now_us)

    def look(self, pan_rad: float) -> tuple[ShotStatus, float]:
        self.head.aim(pan_rad, 0.0)
        answer = self.laser.shoot(self.now_us)
        return answer.status, round(answer.range_m, 6)


def test_it_starts_at_the_first_stop_and_answers_with_its_scan() -> None:
    rig = Rig()
    assert rig.body.true_pose == rig.place.truth == FIRST.pose
    assert rig.look(-math.pi / 2) == (ShotStatus.OK, 1.0)
    assert rig.look(-math.pi / 4) == (ShotStatus.OK, 2.0)
    assert rig.look(math.pi / 4) == (ShotStatus.OK, 3.0)
    assert rig.look(math.pi / 2) == (ShotStatus.OVER_RANGE, 0.0)


def test_what_the_scanner_did_not_see_is_not_measured_and_the_head_stays_as_aimed() -> None:
    rig = Rig()
    for pan_rad in (0.0, math.pi, -2.5):
        assert rig.look(pan_rad) == (ShotStatus.NOT_MEASURED, 0.0)
        assert rig.head.angles_rad == (pan_rad, 0.0)


def test_the_head_rests_on_the_nearest_beam_and_reads_that_back() -> None:
    rig = Rig()
    rig.head.aim(-math.pi / 4 + 0.3, 0.0)
    assert rig.head.angles_rad == pytest.approx((-math.pi / 4, 0.0))
    assert rig.head.arrives_us is None


def test_directions_are_those_of_the_world_whatever_the_robots_heading() -> None:
    rig = Rig()
    rig.drive(0.0, turn_rad=1.0)
    turned_rad = rig.body.true_pose.heading_rad
    assert turned_rad == pytest.approx(1.0, abs=0.1)
    assert rig.look(-math.pi / 4 - turned_rad) == (ShotStatus.OK, 2.0)


def test_between_stops_and_on_the_move_nothing_is_measured() -> None:
    rig = Rig()
    rig.drive(1.0)
    assert rig.look(-math.pi / 4)[0] is ShotStatus.NOT_MEASURED
    standing = Rig()
    standing.body.command(0.1, 0.0)
    assert standing.look(-math.pi / 4)[0] is ShotStatus.NOT_MEASURED


def test_near_a_stop_the_end_points_are_those_of_the_record() -> None:
    rig = Rig()
    rig.drive(1.92)
    assert 0.01 < rig.place.truth.distance_m(SECOND.pose) < 0.15
    for beam in range(5):
        bearing_rad = SECOND.pose.heading_rad + SECOND.first_rad + beam * SECOND.step_rad
        end = (3.0 + 5.0 * math.cos(bearing_rad), 2.0 + 5.0 * math.sin(bearing_rad))
        status, range_m = rig.look(bearing_rad - rig.body.true_pose.heading_rad)
        seen = rig.body.true_pose @ Pose2(0.0, 0.0, rig.head.angles_rad[0])
        assert status is ShotStatus.OK
        assert seen.transform(range_m, 0.0) == pytest.approx(end, abs=1e-5)


def test_a_laser_switched_off_says_so() -> None:
    rig = Rig()
    rig.laser.switch(on=False)
    assert rig.look(0.0)[0] is ShotStatus.LASER_OFF


def test_with_raw_odometry_the_stops_are_where_the_wheels_believe_and_the_truth_is_the_logs() -> None:
    robot = RecordedRobot(BUILDING, odometry=OdometrySource.RAW)
    assert robot.start == FIRST.pose
    assert robot.probes_m == ((3.0, 2.2),)
    assert robot.stops_m == ((5.0, 2.5),)
    rig = Rig(odometry=OdometrySource.RAW)
    rig.drive(2.01, turn_rad=math.atan2(0.2, 2.0))
    here = rig.body.true_pose
    in_stop = Pose2(3.0, 2.2, 0.4).inverse() @ here
    assert math.hypot(in_stop.x_m, in_stop.y_m) < 0.15
    assert rig.place.truth == SECOND.pose @ in_stop
    assert rig.look(0.4 - here.heading_rad)[0] is ShotStatus.OK


def test_the_robot_lists_the_stops_of_the_map_and_those_kept_out() -> None:
    robot = RecordedRobot(BUILDING)
    assert robot.start == robot.truth == FIRST.pose
    assert robot.at_rest
    assert robot.stops_m == ((5.0, 2.0),)
    assert robot.probes_m == ((3.0, 2.0),)
    assert list(robot.boards) == ["drive", "pantilt", "rangefinder"]


def test_a_robot_is_loaded_by_world_name_or_building_file(tmp_path: Path) -> None:
    assert load_robot("office", 3).start == Pose2(1.0, 1.1, 0.0)
    stops = select_stops(parse_carmen(["FLASER 2 1.0 2.0 4 5 0 4 5 0 1 h 1"]))
    (tmp_path / "x.building").write_bytes(encode_recorded_building(RecordedBuilding("x", stops)))
    assert load_robot(str(tmp_path / "x.building")).start == Pose2(4.0, 5.0, 0.0)


@pytest.mark.real_data
@pytest.mark.parametrize("place", ["intel", "fr079"])
def test_in_a_real_building_300_bearings_give_the_recorded_half_circle(laser_data: Path, place: str) -> None:
    log = read_log(laser_data / place / f"{place}.corrected.log.gz")
    stops = select_stops(log, 5.0, limit=4)
    stop, scan = stops[-1], log.scans[stops[-1].scan]
    rig = Rig(RecordedBuilding("real", (replace(stop, kept_out=False),)))
    answers = [rig.look(math.tau * index / 300 - math.pi) for index in range(300)]
    measured = [answer for answer in answers if answer[0] is not ShotStatus.NOT_MEASURED]
    assert 148 <= len(measured) <= 153
    ends = [
        scan.laser_pose.transform(float(r) * math.cos(a), float(r) * math.sin(a))
        for r, a, hit in zip(scan.ranges_m, scan.angles_rad, scan.hit, strict=True)
        if hit
    ]
    for index in range(300):
        status, range_m = rig.look(math.tau * index / 300 - math.pi)
        if status is ShotStatus.OK:
            end = (rig.body.true_pose @ Pose2(0.0, 0.0, rig.head.angles_rad[0])).transform(range_m, 0.0)
            assert np.min(np.hypot(*(np.array(ends) - np.array(end)).T)) < 2e-6
