"""STOP: by whatever, wherever, over whatever."""

import asyncio
from typing import Any

import pytest

from robotd.core.errors import ServerError
from tests.support.console_page import until
from tests.ui.browser import DESK, PAGES, PHONE, chromium, hold, open_page, show, text_of, wait_for
from tests.unit.gateway.rig import Opening

pytestmark = [pytest.mark.real_clock, pytest.mark.shares_descriptors]


async def test_stop_by_pointer_keys_and_touch_on_every_page(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig, "viewer")
        stop = page.locator(".stop")

        async def stops(act: Any) -> None:
            rig.control.calls.clear()
            await act
            await until(lambda: rig.control.calls)
            await wait_for(page, ".stop", "STOPPED in")
            assert set(rig.control.calls) == {"stop: STOP by some viewer"}

        for name in PAGES:
            await show(page, name)
            box = await stop.bounding_box()
            await page.mouse.move(box["x"] + 20, box["y"] + 20)
            await stops(page.mouse.down())  # it acts when it is pressed, not when it is let go
            await page.mouse.up()
        await stops(page.keyboard.press("Escape"))
        await stops(page.keyboard.press(" "))
        await stop.focus()
        await stops(page.keyboard.press("Enter"))
        await page.evaluate("location.hash = '#/log'")
        search = page.get_by_label("Search")
        await search.fill("two words")
        rig.control.calls.clear()
        await search.press(" ")
        assert rig.control.calls == [], "a space in a field is a space"
        await stops(search.press("Escape"))
        touching = await open_page(browser, rig, "viewer", PHONE, has_touch=True)
        rig.control.calls.clear()
        await touching.locator(".stop").tap()
        await until(lambda: rig.control.calls)


async def test_a_stop_that_is_not_confirmed_says_so_over_the_whole_width(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig)

        async def nobody(reason: str) -> float:
            await asyncio.sleep(0.4)
            raise ServerError("not_confirmed", "nobody answered")

        rig.house.services.stop_line.stop = nobody  # type: ignore[method-assign]  # the daemon hangs
        await page.keyboard.press("Escape")
        assert await text_of(page, ".stop") == "STOPPING"
        await wait_for(page, ".banner.danger", "STOP NOT CONFIRMED: use the emergency stop on the robot")
        assert (await page.locator(".banner.danger").bounding_box())["width"] == DESK[0]
        await page.wait_for_timeout(4000)  # it is tried for three seconds


async def test_without_a_script_there_is_one_button(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig, "viewer")
        state = await page.context.storage_state()
        bare = await (await browser.new_context(java_script_enabled=False, storage_state=state)).new_page()
        await bare.goto(f"{rig.address}stop")
        await bare.get_by_role("button", name="STOP").click()
        await wait_for(bare, "[role=status]", "STOPPED in")
        assert rig.control.calls == ["stop: STOP by some viewer"]


async def test_stop_is_over_every_dialog(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig, "viewer")
        for _ in range(2):  # one dialog over the other
            await page.evaluate(
                "const one = document.body.appendChild(document.createElement('dialog'));"
                "one.textContent = 'Sure?'; one.style.width = one.style.height = '100vw'; one.showModal()"
            )
        box = await page.locator(".stop").bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        on_top = await page.evaluate("getComputedStyle(document.querySelector('.stop-place')).display")
        assert on_top == "block"
        shown = await page.screenshot(clip={"x": x - 60, "y": box["y"] + 8, "width": 4, "height": 4})
        await page.mouse.move(x, y)
        await page.mouse.down()
        await until(lambda: rig.control.calls)
        assert set(rig.control.calls) == {"stop: STOP by some viewer"}
        assert shown == await page.screenshot(clip={"x": x - 60, "y": box["y"] + 8, "width": 4, "height": 4}), (
            "it is seen"
        )
        await page.mouse.up()
        rig.control.calls.clear()
        await page.keyboard.press("Escape")  # which would close the dialog, and does not
        await until(lambda: rig.control.calls)
        assert await page.locator("dialog[open]").count() == 2


async def test_stop_while_a_command_hangs(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig)
        rig.control.arming.clear()
        await hold(page, "Hold to arm", 1400)
        await until(lambda: rig.control.calls == ["arm"])
        await page.keyboard.press("Escape")
        await wait_for(page, ".stop", "STOPPED in")
        assert "stop: STOP by some operator" in rig.control.calls
        rig.control.arming.set()
