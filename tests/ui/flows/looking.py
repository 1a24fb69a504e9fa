"""What is shown, in every size and colour, and for everybody."""

import json
from pathlib import Path
from typing import Any

import pytest

from tests.ui.browser import DESK, NARROW, PAGES, PHONE, THEMES, axe_source, chromium, open_page, show
from tests.unit.gateway.rig import Opening

pytestmark = [pytest.mark.real_clock, pytest.mark.shares_descriptors]


@pytest.mark.parametrize("size", [PHONE, NARROW])
async def test_on_a_phone_stop_is_a_bar_and_nothing_is_cut_off(opening: Opening, size: tuple[int, int]) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig, "admin", size, has_touch=True)
        for name in PAGES:
            await show(page, name)
            await page.wait_for_timeout(300)
            box = await page.locator(".stop").bounding_box()
            assert box["height"] >= 64
            assert box["width"] >= size[0] - 24
            assert box["y"] + box["height"] <= size[1]
            wide = await page.evaluate("document.documentElement.scrollWidth")
            assert wide <= size[0], f"{name} is {wide} wide"


async def test_axe_finds_nothing_on_any_page_in_any_theme(opening: Opening) -> None:
    source = axe_source()
    found: dict[str, Any] = {}
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig, "admin")
        for theme in THEMES:
            await page.evaluate("location.hash = '#/settings'")
            names = {"dark": "Dark", "light": "Light", "contrast": "High contrast"}
            await page.get_by_role("button", name=names[theme]).click()
            for name in PAGES:
                await show(page, name)
                await page.wait_for_timeout(500)
                await page.evaluate(f"{source}; 0")
                told = await page.evaluate("axe.run(document, {resultTypes: ['violations']})")
                for violation in told["violations"]:
                    places = [node["target"] for node in violation["nodes"]][:3]
                    found[f"{theme} {name} {violation['id']}"] = places
        assert page.complaints == []
    assert found == {}, json.dumps(found, indent=1)


async def test_everything_is_ours_and_little(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        context = await browser.new_context()
        page = await context.new_page()
        asked: list[str] = []
        page.on("request", lambda request: asked.append(request.url))
        await page.goto(f"{rig.address}#{rig.secrets['viewer']}")
        await page.locator(".standing .mode strong").wait_for()
        assert [url for url in asked if not url.startswith(str(rig.address))] == []
        assert len(asked) <= 12
        sizes = [
            len(file.packed or file.data) for file in map(rig.house.files.find, _served(asked)) if file is not None
        ]
        assert sum(sizes) <= 80 * 1024


def _served(urls: list[str]) -> list[str]:
    return [url.partition("//")[2].partition("/")[2].partition("#")[0] or "index.html" for url in urls]


def test_pictures_for_the_page_are_there() -> None:
    pictures = Path(__file__).parents[3] / "docs" / "pictures" / "console"
    assert {"drive-desk-dark.png", "drive-phone-dark.png"} <= {file.name for file in pictures.glob("*.png")}


_SMALL = """[...document.querySelectorAll('a, button, input, select, summary, .view')].filter((one) => {
  const box = (one.closest('label') ?? one).getBoundingClientRect();
  const isSeen = one.checkVisibility({visibilityProperty: true}) && !one.matches('.skip');
  return isSeen && (box.width < 43.9 || box.height < 43.9);
}).map((one) => {
  const {width, height} = one.getBoundingClientRect();
  return `${one.tagName} ${one.className} ${one.textContent.slice(0, 30)} ${width} x ${height}`;
})"""


@pytest.mark.parametrize("size", [DESK, PHONE])
async def test_what_is_pressed_is_large_enough_for_a_finger(opening: Opening, size: tuple[int, int]) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig, "admin", size)
        for name in PAGES:
            await show(page, name)
            await page.wait_for_timeout(300)
            assert await page.evaluate(_SMALL) == [], name


async def test_at_200_percent_nothing_is_cut_off(opening: Opening) -> None:
    """A page of 1280 x 800 at 200 % is one of 640 x 400 whose pixels are twice as large."""
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig, "admin", (DESK[0] // 2, DESK[1] // 2), device_scale_factor=2)
        for name in PAGES:
            await show(page, name)
            await page.wait_for_timeout(300)
            assert await page.evaluate("document.documentElement.scrollWidth") <= DESK[0] // 2, name
            box = await page.locator(".stop").bounding_box()
            assert box["height"] >= 64
            assert box["y"] + box["height"] <= DESK[1] // 2


async def test_on_a_phone_nothing_to_press_is_near_stop(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig, "admin", PHONE, has_touch=True)
        for name in PAGES:
            await show(page, name)
            await page.evaluate("scrollTo(0, document.documentElement.scrollHeight)")
            box = await page.locator(".stop").bounding_box()
            near = await page.evaluate(
                "(top) => [...Array(39).keys()].map((n) => document.elementFromPoint(10 * n + 5, top - 23))"
                ".filter((one) => one?.closest('a, button, input, select, label, .view')).length",
                box["y"],
            )
            assert near == 0, name


async def test_each_theme_has_its_own_colours_and_is_kept(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig, "viewer")
        papers = set()
        for label, theme in (("Dark", "dark"), ("Light", "light"), ("High contrast", "contrast")):
            await show(page, "settings")
            await page.get_by_role("button", name=label).click()
            await page.reload()
            await page.locator(".standing .mode strong").wait_for()
            assert await page.evaluate("document.documentElement.dataset.theme") == theme
            papers.add(await page.evaluate("getComputedStyle(document.documentElement).backgroundColor"))
        assert len(papers) == 3
