"""``make console-bench``: what the console costs, and how soon people see something, beside what was wished for."""

import argparse
import asyncio
import os
import signal
import sys
from collections.abc import AsyncIterator
from dataclasses import dataclass
from typing import Any

import aiohttp
import numpy as np

from robotd.client import AsyncClient
from robotd.contract.missions import Scan
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.grid_spec import GridSpec
from tests.studies.console.measured import House, Meter, cpu_s, house, idle, with_crowd
from tests.support.console_page import until
from tests.support.real_rig import armed
from tests.ui.browser import chromium

SMALL_CELLS, LARGE_CELLS = 1024, 4096
_SCRAPES = 20
_MANY = 50
_DRAWN = """new Promise((done) => {
  const begun = performance.now();
  const look = () => robotd.grid.placement !== null && robotd.canvas?.isDrawn ? done(performance.now()) :
    performance.now() - begun > 60000 ? done(NaN) : setTimeout(look, 5);
  look();
})"""
_PAINTED = "performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? NaN"
_PAN = """(async () => {
  const view = document.querySelector('.view');
  robotd.canvas.look({ ...robotd.canvas.view, scale: robotd.canvas.view.scale * 3 });
  while (!robotd.canvas.isDrawn) await new Promise(requestAnimationFrame);
  robotd.canvas.times.length = 0;
  view.focus();
  const shown = [];
  for (let step = 0; step < 120; step += 1) {
    const key = step % 40 < 20 ? 'ArrowRight' : 'ArrowLeft';
    view.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true }));
    shown.push(await new Promise(requestAnimationFrame));
  }
  return { times: robotd.canvas.times, apart: shown.slice(1).map((at, index) => at - shown[index]) };
})()"""
_TO_DRAWN = """(async (event) => {
  const waits = [], to = robotd.link.to, frame = to.frame;
  to.frame = (heard) => {
    frame(heard);
    if (heard.event !== event) return;
    const came = performance.now();
    requestAnimationFrame(() => setTimeout(() => waits.push(performance.now() - came)));
  };
  await new Promise((done) => setTimeout(done, 6000));
  to.frame = frame;
  return waits;
})"""


@dataclass(frozen=True, slots=True)
class Figure:
    """A line of the table."""

    what: str
    wished: str
    found: str


async def figures(seconds: float) -> AsyncIterator[Figure]:
    """Measure one thing after the other."""
    async with house() as it, chromium() as browser:
        async for figure in _first_looks(it, browser):
            yield figure
        yield await _scraped(it)
        yield await _gateway_stands_still(it, seconds)
        async for figure in _while_mapping(it, browser, seconds):  # last: who is hostile has then guessed tokens
            yield figure


async def _first_looks(it: House, browser: Any) -> AsyncIterator[Figure]:
    for cells, wished in ((SMALL_CELLS, "0.4 / 0.8 s"), (LARGE_CELLS, "- / 1.5 s")):
        await _use_a_map_of(it.client, cells)
        page, asked = await _cold(browser, it)
        drawn_ms = await page.evaluate(_DRAWN)
        painted_ms = await page.evaluate(_PAINTED)
        what = f"first paint / map, cold, {cells} x {cells}"
        yield Figure(what, wished, f"{painted_ms / 1000:.2f} / {drawn_ms / 1000:.2f} s")
        if cells == SMALL_CELLS:
            sizes = sum([await _length(answer) for answer in asked])
            foreign = sum(not answer.url.startswith(str(it.gateway.address)) for answer in asked)
            found = f"{sizes / 1024:.0f} KB, {len(asked)} requests, {foreign} foreign"
            yield Figure("first load", "<= 80 KB gz, 12 requests, 0 foreign", found)
        else:
            panned = await page.evaluate(_PAN)
            found = f"{_p95(panned['times']):.1f} ms; a frame each {_p95(panned['apart']):.0f} ms"
            yield Figure(f"panning {cells} x {cells}: work of a frame, p95", "<= 8 ms a frame", found)
        await page.context.close()


async def _cold(browser: Any, it: House) -> tuple[Any, list[Any]]:
    """Open a page in a browser that knows nothing but its cookie."""
    context = await browser.new_context(viewport={"width": 1280, "height": 800})
    page = await context.new_page()
    await page.goto(f"{it.gateway.address}#{it.gateway.secret}")
    await page.locator(".standing .mode strong").wait_for(timeout=60_000)
    state = await context.storage_state()
    await context.close()
    page = await (await browser.new_context(viewport={"width": 1280, "height": 800}, storage_state=state)).new_page()
    asked: list[Any] = []
    page.on("response", lambda answer: asked.append(answer))  # noqa: PLW0108  # Playwright marks what it is handed
    await page.goto(str(it.gateway.address))
    return page, asked


async def _length(answer: Any) -> int:
    sizes = await answer.request.sizes()
    return int(sizes["responseBodySize"])


