"""Pictures of the console on a simulated robot: ``python -m tests.ui.pictures`` draws those of ``docs/console.md``.

All pages, in three sizes and three themes, go to ``build/pictures``; a few of them into the documentation.
"""

import asyncio
import contextlib
import re
import shutil
import signal
import sys
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

from tests.ui.browser import PAGES, SIZES, THEMES, chromium, hold, shot, show

ROOT = Path(__file__).parents[2]
ALL = ROOT / "build" / "pictures"
SHOWN = ROOT / "docs" / "pictures" / "console"
IN_THE_DOCUMENTATION = (
    "drive-desk-dark",
    "drive-desk-light",
    "drive-phone-dark",
    "way-desk-dark",
    "maps-desk-dark",
    "health-desk-dark",
)
STOPS_M = ((1.8, 0.0), (3.8, 1.0), (3.7, 3.1), (2.3, 4.2))
_MINUTES = 10 * 60.0


@contextlib.asynccontextmanager
async def console(directory: Path) -> AsyncIterator[str]:
    """Start what ``make console`` starts, and yield the address that it prints."""
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "robotd.cli.main", "demo", "console", "--port", "8493", "--out", str(directory)),
        stdout=asyncio.subprocess.PIPE,
    )
    assert process.stdout is not None
    try:
        async with asyncio.timeout(_MINUTES):
            while (address := re.search(rb"http://\S+#\S+", line := await process.stdout.readline())) is None:
                assert line, "it has ended"
        yield address[0].decode()
    finally:
        with contextlib.suppress(ProcessLookupError):
            process.send_signal(signal.SIGINT)
        await process.wait()


async def main() -> None:
    """Make a map, be found on it, and take all pictures."""
    async with console(ROOT / "build" / "console-demo") as address, chromium() as browser:
        context = await browser.new_context(viewport=_size("desk"), reduced_motion="reduce")
        page = await context.new_page()
        await page.goto(address)
        await page.locator(".mode.disarmed").wait_for(timeout=60_000)
        await page.evaluate("robotd.command('record_start')")
        await _map_the_room(page)
        await page.get_by_role("button", name="Where am I").click()
        await page.keyboard.press("1")
        await page.locator(".where.localized").wait_for(timeout=120_000)
        await _idle(page)
        await shot(page, ALL / "drive-desk-dark.png")
        await _show_a_way(page)
        await page.evaluate("robotd.command('map_save')")
        await page.evaluate("robotd.command('record_stop')")
        for theme in THEMES:
            for size in SIZES:
                await page.set_viewport_size(_size(size))
                await page.evaluate(f"localStorage.setItem('robotd.theme', '{theme}'); location.reload()")
                await page.locator(".mode.idle").wait_for(timeout=60_000)
                await _every_page(page, f"{size}-{theme}")
    SHOWN.mkdir(parents=True, exist_ok=True)
    for name in IN_THE_DOCUMENTATION:
        shutil.copy(ALL / f"{name}.png", SHOWN / f"{name}.png")


def _size(name: str) -> dict[str, int]:
    return dict(zip(("width", "height"), SIZES[name], strict=True))


async def _map_the_room(page: Any) -> None:
    await hold(page, "Hold to arm", 1400)
    await _idle(page)
    await page.get_by_role("button", name="Make a map").click()
    await page.get_by_label("Name").fill("laboratory")
    canvas = page.locator(".view")
    box = await canvas.bounding_box()
    for x, y in STOPS_M:  # an empty map shows its origin in the middle, a metre in 60 pixels
        await canvas.click(position={"x": box["width"] / 2 + 60 * x, "y": box["height"] / 2 - 60 * y})
    await page.get_by_role("button", name="Start", exact=True).click()
    await page.locator(".mode.mapping").wait_for(timeout=60_000)
    await _idle(page)


async def _show_a_way(page: Any) -> None:
    await page.get_by_role("button", name="Go here").click()
    canvas = page.locator(".view")
    await page.keyboard.press("1")
    await page.keyboard.press("6")
    place = await page.evaluate("robotd.canvas.pixel({x: 3.5, y: 0.5})")
    await canvas.click(position={"x": place["px"], "y": place["py"]})
    await page.get_by_role("button", name="Go", exact=True).wait_for(timeout=30_000)
    await page.wait_for_timeout(1000)
    await shot(page, ALL / "way-desk-dark.png")
    await page.get_by_role("button", name="Cancel").click()
    await page.keyboard.press("6")


async def _idle(page: Any) -> None:
    await page.locator(".mode.idle").wait_for(timeout=_MINUTES * 1000)
    await page.wait_for_timeout(1000)


async def _every_page(page: Any, ending: str) -> None:
    for name in PAGES:
        await show(page, name)
        await page.wait_for_timeout(1200)
        if not (ALL / f"{name}-{ending}.png").exists() or name != "drive" or ending != "desk-dark":
            await shot(page, ALL / f"{name}-{ending}.png")


if __name__ == "__main__":
    shutil.rmtree(ALL, ignore_errors=True)
    asyncio.run(main())
