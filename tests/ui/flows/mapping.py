"""Maps in the making, places on them, and what is believed: as pixels, for what is drawn is what people go by."""

import asyncio
import zlib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from robotd.contract.estimate import PoseState
from robotd.contract.events import MapChanged, RankMap
from robotd.contract.explored import CandidateStop, StopChosen
from robotd.contract.missions import DriveTo, Explore, MapStart
from robotd.core.clock import now_ns
from robotd.core.grid_spec import GridSpec
from tests.support.console_page import until
from tests.ui.browser import chromium, hold, open_page, pixels, show, until_so, wait_for
from tests.unit.gateway.rig import Opening, tell_odometry
from tests.unit.server.conftest import an_estimate, whole_map

pytestmark = [pytest.mark.real_clock, pytest.mark.shares_descriptors]


async def test_going_localizing_and_exploring_are_prepared_and_started_by_a_second_press(opening: Opening) -> None:
    async with opening(patience_s=5.0) as rig, chromium() as browser:
        control = rig.control
        control.map_in_use = whole_map(generation=0, map_id="office-3")
        control.events.publish(control.map_in_use)
        control.events.publish(an_estimate(PoseState.LOCALIZED))
        page = await open_page(browser, rig)
        await wait_for(page, ".where", "localized")
        driving = asyncio.create_task(tell_odometry(control))
        await hold(page, "Hold to arm", 1400)
        await until(lambda: control.armed)
        await wait_for(page, ".mode", "armed, idle")
        canvas = page.locator(".view")

        async def begun(start: str) -> Any:
            await page.get_by_role("button", name=start, exact=True).click()
            await until(lambda: control.asked and not control.is_busy)
            await page.locator(".acts-list").wait_for()  # nothing is being prepared any more
            await wait_for(page, ".mode", "armed, idle")
            return control.asked.pop()

        await page.keyboard.press("g")
        await page.keyboard.press("Enter")  # what is in the middle
        await wait_for(page, ".acts", "3.20 m to (")
        assert control.asked == [], "a way is shown, and nothing drives"
        assert isinstance(await begun("Go"), DriveTo)
        await page.get_by_role("button", name="Localize here").click()
        for name in ("log", "drive"):  # another page, and back: the canvas is another one then
            await show(page, name)
        box = await canvas.bounding_box()
        await page.mouse.move(box["x"] + 500, box["y"] + 400)
        await page.mouse.down()
        await page.mouse.move(box["x"] + 560, box["y"] + 400, steps=4)
        await page.mouse.up()
        await wait_for(page, ".acts", " round (")
        within = (await begun("Start")).within
        assert within is not None
        assert within.radius_m > 0.2
        await page.get_by_role("button", name="Explore").click()
        await page.get_by_label("Name").fill("lab")
        assert (await begun("Start")).name == "lab"
        await page.get_by_role("button", name="Explore").click()
        await page.get_by_label("Name").fill("office")
        assert (await begun("Resume")).resume
        driving.cancel()
        assert page.complaints == []


UNKNOWN, REGION = "#12181f", "#ffb454"
SPEC = GridSpec(0.05, -2.0, -2.0, (80, 80))


def _change(generation: int, cells: NDArray[np.intp]) -> MapChanged:
    return MapChanged(now_ns(), "lab-1", generation, SPEC, False, cells, np.full(len(cells), 20, np.uint8))


async def test_a_map_is_made_and_is_seen_to_grow(opening: Opening) -> None:
    async with opening(patience_s=5.0) as rig, chromium() as browser:
        control = rig.control
        page = await open_page(browser, rig)
        await wait_for(page, ".where", "no map")
        await hold(page, "Hold to arm", 1400)
        driving = asyncio.create_task(tell_odometry(control))
        await wait_for(page, ".mode", "armed, idle")
        await page.get_by_role("button", name="Make a map").click()
        await page.get_by_label("Name").fill("lab")
        box = await page.locator(".view").bounding_box()
        for x, y in ((1.0, 0.0), (1.0, 1.5)):  # an empty map shows its origin in the middle, a metre in 60 pixels
            await page.mouse.click(box["x"] + box["width"] / 2 + 60 * x, box["y"] + box["height"] / 2 - 60 * y)
        second, first = page.locator(".stops li").nth(1), page.locator(".stops li").nth(0)
        await second.drag_to(first)
        await page.get_by_label("Heading").fill("90")
        await page.get_by_label("Heading").press("Tab")
        control.release.clear()
        await page.get_by_role("button", name="Start", exact=True).click()
        await until(lambda: control.asked)
        asked = control.asked[0]
        assert isinstance(asked, MapStart)
        assert asked.name == "lab"
        assert np.allclose(asked.stops_m, [(1.0, 1.5), (1.0, 0.0)], atol=0.03), "the order is that of the list"
        assert abs(asked.start.heading_rad - np.pi / 2) < 1e-6
        nothing = MapChanged(now_ns(), "lab-1", 0, SPEC, True, np.empty(0, np.intp), np.full(SPEC.shape, 128, np.uint8))
        control.map_in_use = nothing
        control.events.publish(nothing)
        await page.locator(".no-map").wait_for(state="detached")
        known, area = [], await pixels(page, ".view", UNKNOWN)
        for stop in range(3):
            cells = np.flatnonzero(np.ones(SPEC.shape))[stop * 1600 : (stop + 1) * 1600]
            control.events.publish(_change(stop + 1, cells))
            await until_so(page, f"robotd.grid.generation === {stop + 1}")
            await page.wait_for_timeout(300)
            known.append(area - await pixels(page, ".view", UNKNOWN))
        assert known[0] > 5000
        assert known[1] > 1.5 * known[0]
        assert known[2] > 1.2 * known[1]
        control.release.set()
        driving.cancel()
        assert page.complaints == []


