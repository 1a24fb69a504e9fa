"""Who drives, and what becomes of a page that does."""

import asyncio
from typing import Any

import pytest

from robotd.contract.missions import MapStart
from tests.support.console_page import until
from tests.support.real_gateway import Relay
from tests.ui.browser import chromium, hold, open_page, wait_for
from tests.unit.gateway.rig import Opening, tell_odometry

pytestmark = [pytest.mark.real_clock, pytest.mark.shares_descriptors]


async def test_arming_is_held_disarming_is_pressed(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig)
        await hold(page, "Hold to arm", 300)
        await page.wait_for_timeout(1200)
        assert not rig.control.armed, "a short press arms nothing"
        await hold(page, "Hold to arm", 1400)
        await until(lambda: rig.control.armed)
        await page.get_by_role("button", name="Disarm", exact=True).click()
        await until(lambda: not rig.control.armed)
        button = page.get_by_role("button", name="Hold to arm")
        await button.focus()
        await page.keyboard.down("Enter")
        await page.wait_for_timeout(1400)
        await page.keyboard.up("Enter")
        await until(lambda: rig.control.armed)


async def started(page: Any, rig: Any) -> None:
    """Arm, and start a mission that waits."""
    await wait_for(page, ".mode", "disarmed")
    await page.wait_for_timeout(500)
    await hold(page, "Hold to arm", 1400)
    await until(lambda: rig.control.armed)
    rig.control.release.clear()
    answer = await page.evaluate("robotd.link.ask('mission', {cmd: 'localize', args: {}, attended: true})")
    assert answer["mission_id"] == rig.control.mission_id
    await wait_for(page, ".panel", "You drive.")


async def test_a_page_that_hangs_and_one_that_closes_stop_the_robot(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig)
        await started(page, rig)
        await page.wait_for_timeout(3000)
        assert rig.control.is_busy, "a page that lives keeps its mission"
        rig.control.halted.clear()
        hanging = asyncio.create_task(page.evaluate("for (const end = Date.now() + 6000; Date.now() < end;);"))
        await until(rig.control.halted.is_set)
        assert "the page of some operator, who drove, has not answered for" in rig.control.calls[-1]
        await hanging
        await started(page, rig)
        rig.control.halted.clear()
        await page.close()
        await until(rig.control.halted.is_set)
        assert rig.control.calls[-1] == "stop: some operator, who drove, has left the console"


async def test_take_over_is_asked_for_and_given(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        driving, watching = await open_page(browser, rig), await open_page(browser, rig, "admin")
        await started(driving, rig)
        await wait_for(watching, ".panel", "some operator drives. You watch, and may stop.")
        await watching.get_by_role("button", name="Take over").click()
        await wait_for(driving, ".panel", "some admin wants to take over")
        await driving.get_by_role("button", name="Give").click()
        await wait_for(watching, ".panel", "You drive.")
        await driving.close()
        await watching.wait_for_timeout(500)
        assert rig.control.is_busy
        rig.control.release.set()


async def test_a_page_that_is_offline_stops_the_robot_and_says_that_nothing_is_heard(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        relay = Relay(rig.address.port or 0)
        async with relay.serving() as address:
            page = await open_page(browser, rig, address=address)
            await started(page, rig)
            rig.control.halted.clear()
            relay.cut()
            await until(rig.control.halted.is_set)
            assert "the page of some operator, who drove, has not answered for" in rig.control.calls[-1]
            await wait_for(page, ".banner.warning", "nothing heard for")
            await page.close()


async def test_a_page_that_is_hidden_warns_and_drives_on_as_long_as_it_answers(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig)
        await started(page, rig)
        hidden = "Object.defineProperty(document, 'hidden', {configurable: true, get: () => %s});"
        await page.evaluate((hidden % "true") + "document.dispatchEvent(new Event('visibilitychange'))")
        await wait_for(page, ".banner.warning", "You drive, and this page was hidden")
        await page.evaluate((hidden % "false") + "document.dispatchEvent(new Event('visibilitychange'))")
        await wait_for(page, ".banner", "A hidden page may fall silent, which stops the robot.")
        assert rig.control.is_busy, "it answers all the same; one that does not is one that hangs"
        rig.control.release.set()


_NAME_OF_WHAT_HAS_THE_FOCUS = """(() => {
  const one = document.activeElement;
  return one.matches('body, main') ? '' : `${one.textContent} ${one.ariaLabel} ${one.labels?.[0]?.textContent}`;
})()"""


async def test_by_keyboard_alone(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig)
        await wait_for(page, ".mode", "disarmed")

        async def tab_to(name: str) -> None:
            for _ in range(60):
                await page.keyboard.press("Tab")
                if name in await page.evaluate(_NAME_OF_WHAT_HAS_THE_FOCUS):
                    assert await page.evaluate("document.activeElement.matches(':focus-visible')"), "it is seen"
                    return
            raise AssertionError(f"{name} is not reached")

        await tab_to("Skip to the page")
        await page.keyboard.press("Enter")
        await tab_to("Map of the robot")
        before = await page.evaluate("robotd.canvas.view")
        for key in ("ArrowRight", "ArrowUp", "+"):
            await page.keyboard.press(key)
        after = await page.evaluate("robotd.canvas.view")
        assert after["x"] > before["x"]
        assert after["y"] > before["y"]
        assert after["scale"] > before["scale"]
        await tab_to("Hold to arm")
        await page.keyboard.down("Enter")
        await until(lambda: rig.control.armed)
        await page.keyboard.up("Enter")
        driving = asyncio.create_task(tell_odometry(rig.control))
        await wait_for(page, ".mode", "armed, idle")
        await tab_to("Make a map")
        await page.keyboard.press("Enter")
        await tab_to("Name")
        await page.keyboard.type("lab")
        await tab_to("Start")
        await page.keyboard.press("Enter")
        await until(lambda: rig.control.asked)
        assert isinstance(rig.control.asked[0], MapStart)
        assert rig.control.asked[0].name == "lab"
        driving.cancel()
        await page.keyboard.press("Escape")
        await until(lambda: not rig.control.armed)
        await page.keyboard.press("Shift+Tab")
        for name in ("Maps", "Recordings", "Health", "Log", "Settings"):
            await page.evaluate("document.querySelector('.skip').focus()")
            await tab_to(name)
            await page.keyboard.press("Enter")
            await page.locator(f".page-{name.lower()}").wait_for()
        assert page.complaints == []