async def _use_a_map_of(client: AsyncClient, cells: int) -> None:
    """Load a building of rooms, so large."""
    grid = np.full((cells, cells), 128, np.uint8)
    rooms = grid[cells // 8 : -cells // 8, cells // 8 : -cells // 8]
    rooms[:] = 10
    rooms[::64, :], rooms[:, ::96] = 250, 250
    rooms[30::64, ::96], rooms[::64, 40::96] = 10, 10
    name = f"rooms-{cells}"
    await client.map_import(name, GridSpec(0.05, -cells / 40, -cells / 40, (cells, cells)), grid)
    await client.map_load(name)


async def _while_mapping(it: House, browser: Any, seconds: float) -> AsyncIterator[Figure]:
    await armed(it.client)
    page, _ = await _cold(browser, it)
    await page.evaluate(_DRAWN)
    scanning = asyncio.create_task(_scan_on(it.client))
    try:
        for event, name, wished in (("odometry", "odometry", "50 ms"), ("sweep_readings", "reading", "120 ms")):
            waits = await page.evaluate(f"{_TO_DRAWN}('{event}')")
            yield Figure(f"{name}: come to drawn, p95", f"{wished} from the robot", f"{_p95(waits):.0f} ms")
        await page.context.close()
        alone = await idle(it, seconds)
        seen, cost = await with_crowd(it, _MANY, seconds)
        yield Figure(
            f"{_MANY} browsers while it sweeps: gateway; daemon; each",
            "<= 5 % of a core, 70 MiB; +0.3 points; 15 kB/s",
            f"{cost.gateway_share:.1%}, {cost.gateway_mib:.0f} MiB;"
            f" {100 * (cost.daemon_share - alone.daemon_share):+.1f} points beside one that sweeps for nobody;"
            f" {seen.bytes_per_s / 1000:.1f} kB/s",
        )
        yield Figure("odometry: from the robot to a browser, p95", "50 ms, drawn", f"{seen.p95_ms:.0f} ms")
        mixed, cost = await with_crowd(it, _MANY, seconds, stalled=10, hostile=1)
        yield Figure(
            f"of {_MANY}, 10 stalled, 1 hostile",
            "others' p95 unchanged, RSS slope 0",
            f"p95 {mixed.p95_ms:.0f} ms ({seen.p95_ms:.0f} before), {cost.gateway_mib_more:+.1f} MiB,"
            f" {mixed.hung_up} of the others hung up on",
        )
    finally:
        scanning.cancel()
        await asyncio.gather(scanning, return_exceptions=True)


async def _scan_on(client: AsyncClient) -> None:
    while True:
        async for _ in client.run_mission(Scan()):
            pass


async def _scraped(it: House) -> Figure:
    headers = {"Authorization": f"Bearer {it.gateway.secret}"}
    before = cpu_s(it.gateway.process.pid)
    async with aiohttp.ClientSession(it.gateway.address, headers=headers) as session:
        for _ in range(_SCRAPES):
            async with session.get("metrics") as answer:
                await answer.read()
    each_ms = 1000.0 * (cpu_s(it.gateway.process.pid) - before) / _SCRAPES
    return Figure("a scrape of /metrics", "<= 10 ms of a processor", f"{each_ms:.1f} ms")


async def _gateway_stands_still(it: House, seconds: float) -> Figure:
    """Stop the gateway in a mission of its own, which the lease ends; it must cost the daemon no memory."""
    async with it.gateway.page() as page:
        await page.ask("command", cmd="arm")
        started = await page.ask("mission", cmd="scan", args={})
        assert started["type"] == "result", started
        meter = Meter(it)
        it.rig.expect_stops()
        it.gateway.process.send_signal(signal.SIGSTOP)
        stopped_ns = now_ns()
        took_s = (await it.rig.stopped_ns() - stopped_ns) / NS_PER_S
        await asyncio.sleep(seconds)
        cost = meter.read()
        it.gateway.process.send_signal(signal.SIGCONT)
        await until(lambda: page.last("question"))
    found = f"{took_s:.2f} s; {cost.daemon_mib_more:+.1f} MiB after {seconds:g} s"
    return Figure("gateway SIGSTOPped while it drives: stop; daemon's memory", "by lease (0.5 s); +0", found)


def _p95(values: list[float]) -> float:
    return float(np.percentile(values, 95)) if values else float("nan")


async def _print(seconds: float) -> None:
    print(
        f"{os.cpu_count()} processors; load of others: {os.getloadavg()[0]:.1f} over the last minute; all on loopback"
    )
    print("\n| what | wished for | found |\n|---|---|---|")
    async for figure in figures(seconds):
        print(f"| {figure.what} | {figure.wished} | {figure.found} |", flush=True)


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=30.0, help="each of what takes time (default: %(default)g)")
    asyncio.run(_print(parser.parse_args().seconds))
    return 0


if __name__ == "__main__":
    sys.exit(main())