async def test_heat_and_regions_are_seen_when_their_layers_are_on(opening: Opening) -> None:
    async with opening(patience_s=5.0) as rig, chromium() as browser:
        control = rig.control
        control.map_in_use = whole_map(generation=0, map_id="d1", spec=SPEC)
        control.map_in_use.values[:] = 20
        control.events.publish(control.map_in_use)
        control.events.publish(an_estimate(PoseState.AMBIGUOUS))
        page = await open_page(browser, rig, "viewer")
        await until_so(page, "robotd.grid.placement !== null && robotd.state.pose !== null")

        async def seen(is_there: Callable[[int], bool]) -> int:
            for _ in range(50):
                if is_there(found := await pixels(page, ".view", REGION, near=40, left_px=240)):
                    return found
                await page.wait_for_timeout(100)
            raise AssertionError(f"{found} pixels")

        await until_so(page, "robotd.canvas.isDrawn && robotd.canvas.view.scale > 100")
        await seen(lambda found: found > 20)
        await page.keyboard.press("2")
        without = await seen(lambda found: found < 5)
        levels = np.zeros((80, 80), np.uint8)
        levels[20:60, 20:60] = 255
        await page.keyboard.press("1")
        await until(lambda: rig.house.services.fan.wants_rank)
        heat = RankMap(1, "d1", 0, 3, 300, 300, 1, 0.05, -2.0, -2.0, 80, 80, zlib.compress(levels.tobytes()))
        hot = asyncio.create_task(_again(lambda: control.events.publish(heat)))
        await seen(lambda found: found > without + 5000)
        hot.cancel()
        await page.keyboard.press("1")
        await seen(lambda found: found < without + 100)
        await until(lambda: not rig.house.services.fan.wants_rank)
        assert page.complaints == []


async def _again(act: Callable[[], None]) -> None:
    while True:
        act()
        await asyncio.sleep(0.2)


async def test_exploring_is_paused_and_goes_on(opening: Opening) -> None:
    async with opening(patience_s=5.0) as rig, chromium() as browser:
        control = rig.control
        control.map_in_use = whole_map(generation=0, map_id="office-3")
        control.events.publish(control.map_in_use)
        control.events.publish(an_estimate(PoseState.LOCALIZED))
        page = await open_page(browser, rig)
        driving = asyncio.create_task(tell_odometry(control))
        await wait_for(page, ".where", "localized")
        await hold(page, "Hold to arm", 1400)
        await wait_for(page, ".mode", "armed, idle")
        await page.get_by_role("button", name="Explore").click()
        await page.get_by_label("Name").fill("office")
        control.release.clear()
        await page.get_by_role("button", name="Resume").click()
        await wait_for(page, ".panel", "You drive.")
        chosen = StopChosen(
            now_ns(),
            "office-3",
            1,
            0.5,
            0.5,
            "a door is open there",
            (CandidateStop(0.5, 0.5, 1.0, 2.0, 1.0, 0.5, 1.0),),
        )
        control.events.publish(chosen)
        await wait_for(page, ".panel", "a door is open there")
        await page.get_by_role("button", name="Pause").click()
        await until(lambda: not control.armed)
        await wait_for(page, ".panel", "Last: explore, stopped.")
        resume = page.get_by_role("button", name="Resume")
        assert await resume.get_attribute("aria-disabled") == "true"
        await wait_for(page, "#resume-why", "Arm it first.")
        control.events.publish(an_estimate(PoseState.LOCALIZED))
        await hold(page, "Hold to arm", 1400)
        await wait_for(page, ".mode", "armed, idle")
        control.asked.clear()
        await resume.click()
        await until(lambda: control.asked)
        again = control.asked[0]
        assert isinstance(again, Explore)
        assert (again.name, again.resume) == ("office", True)
        control.release.set()
        await show(page, "log")
        await page.get_by_role("button", name="Missions").click()
        await wait_for(page, ".lines", "a door is open there")
        driving.cancel()
        assert page.complaints == []
