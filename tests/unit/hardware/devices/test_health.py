"""What a device says of itself is bounded and printable, and the log says whether it is there."""

import asyncio

import pytest

from robotd.contract.device_status import LinkState
from robotd.hardware.devices.health import Health


async def test_the_log_says_once_that_a_device_is_absent_and_why_and_when_it_is_ready(
    caplog: pytest.LogCaptureFixture,
) -> None:
    caplog.set_level("INFO")
    health = Health("drive", tuple)
    for _ in range(5):
        health.change(link=LinkState.ABSENT, detail="/dev/robotd/drive: no such device")
        health.change(link=LinkState.CONNECTING, detail="line open, waiting for the board")
        await asyncio.sleep(5)
    health.change(link=LinkState.READY, detail="")
    health.change(armed=True)
    health.change(link=LinkState.ABSENT, armed=False, detail="hung up")
    health.change(link=LinkState.ABSENT, detail="/dev/robotd/drive: no such device")
    assert caplog.messages == [
        "drive is absent: /dev/robotd/drive: no such device",
        "drive is ready",
        "drive is absent: hung up",
        "drive is absent: /dev/robotd/drive: no such device",
    ]


async def test_a_loose_plug_does_not_flood_the_log(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    health = Health("drive", tuple)
    for number in range(1000):
        health.change(link=LinkState.ABSENT, detail=f"lost {number}")
        health.change(link=LinkState.READY, detail="")
        await asyncio.sleep(0.01)
    assert len(caplog.messages) < 30


async def test_what_a_device_calls_itself_cannot_steer_a_terminal_or_fill_a_status() -> None:
    health = Health("drive", tuple)
    health.change(detail="\x1b[2Jhello\nINFO: forged" + "x" * 50_000)
    assert health.status.detail.startswith("\\x1b[2Jhello\\nINFO: forged")
    assert health.status.detail.isprintable()
    assert len(health.status.detail) <= 300
