"""An error that belongs to no task stops the robot all the same."""

import asyncio
from pathlib import Path

import pytest

from robotd.app.callbacks import stopping_on_errors
from robotd.app.daemon import _halt
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm, Stop
from robotd.core.errors import RobotdError
from robotd.recording.entries import CommandEntry
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from tests.support.living import living


def _wrong() -> None:
    raise KeyError("a mistake")


@pytest.mark.parametrize("how", ["soon", "later", "when a task is done"])
async def test_an_error_in_a_bare_callback_stops_the_robot(how: str, caplog: pytest.LogCaptureFixture) -> None:
    loop, halts, before = asyncio.get_running_loop(), list[str](), asyncio.get_running_loop().get_exception_handler()
    with stopping_on_errors(halts.append):
        if how == "soon":
            loop.call_soon(_wrong)
        elif how == "later":
            loop.call_later(0.1, _wrong)
        else:
            asyncio.create_task(asyncio.sleep(0.1)).add_done_callback(lambda _: _wrong())  # it ends
        await asyncio.sleep(0.2)
    assert halts == ["internal error: KeyError('a mistake')"]
    assert "a mistake" in caplog.text
    assert loop.get_exception_handler() is before


async def test_what_is_no_callback_of_ours_stops_nothing(caplog: pytest.LogCaptureFixture) -> None:
    halts: list[str] = []
    with stopping_on_errors(halts.append):
        asyncio.get_running_loop().call_exception_handler({"message": "a socket was never closed"})
    assert halts == []
    assert "a socket was never closed" in caplog.text


async def test_the_daemon_disarms_for_it_once_and_lives(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    async with living(tmp_path, SimulatedRobot(load_world("office"), seed=4)) as it:
        with stopping_on_errors(lambda reason: _halt(it.daemon, reason)):
            for _ in range(3):
                asyncio.get_running_loop().call_soon(_wrong)
            await asyncio.sleep(0.1)
        status = it.daemon.control.status
        assert (status.mode, status.reason) == (Mode.DISARMED, "internal error: KeyError('a mistake')")
        assert it.daemon.supervisor.halts == 1
        await it.daemon.control.perform(Arm())


async def test_a_stop_for_it_is_noted_even_while_nothing_is_armed_and_gives_up_an_arming(tmp_path: Path) -> None:
    async with living(tmp_path, SimulatedRobot(load_world("office"), seed=4)) as it:
        await it.daemon.control.perform(Stop("enough"))
        arming = asyncio.create_task(it.daemon.control.perform(Arm()))
        await asyncio.sleep(0)  # the first device is asked
        for _ in range(3):
            _halt(it.daemon, "no client can be heard")
        with pytest.raises(RobotdError, match="stopped"):
            await arming
        noted = [entry for entry in it.journal.remembered if isinstance(entry, CommandEntry)]
    assert [(entry.name, entry.arguments.get("reason")) for entry in noted[-3:]] == [
        ("stop", "enough"),
        ("arm", None),
        ("stop", "no client can be heard"),
    ]
