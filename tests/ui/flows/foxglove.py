"""What Foxglove's app is told, heard by Foxglove's own client of its protocol (``@foxglove/ws-protocol``)."""

import asyncio
import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from robotd.contract.estimate import PoseState
from robotd.core.clock import now_ns
from robotd.core.pose import Odometry, Pose2, Twist2
from robotd.gateway.web.bundle import fetch
from tests.ui.browser import chromium, open_page, show
from tests.ui.run import bundled
from tests.unit.gateway.rig import Opening
from tests.unit.server.conftest import an_estimate, whole_map

pytestmark = [pytest.mark.real_clock, pytest.mark.shares_descriptors]
CLIENT = Path(__file__).parents[2] / "web" / "foxglove_client.mjs"


async def _heard(address: str, folder: Path) -> dict[str, Any]:
    program = bundled(CLIENT, folder)
    node = fetch(with_tools=True)
    process = await asyncio.create_subprocess_exec(*node, str(program), address, "2.5", stdout=asyncio.subprocess.PIPE)
    said, _ = await process.communicate()
    assert process.returncode == 0
    told: dict[str, Any] = json.loads(said)
    return told


async def _tell(control: Any) -> None:
    """Tell a robot on its way."""
    for number in range(1_000_000):
        control.events.publish(Odometry(now_ns(), Pose2(0.01 * number, 0.0, 0.0), Twist2(0.1, 0.0)))
        control.events.publish(an_estimate(PoseState.LOCALIZED, now_ns()))
        await asyncio.sleep(0.2)


async def test_foxgloves_own_client_understands_what_it_is_told(opening: Opening, tmp_path: Path) -> None:
    async with opening() as rig, chromium() as browser:
        rig.control.map_in_use = whole_map(generation=0, map_id="d1")
        rig.control.events.publish(rig.control.map_in_use)
        page = await open_page(browser, rig, "viewer")
        await show(page, "settings")
        await page.get_by_role("button", name="Make an address").click()
        field = page.get_by_label("Open connection, Foxglove WebSocket, within two minutes")
        await field.wait_for()
        driving = asyncio.create_task(_tell(rig.control))
        told = await _heard(await field.input_value(), tmp_path)
        driving.cancel()
    assert (told["protocol"], told["problems"]) == ("foxglove.websocket.v1", [])
    assert (told["server"]["name"], told["server"]["capabilities"]) == ("dusty", [])
    schemas = {channel["schemaName"] for channel in told["channels"].values()}
    assert {"foxglove.Grid", "foxglove.FrameTransforms", "foxglove.PosesInFrame"} <= schemas
    assert set(told["messages"]) == set(told["channels"]), "of each channel the latest, at once"
    for topic, channel in told["channels"].items():
        assert (channel["encoding"], channel["schemaEncoding"]) == ("json", "jsonschema")
        for message in told["messages"][topic]:
            jsonschema.validate(message["content"], json.loads(channel["schema"]))
            assert int(message["timestamp"]) > 1_700_000_000 * 10**9, "by the calendar"
