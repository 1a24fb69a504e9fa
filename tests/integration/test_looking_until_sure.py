"""Looks that end when they are sure; and a replay looks at the same."""

from dataclasses import replace
from pathlib import Path

import pytest

from robotd.config import Config
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import Event, MissionProgress, SweepDone
from robotd.contract.missions import Localize, MapStart, PriorHeading, Resolve
from robotd.contract.requests import RecordStart, RecordStop
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from tests.integration.conftest import Live
from tests.support.living import Living
from tests.support.replayed import check, replayed

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]


def final(said: list[Event]) -> PoseEstimate:
    finals = [event for event in said if isinstance(event, PoseEstimate) and event.final]
    return next(one for one in reversed(finals) if one.state is not PoseState.PREDICTED)


def is_right(estimate: PoseEstimate, robot: SimulatedRobot) -> bool:
    return estimate.best is not None and estimate.best.distance_m(robot.truth) < 0.2


def forgets(it: Living) -> None:
    """Somebody switched it off and on again: nothing is known of where it is."""
    it.daemon.supervisor.whereabouts.doubt()


async def test_a_few_readings_are_enough_where_no_place_is_like_another_and_a_replay_takes_the_same(
    live: Live, tmp_path: Path
) -> None:
    robot = SimulatedRobot(load_world("office"), seed=1)
    config = Config(sweep=replace(Config().sweep, readings=150))
    async with live(robot, config) as it:
        file = tmp_path / "recordings" / "resolving.mcap"
        await it.daemon.control.perform(RecordStart(str(file)))
        await it.done(MapStart.of("office", robot.stops_m[:2], robot.start))
        forgets(it)
        said = await it.done(Localize(heading=PriorHeading.UNKNOWN, adaptive=True))
        (sweep,) = (event.sweep for event in said if isinstance(event, SweepDone))
        assert len(sweep.readings) < 60
        assert final(said).readings == len(sweep.measured)
        assert is_right(final(said), robot)

        forgets(it)
        said = await it.done(Resolve())
        ended = next(one for one in reversed(said) if isinstance(one, MissionProgress))
        assert "1 stops, 0.0 m driven" in ended.message
        assert final(said).state is PoseState.LOCALIZED
        assert is_right(final(said), robot)
        await it.daemon.control.perform(RecordStop())
    check(replayed(file))
