"""Who is on a line: each dialect that may be asked is found by its answer, and no question moves anything."""

import asyncio
from typing import Any

import pytest

from robotd.hardware.devices.catalogue import SPEAKERS
from robotd.hardware.devices.dialects import MOTORLESS, SCANNERS
from robotd.hardware.devices.finding import Recognized, found_by
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.transport.transport import Transport
from robotd.hardware.wire.enquiry import Enquiry, NotAsked
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.robot import SimulatedRobot
from robotd.sim.runtime import connectors

QUESTIONS = {
    (device, name): row.speech.enquiry
    for device, table in SPEAKERS.items()
    for name, row in table.items()
    if row.speech is not None
}
TFMINIS = ("tfmini-s", "tfmini-plus", "tf-luna")


def robot_speaking(device: str, dialect: str) -> SimulatedRobot:
    spoken: dict[str, Any] = {device: dialect} | ({"pantilt": MOTORLESS} if dialect in SCANNERS else {})
    return SimulatedRobot(load_world("office"), dialects=Dialects(**spoken))


async def asked(robot: SimulatedRobot, device: str) -> Recognized | None:
    """Ask whatever the line would have to be set to: each question is heard as it was meant."""
    async with connectors(robot) as connect:

        async def open_line(_: LineFormat) -> Transport:
            return await connect[device]()

        found = await found_by(open_line)
        await asyncio.sleep(1.0)
    return found


@pytest.mark.parametrize(("device", "dialect"), QUESTIONS)
async def test_it_is_found_by_its_answer_and_stands_as_it_stood(device: str, dialect: str) -> None:
    robot = robot_speaking(device, dialect)
    stood, looked = robot.truth, robot._head.angles_rad
    found = await asked(robot, device)
    assert (robot.truth, robot._head.angles_rad, robot.at_rest) == (stood, looked, True)
    if isinstance(QUESTIONS[device, dialect], NotAsked):
        assert found is None
        return
    assert found is not None
    assert (found.device, found.dialects) == (device, TFMINIS if dialect in TFMINIS else (dialect,))
    assert found.said


def test_what_obeys_at_once_is_not_asked() -> None:
    asked_of = {name for (_, name), question in QUESTIONS.items() if isinstance(question, Enquiry)}
    assert {name for _, name in QUESTIONS} - asked_of == {"rwi-ascii", "rflex", "ptu"}
