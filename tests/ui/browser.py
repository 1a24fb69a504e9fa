"""Debian's Chromium, driven by Playwright."""

import contextlib
import os
import shutil
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest

from robotd.gateway.web.bundle import WORKSHOP, build, fetch, is_fresh
from tests.unit.gateway.rig import GatewayRig

CHROMIUM = shutil.which("chromium")
DESK, PHONE, NARROW = (1280, 800), (390, 844), (320, 640)
SIZES = {"desk": DESK, "phone": PHONE, "narrow": NARROW}


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
async def chromium() -> AsyncIterator[Any]:
    """A browser of its own."""
    from playwright.async_api import async_playwright

    require_browser()
    async with async_playwright() as playwright:
        browser = await playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        try:
            yield browser
        finally:
            await browser.close()


async def open_page(
    browser: Any, rig: GatewayRig, role: str = "operator", size: tuple[int, int] = DESK, **more: Any
) -> Any:
    """A page that signed in by its address; what it complains of fails the test that looks at ``complaints``."""
    context = await browser.new_context(viewport={"width": size[0], "height": size[1]}, reduced_motion="reduce", **more)
    page = await context.new_page()
    page.complaints = []
    page.on("pageerror", lambda error: page.complaints.append(str(error)))
    page.on(
        "console",
        lambda said: page.complaints.append(said.text) if said.type == "error" and "401" not in said.text else None,
    )
    await page.goto(f"{rig.address}#{rig.secrets[role]}")
    await page.locator(".standing .mode strong").wait_for()
    return page


async def hold(page: Any, name: str, ms: int) -> None:
    """Press a button with the pointer for so long."""
    box = await page.get_by_role("button", name=name).bounding_box()
    await page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    await page.mouse.down()
    await page.wait_for_timeout(ms)
    await page.mouse.up()


async def shot(page: Any, file: Path) -> None:
    """Take a picture of what is seen."""
    file.parent.mkdir(parents=True, exist_ok=True)
    await page.screenshot(path=str(file))
