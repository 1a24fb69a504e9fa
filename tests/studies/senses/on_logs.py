"""Robots carried off in a recorded building: mapped from its raw odometry, asked with scans the map is not made of."""

import random
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from robotd.app.compose import head_settings
from robotd.config import Config
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.core.grid_bytes import packed_cells
from robotd.core.motion_error import MotionError
from robotd.core.pose import Pose2
from robotd.evaluation.recorded import Reach, map_of, readings_of
from robotd.evaluation.surveyed import located, surveyed
from robotd.grid.settings import GridSettings
from robotd.head.desk import Desk
from robotd.head.job_table import perform
from robotd.head.jobs import MapRef, Narrow, Prepare, TakeMap
from robotd.logs.scan import Scan
from robotd.mission.whereabouts.carried import Carried, Sure
from robotd.slam.survey import SurveySettings
from tests.studies.senses.trials import CARRIED_M, SAME_M, Came, CarriedOff, came

_REACH = Reach(range_max_m=30.0, clear_m=8.0)
"""As ``robotctl eval --slam`` believes recorded ranges."""
_CELL_M = 0.1
_STOP = 1


@dataclass(frozen=True, slots=True)
class OnLog:
    """One robot in a recorded building."""

    known: Came
    """What it came to before it was carried, nothing known."""
    carried: CarriedOff | None
    """None if it did not know where it was, or if the two scans were taken close by each other."""


@dataclass(frozen=True)
class LoggedGround:
    """A recorded building, mapped by its own stops, and the scans of the log that are none."""

    desk: Desk
    map: MapRef
    scans: Sequence[Scan]
    asked: Sequence[int]
    """Which of the scans are no stops, nor the scan before one: there is one more of the same place."""
    truth: dict[int, Pose2]
    """Where the laser was at these and at those after them: placed on the finished map by what odometry knows."""

    @classmethod
    def of(cls, scans: Sequence[Scan], robots: int, seed: int = 1) -> "LoggedGround":
        """Map a log from its raw odometry; ``robots`` are carried from one scan that is asked to another."""
        found = surveyed(scans, _REACH, SurveySettings())
        graph = found.survey.graph
        laid = [(found.stops[stop], graph.pose(stop)) for stop in graph.laid.tolist()]
        grid = map_of(
            tuple(replace(scans[scan], robot_pose=pose) for scan, pose in laid),
            _REACH,
            GridSettings(resolution_m=_CELL_M, rows=1, cols=1),
        )
        desk = Desk(head_settings(Config()))
        perform(desk, TakeMap(0, grid.spec, memoryview(packed_cells(grid.cells)), grid.settings))
        no_stops = np.setdiff1d(np.arange(len(scans) - 1), [near for stop in found.stops for near in (stop - 1, stop)])
        drawn = random.Random(seed).sample(no_stops.tolist(), min(2 * robots, len(no_stops)))
        poses = located(found, [scan for one in drawn for scan in (one, one + 1)], _REACH)
        truth = {scan: pose @ scans[scan].robot_from_laser for scan, pose in poses.items()}
        return cls(desk, MapRef(0), scans, drawn, truth)

    def look(self, scan: int) -> PoseEstimate:
        """Return what one whole scan says, nothing known and all headings tried."""
        headings_rad = Config().localization.headings_all_round()
        perform(self.desk, Prepare(_STOP, self.map, "m", headings_rad, None))
        readings = readings_of(self.scans[scan], _REACH)
        return perform(self.desk, Narrow(_STOP, readings, 0, final=True)).estimate


def carried_off(ground: LoggedGround, robot: int) -> OnLog:
    """Look where a scan was taken, and be carried to where another was, wheels at rest; then look with two scans."""
    before, after = ground.asked[2 * robot : 2 * robot + 2]
    carried = Carried(MotionError(), Sure(0.05, is_proof=False))
    in_odom = _laser_in_odom(ground.scans[before])
    known = came(_weighed(carried, ground.look(before), in_odom), ground.truth[before])
    if known is not Came.RIGHT or ground.truth[before].distance_m(ground.truth[after]) < CARRIED_M:
        return OnLog(known, None)
    first = _weighed(carried, ground.look(after), in_odom)
    if came(first, ground.truth[after]) is Came.WRONG:
        return OnLog(known, CarriedOff(False, Came.WRONG))
    noticed = first.contradiction is not None or first.state is PoseState.LOST
    step = _laser_in_odom(ground.scans[after]).inverse() @ _laser_in_odom(ground.scans[after + 1])
    second = _weighed(carried, ground.look(after + 1), in_odom @ step)
    return OnLog(known, CarriedOff(noticed, came(second, ground.truth[after + 1])))


def _weighed(carried: Carried, estimate: PoseEstimate, in_odom: Pose2) -> PoseEstimate:
    carried.moved(in_odom)
    carried.looks(in_odom)
    return carried.weighed(estimate, None, in_odom, SAME_M)


def _laser_in_odom(scan: Scan) -> Pose2:
    return scan.odometry @ scan.robot_from_laser
