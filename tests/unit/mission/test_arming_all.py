"""Arming: all devices or none, and what happens meanwhile wins."""

import asyncio
from collections.abc import Callable

import pytest

from robotd.contract.modes import Mode
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import DeviceError, LinkTimeout, RobotdError
from robotd.mission.safety.mode_table import Occasion
from tests.unit.mission.scripted_rig import (
    GONE,
    Rig,
    rig,
    turns,
)


async def test_arming_arms_all() -> None:
    async with rig() as r:
        assert r.mode is Mode.IDLE
        assert all(device.status.armed for device in r.devices)


async def test_a_device_that_refuses_leaves_all_disarmed_and_is_named() -> None:
    async with rig(armed=False) as r:

        async def refuse() -> None:
            raise DeviceError("rangefinder", "wrong_state", "Arm")

        r.rangefinder.before_arming = refuse
        with pytest.raises(DeviceError, match="rangefinder"):
            await r.supervisor.arming.arm()
        assert r.mode is Mode.DISARMED
        assert r.reason == "arming failed: rangefinder: wrong_state: Arm"
        assert not any(device.status.armed for device in r.devices)


async def test_a_device_that_does_not_answer_ends_arming_in_time() -> None:
    async with rig(armed=False) as r:
        r.pantilt.before_arming = asyncio.Event().wait  # type: ignore[assignment]  # never returns
        began_ns = now_ns()
        with pytest.raises(LinkTimeout, match="longer than 5 s"):
            await r.supervisor.arming.arm()
        assert now_ns() - began_ns == pytest.approx(5 * NS_PER_S, rel=0.01)
        assert not r.drive.status.armed


@pytest.mark.parametrize(
    ("happens", "mode", "reason"),
    [
        (lambda r: r.supervisor.halt(Occasion.STOP, "enough"), Mode.DISARMED, "enough"),
        (lambda r: r.drive.change(armed=False, faults=("bumper",)), Mode.FAULT, "drive: bumper"),
        (lambda r: r.drive.change(**GONE), Mode.DISARMED, "a device was lost"),
        (lambda r: r.rangefinder.change(**GONE), Mode.DISARMED, "rangefinder is absent"),
    ],
)
async def test_what_happens_while_arming_wins(happens: Callable[[Rig], None], mode: Mode, reason: str) -> None:
    async with rig(armed=False) as r:

        async def hesitate() -> None:
            await asyncio.sleep(0.1)
            happens(r)
            await asyncio.sleep(0.1)

        r.pantilt.before_arming = hesitate
        with pytest.raises(RobotdError):
            await r.supervisor.arming.arm()
        await turns()
        assert r.mode is mode
        assert reason in r.reason
        assert not any(device.status.armed for device in r.devices)


async def test_an_arm_that_is_given_up_by_its_client_leaves_all_disarmed() -> None:
    async with rig(armed=False) as r:
        r.pantilt.before_arming = asyncio.Event().wait  # type: ignore[assignment]  # never returns
        arming = asyncio.create_task(r.supervisor.arming.arm())
        await turns()
        assert r.drive.status.armed
        arming.cancel()
        with pytest.raises(asyncio.CancelledError):
            await arming
        assert not any(device.status.armed for device in r.devices)
        assert r.reason == "arming failed: given up"


async def test_when_one_of_two_arms_fails_so_does_the_other() -> None:
    async with rig(armed=False) as r:
        turn = iter((0.1, 0.2))

        async def hesitate() -> None:
            await asyncio.sleep(next(turn))
            if now_ns() < 0.15 * NS_PER_S:
                raise DeviceError("pantilt", "wrong_state", "Arm")

        r.pantilt.before_arming = hesitate
        outcomes = await asyncio.gather(r.supervisor.arming.arm(), r.supervisor.arming.arm(), return_exceptions=True)
        assert all(isinstance(outcome, RobotdError) for outcome in outcomes)
        assert r.mode is Mode.DISARMED
