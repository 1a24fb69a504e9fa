"""Real readings: the unmodified daemon maps a recorded building, and is found at stops kept out of the map."""

from dataclasses import replace
from pathlib import Path

import pytest

from robotd.config import Config
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import SweepDone
from robotd.contract.missions import DriveTo, Legs, Localize, MapStart
from robotd.core.reading import ReadingStatus
from robotd.localization.stop_poses import StopPoses
from robotd.sim.buildings.building import RecordedBuilding, select_stops
from robotd.sim.buildings.log_file import read_log
from robotd.sim.recorded_robot import OdometrySource, RecordedRobot
from tests.integration.conftest import Live

pytestmark = [pytest.mark.slow, pytest.mark.real_data]

LOGS = {"intel": "intel/intel.corrected.log.gz", "fr079": "fr079/fr079.corrected.log.gz"}
FOUND_AT_LEAST = {"intel": 0, "fr079": 2}
"""Of four kept-out stops. Half a circle, seen from where no stop of so small a map looked, is rightly called lost."""


def robot_of(log: Path, odometry: OdometrySource) -> RecordedRobot:
    stops = select_stops(read_log(log), 0.5, keep_out_every=4, limit=16)
    return RecordedRobot(RecordedBuilding(log.name, stops), seed=1, odometry=odometry)


def config() -> Config:
    seeing_far = Config()
    rangefinder = replace(seeing_far.rangefinder, range_max_m=10.0)
    # A recorded robot sees only where it was, and that is known in its odometry's frame.
    by_odometry = replace(seeing_far.localization, stops=StopPoses.ODOMETRY)
    return replace(seeing_far, rangefinder=rangefinder, localization=by_odometry)


@pytest.mark.parametrize("name", LOGS)
async def test_at_stops_kept_out_of_the_map_it_is_never_sure_of_a_wrong_place(
    live: Live, laser_data: Path, name: str
) -> None:
    robot = robot_of(laser_data / LOGS[name], OdometrySource.CORRECTED)
    async with live(robot, config()) as it:
        said = await it.done(MapStart.of(name, robot.stops_m, robot.start, Legs.STRAIGHT))
        sweeps = [event.sweep for event in said if isinstance(event, SweepDone)]
        assert len(sweeps) == 12
        for sweep in sweeps:
            assert len(sweep.readings) == 300
            assert 140 <= sweep.count(ReadingStatus.NOT_MEASURED) <= 160
        errors_m = []
        for probe_m in reversed(robot.probes_m):
            await it.done(DriveTo(*probe_m, legs=Legs.STRAIGHT))
            here = robot.truth
            found = [e for e in await it.done(Localize(tie=False)) if isinstance(e, PoseEstimate)][-1]
            if found.state is PoseState.LOCALIZED:
                assert found.best is not None
                errors_m.append(found.best.distance_m(here))
        assert len(errors_m) >= FOUND_AT_LEAST[name]
        assert max(errors_m, default=0.0) < 0.3


async def test_raw_odometry_drifts_away_from_the_corrected_one(live: Live, laser_data: Path) -> None:
    robot = robot_of(laser_data / LOGS["intel"], OdometrySource.RAW)
    async with live(robot, config()) as it:
        await it.done(MapStart.of("raw", robot.stops_m[:3], robot.start, Legs.STRAIGHT))
        odometry = it.daemon.robot.drive.odometry.latest
        assert odometry is not None
        believed = robot.start @ odometry.in_odom
        assert 0.0 < believed.distance_m(robot.truth) < 1.0
