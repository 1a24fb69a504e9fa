"""A look that leaves two places: the robot drives to where they differ, and knows; and a replay drives the same."""

from dataclasses import replace
from pathlib import Path

import pytest

from robotd.config import Config
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import MissionPhase, MissionProgress
from robotd.contract.missions import Resolve
from robotd.contract.requests import MapLoad, RecordStart, RecordStop
from robotd.maps.store import MapStore
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from tests.integration.conftest import Live
from tests.studies.senses.ground import Ground
from tests.support.replayed import check, replayed

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]


async def test_of_two_equal_rooms_it_finds_out_which_it_is_by_driving(live: Live, tmp_path: Path) -> None:
    world = load_world("symmetric")
    MapStore(tmp_path / "maps").save("rooms", Ground.of(world, seed=1).grid, {}, 0)
    robot = SimulatedRobot(world, seed=3)
    config = Config(sweep=replace(Config().sweep, readings=150))
    async with live(robot, config) as it:
        file = tmp_path / "recordings" / "resolving.mcap"
        await it.daemon.control.perform(MapLoad("rooms"))
        await it.daemon.control.perform(RecordStart(str(file)))
        said = await it.done(Resolve())
        first, *_, last = (
            event for event in said if isinstance(event, PoseEstimate) and event.final and event.readings
        )
        assert (first.state, len(first.regions)) == (PoseState.AMBIGUOUS, 2)
        assert last.state is PoseState.LOCALIZED
        assert last.best is not None
        assert last.best.distance_m(robot.truth) < 0.2
        driven = [one for one in said if isinstance(one, MissionProgress) and one.phase is MissionPhase.DRIVING]
        assert all("2 places: " in one.message and "free under each" in one.message for one in driven)
        assert 1 <= len({one.stop for one in driven}) <= 2
        await it.daemon.control.perform(RecordStop())
    check(replayed(file))
