"""The daemon maps a room and localizes in it whatever its devices speak."""

from dataclasses import replace

import pytest

from robotd.cli.emulated import config_text
from robotd.config import Config, loads
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.missions import Localize, MapStart
from robotd.hardware.devices.dialects import MOTORLESS, SCANNERS
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators.catalogue import DRIVES, OWN, PANTILTS, RANGEFINDERS, Dialects
from robotd.sim.robot import DEVICES, SimulatedRobot
from tests.integration.conftest import Live

READINGS = 150
COMBINATIONS = [
    *(Dialects(drive=dialect) for dialect in DRIVES if dialect != OWN),
    *(Dialects(pantilt=dialect) for dialect in PANTILTS if dialect not in {OWN, MOTORLESS}),
    *(Dialects(rangefinder=dialect) for dialect in RANGEFINDERS if dialect not in {OWN, *SCANNERS}),
    *(Dialects(pantilt=MOTORLESS, rangefinder=scanner) for scanner in SCANNERS),
]


def config_for(dialects: Dialects) -> Config:
    """Return what ``robotctl sim`` would write for these devices."""
    return loads(config_text({device: f"/dev/emulated/{device}" for device in DEVICES}, dialects.settings()))


def name_of(dialects: Dialects) -> str:
    spoken = (dialects.drive, dialects.pantilt, dialects.rangefinder)
    return "-".join(dialect for dialect in spoken if dialect != OWN)


@pytest.mark.slow
@pytest.mark.parametrize("dialects", COMBINATIONS, ids=name_of)
async def test_a_room_is_mapped_and_the_robot_finds_itself_in_it(live: Live, dialects: Dialects) -> None:
    world = load_world("office")
    robot = SimulatedRobot(world, seed=2, dialects=dialects)
    config = replace(config_for(dialects), sweep=SweepSettings(readings=READINGS))
    async with live(robot, config) as it:
        await it.done(MapStart.of("office", world.stops_m[:1], world.start_pose))
        said = await it.done(Localize())
        estimate = [event for event in said if isinstance(event, PoseEstimate) and event.final][-1]
        assert estimate.state is PoseState.LOCALIZED, estimate
