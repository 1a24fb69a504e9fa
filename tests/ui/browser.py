"""Debian's Chromium, driven by Playwright."""

import asyncio
import contextlib
import io
import os
import shutil
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from robotd.gateway.web.bundle import WORKSHOP, build, fetch, is_fresh
from tests.unit.gateway.rig import GatewayRig

CHROMIUM = shutil.which("chromium")
DESK, PHONE, NARROW = (1280, 800), (390, 844), (320, 640)
SIZES = {"desk": DESK, "phone": PHONE, "narrow": NARROW}
PAGES = ("drive", "maps", "recordings", "health", "log", "settings")
THEMES = ("dark", "light", "contrast")


def require_browser() -> None:
    """Skip, saying so, where there is no browser; where everything has to be there, that is a failure."""
    if CHROMIUM is not None:
        if not is_fresh():
            build()
        return
    if "CI" in os.environ:
        pytest.fail("no chromium: apt-get install chromium")
    pytest.skip("no chromium: apt-get install chromium")


def axe_source() -> str:
    """Return the program that looks for what keeps people from using a page."""
    fetch(with_tools=True)
    return (WORKSHOP / "node_modules" / "axe-core" / "axe.min.js").read_text()


@contextlib.asynccontextmanager
async def chromium(*arguments: str) -> AsyncIterator[Any]:
    """A browser of its own."""
    from playwright.async_api import async_playwright

    require_browser()
    async with async_playwright() as playwright:
        browser = await playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", *arguments])
        try:
            yield browser
        finally:
            await browser.close()


async def open_page(
    browser: Any,
    rig: GatewayRig,
    role: str = "operator",
    size: tuple[int, int] = DESK,
    address: object = None,
    **more: Any,
) -> Any:
    """A page that signed in by its address; what it complains of fails the test that looks at ``complaints``."""
    context = await browser.new_context(viewport={"width": size[0], "height": size[1]}, reduced_motion="reduce", **more)
    page = await new_page(context)
    await page.goto(f"{address or rig.address}#{rig.secrets[role]}")
    await page.locator(".standing .mode strong").wait_for()
    return page


async def new_page(context: Any) -> Any:
    """A page that keeps what it complains of."""
    page = await context.new_page()
    page.complaints = []
    page.on("pageerror", lambda error: page.complaints.append(str(error)))
    page.on(
        "console",
        lambda said: page.complaints.append(said.text) if said.type == "error" and "401" not in said.text else None,
    )
    return page


async def hold(page: Any, name: str, ms: int) -> None:
    """Press a button with the pointer for so long."""
    box = await page.get_by_role("button", name=name).bounding_box()
    await page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    await page.mouse.down()
    await page.wait_for_timeout(ms)
    await page.mouse.up()


async def text_of(page: Any, selector: str) -> str:
    """Return what is written there."""
    found: str = await page.locator(selector).inner_text()
    return found


async def wait_for(page: Any, selector: str, text: str) -> None:
    """Wait until something says that."""
    await page.locator(selector).filter(has_text=text).first.wait_for(timeout=20_000)


async def until_so(page: Any, expression: str) -> None:
    """Wait until something is true on the page; Playwright's own way has to evaluate texts there, which nobody may."""
    async with asyncio.timeout(20.0):
        while not await page.evaluate(expression):
            await page.wait_for_timeout(50)


async def show(page: Any, name: str) -> None:
    """Go to a page of the console."""
    await page.evaluate(f"location.hash = '#/{name}'")
    await page.locator(f".page-{name}").wait_for()


async def shot(page: Any, file: Path) -> None:
    """Take a picture of what is seen."""
    file.parent.mkdir(parents=True, exist_ok=True)
    await page.screenshot(path=str(file))


async def pixels(page: Any, selector: str, colour: str, near: int = 6, left_px: int = 0) -> int:
    """Count the pixels of a part of the page that are of a colour, ``#rrggbb``, or nearly; from ``left_px`` on."""
    picture = Image.open(io.BytesIO(await page.locator(selector).screenshot())).convert("RGB")
    wanted = [int(colour[n : n + 2], 16) for n in (1, 3, 5)]
    apart = np.abs(np.asarray(picture)[:, left_px:].astype(np.int16) - wanted).max(axis=2)
    return int((apart <= near).sum())
