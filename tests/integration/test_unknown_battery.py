"""What was not heard yet is not told: the battery of each base, before its first word and after it was unplugged."""

import asyncio
from collections.abc import Callable
from pathlib import Path

import pytest

from robotd.contract.device_status import LinkState
from robotd.contract.events import Event, Status
from robotd.core.broadcast import Subscription
from robotd.sim.emulators.catalogue import DRIVES, Dialects
from robotd.sim.physics.body import Body
from tests.support.bench import bench

LOW_V = 20.0
"""No battery of the simulated robot is there ever."""


@pytest.mark.parametrize("drive", DRIVES)
async def test_a_battery_is_unknown_until_it_is_told_and_again_once_the_base_is_gone(
    tmp_path: Path, drive: str
) -> None:
    async with bench(tmp_path, Dialects(drive=drive), readings=8) as it:
        with it.daemon.control.events.subscribe(depth=10_000) as events:
            await until(events, lambda told: told.battery_v is not None)
            it.cables["drive"].unplug()
            await until(events, lambda told: told.devices[0].link is LinkState.ABSENT)
            assert it.daemon.robot.drive.readouts.latest is None
            it.cables["drive"].plug()
            back = await until(events, lambda told: told.devices[0].link is LinkState.READY)
            assert back.battery_v is None
            await until(events, lambda told: told.battery_v is not None)


@pytest.mark.parametrize("drive", DRIVES)
async def test_a_base_that_has_not_measured_its_battery_says_nothing_of_it(
    tmp_path: Path, drive: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Body, "battery_mv", 0)
    async with bench(tmp_path, Dialects(drive=drive), readings=8) as it:
        await asyncio.sleep(8.0)
        readout = it.daemon.robot.drive.readouts.latest
        assert readout is not None
        assert (readout.battery_v, it.daemon.control.status.battery_v) == (None, None)


async def until(events: Subscription[Event], happens: Callable[[Status], bool]) -> Status:
    """Return the first status of which it is true; none until then tells a battery that nobody measured."""
    async with asyncio.timeout(60.0):
        async for event in events:
            if isinstance(event, Status):
                assert event.battery_v is None or event.battery_v > LOW_V
                if happens(event):
                    return event
    raise AssertionError("a subscription never ends")
