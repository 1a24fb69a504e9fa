"""Maps and recordings, in and out."""

import asyncio
import io
import math
import shutil
import zipfile
from pathlib import Path

import pytest

from robotd.contract.requests import MapLoad
from robotd.gateway import made_files
from tests.support.console_page import until
from tests.support.recorded_session import record_session
from tests.ui.browser import chromium, open_page, pixels, show, wait_for
from tests.unit.gateway.rig import Opening
from tests.unit.gateway.test_maps import PGM, YAML
from tests.unit.server.conftest import stored_entry, stored_map

pytestmark = [pytest.mark.real_clock, pytest.mark.shares_descriptors]


async def test_maps_come_in_are_renamed_and_go_out(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig, accept_downloads=True)
        await page.evaluate("location.hash = '#/maps'")
        files = [
            {"name": name, "mimeType": "application/octet-stream", "buffer": data}
            for name, data in (("lab.yaml", YAML), ("lab.pgm", PGM))
        ]
        await page.locator(".bring input[type=file]").set_input_files(files)
        await wait_for(page, ".bring", " 3 cells of 5 cm")
        await wait_for(page, ".bring .why", "50% of it are walls")
        assert rig.control.calls == [], "it was looked at, and that is all"
        await page.get_by_role("button", name="Store", exact=True).click()
        await wait_for(page, ".notice", "lab is stored as version 1")
        assert rig.control.calls == ["import lab of lab.yaml, lab.pgm 3 x 4"]
        async with page.expect_download() as coming:
            await page.get_by_role("link", name="Export").click()
        assert (await coming.value).suggested_filename == "office-3.zip"
        await page.locator(".bring input[type=file]").set_input_files(files[1:])
        await page.get_by_label("Metres per pixel").fill("nonsense")
        await page.get_by_label("Metres per pixel").press("Tab")
        await wait_for(page, ".notice", "Refused: ")
        assert [text for text in page.complaints if "400" not in text] == []


async def test_two_versions_are_compared_and_one_is_loaded_where_the_robot_is(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        rig.control.stored += [stored_entry("office", 2, "d1", 5)]
        page = await open_page(browser, rig, "admin")
        await show(page, "maps")
        await page.get_by_role("button", name="an older version").click()
        compare = page.get_by_role("button", name="Compare")
        await compare.nth(0).click()
        await wait_for(page, ".bench", "Compare office 3 with")
        await compare.nth(1).click()
        await wait_for(page, ".legend", "wall in office 3 alone")
        values = stored_map("office", 3).values
        walls_m2 = (values > 128).sum() * 0.05**2
        await wait_for(page, ".legend", f"wall in office 3 alone: {walls_m2:.2f} m²")
        await wait_for(page, ".legend", "wall in office 2 alone: 0.00 m²")
        assert await pixels(page, ".bench .picture", "#ff9d5c") > 1000
        await page.get_by_role("button", name="Close", exact=True).click()
        await page.get_by_role("button", name="Load, robot is at…").nth(0).click()
        picture = page.locator("form .picture")
        box = await picture.bounding_box()  # of 60 x 40 cells of 5 cm, from (-1, -2)
        await page.mouse.move(box["x"] + box["width"] / 3, box["y"] + box["height"] / 2)
        await page.mouse.down()
        await page.mouse.move(box["x"] + box["width"] / 3, box["y"] + box["height"] / 4, steps=3)
        await page.mouse.up()
        await page.locator("form.bench").get_by_role("button", name="Load").click()
        await until(lambda: any(call.startswith("load office 3 Pose2") for call in rig.control.calls))
        asked = next(one for one in rig.control.performed if isinstance(one, MapLoad)).robot_in_map
        assert asked is not None
        assert (abs(asked.x_m) < 0.03, abs(asked.y_m + 1.0) < 0.03) == (True, True)
        assert abs(asked.heading_rad - math.pi / 2) < 0.02
        await wait_for(page, ".notice", "The robot goes by the place that you gave")
        await page.get_by_role("button", name="Delete").first.click()
        # The form has a Delete of its own, in place of the one that was pressed.
        await page.get_by_label("Type the name to delete it for good: office").wait_for()
        remove = page.locator(".changes").get_by_role("button", name="Delete")
        assert await remove.get_attribute("aria-disabled") == "true", "the name has to be typed"
        await page.get_by_label("Type the name to delete it for good: office").fill("office")
        await remove.click()
        await until(lambda: "map_delete office None" in rig.control.calls)
        assert page.complaints == []


async def test_of_a_recording_a_report_and_other_programs_files_are_made(
    opening: Opening, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(made_files, "_NICE", 0)  # beside busy programs it would never be its turn
    async with opening() as rig, chromium() as browser:
        made = await asyncio.to_thread(record_session, tmp_path / "robot")
        shutil.copy(made, tmp_path / "recordings" / "monday.mcap")
        (tmp_path / "recordings" / "broken.mcap").write_bytes(b"nothing that anybody recorded")
        page = await open_page(browser, rig, "admin", accept_downloads=True)
        await show(page, "recordings")
        card, broken = page.get_by_label("monday.mcap"), page.get_by_label("broken.mcap")
        await card.wait_for()
        names = {"Report": "monday.html", "For Foxglove": "monday.foxglove.mcap", "ROS 2 bag": "monday.bag.zip"}
        found: dict[str, bytes] = {}
        for button, name in names.items():
            async with page.expect_download(timeout=120_000) as coming:
                await card.get_by_role("button", name=button).click()
            download = await coming.value
            assert download.suggested_filename == name
            found[button] = await asyncio.to_thread(Path(await download.path()).read_bytes)
        assert b"<title>Mission report: monday.mcap" in found["Report"]
        assert b"<script" not in found["Report"]
        assert found["For Foxglove"].startswith(b"\x89MCAP")
        assert b"foxglove.Grid" in found["For Foxglove"]
        packed = zipfile.ZipFile(io.BytesIO(found["ROS 2 bag"]))
        assert "metadata.yaml" in packed.namelist()
        await broken.get_by_role("button", name="Report").click()
        await wait_for(page, ".notice", "Refused: ")
        await broken.get_by_role("button", name="Delete").click()
        await page.get_by_label("Type the name to delete it for good: broken.mcap").fill("broken.mcap")
        await page.locator(".changes").get_by_role("button", name="Delete").click()
        await until(lambda: "record_delete broken.mcap" in rig.control.calls)
        assert [text for text in page.complaints if "409" not in text] == []
