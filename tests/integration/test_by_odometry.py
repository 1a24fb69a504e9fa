"""A straight and a turn by odometry, on a whole robot without a map: as far as asked, and they replay."""

import math
from pathlib import Path

import pytest

from robotd.contract.events import MissionPhase, MissionProgress
from robotd.contract.missions import DriveStraight, Mission, Turn
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm, RecordStart, RecordStop
from robotd.core.angles import wrap_rad
from robotd.core.errors import MissionError
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from tests.integration.conftest import Live
from tests.support.replayed import check, replayed


def office() -> SimulatedRobot:
    return SimulatedRobot(load_world("office"), seed=5)


@pytest.mark.parametrize("distance_m", [0.5, -0.5, 0.0])
async def test_it_drives_as_far_as_asked(live: Live, distance_m: float) -> None:
    robot = office()
    async with live(robot) as it:
        before = robot.truth
        said = await it.done(DriveStraight(distance_m))
        assert robot.at_rest
        x_m, y_m = before.inverse().transform(robot.truth.x_m, robot.truth.y_m)
        assert (x_m, y_m) == pytest.approx((distance_m, 0.0), abs=0.02)
        assert abs(wrap_rad(robot.truth.heading_rad - before.heading_rad)) < math.radians(1.0)
        assert it.daemon.supervisor.mode is Mode.IDLE
    steps = [event for event in said if isinstance(event, MissionProgress)]
    assert [(step.kind, step.phase) for step in steps] == [
        ("move", MissionPhase.STARTED),
        ("move", MissionPhase.DRIVING),
        ("move", MissionPhase.DONE),
    ]
    assert float(steps[-1].message.split()[1]) == pytest.approx(x_m, abs=0.02)


@pytest.mark.parametrize("angle_deg", [90.0, -90.0, 180.0, 450.0])
async def test_it_turns_as_far_as_asked(live: Live, angle_deg: float) -> None:
    robot = office()
    async with live(robot) as it:
        before = robot.truth
        said = await it.done(Turn(math.radians(angle_deg)))
        assert robot.at_rest
        off_rad = wrap_rad(robot.truth.heading_rad - before.heading_rad - math.radians(angle_deg))
        assert abs(off_rad) < math.radians(1.0)
        assert robot.truth.distance_m(before) < 0.02
    end = said[-1]
    assert isinstance(end, MissionProgress)
    assert float(end.message.split()[1]) == pytest.approx(angle_deg, abs=1.0)


@pytest.mark.parametrize("mission", [DriveStraight(0.5), Turn(1.0)])
async def test_who_is_disarmed_does_not_move(live: Live, mission: Mission) -> None:
    async with live(office(), armed=False) as it:
        with pytest.raises(MissionError, match=r"the robot is disarmed \(.* ago\); arm it first, with: robotctl arm"):
            it.daemon.control.start(mission, 1.0)


@pytest.mark.slow
async def test_they_replay(live: Live, tmp_path: Path) -> None:
    file = tmp_path / "recordings" / "hands.mcap"
    async with live(office(), armed=False) as it:
        await it.daemon.control.perform(RecordStart(str(file)))
        await it.daemon.control.perform(Arm())
        for mission in (DriveStraight(0.5), Turn(-7.0), DriveStraight(-0.25)):
            await it.done(mission)
        await it.daemon.control.perform(RecordStop())
    check(replayed(file))
