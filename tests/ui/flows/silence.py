"""What nothing is heard of: silent, stopped, killed, and back."""

import contextlib
import signal
from pathlib import Path

import pytest

from robotd.core.clock import now_ns
from robotd.core.pose import Odometry, Pose2, Twist2
from tests.support.console_page import until
from tests.support.real_gateway import GATEWAY, real_gateway
from tests.support.real_rig import program_of
from tests.ui.browser import chromium, new_page, open_page, until_so, wait_for
from tests.unit.gateway.rig import Opening, telling
from tests.unit.server.conftest import Serving, whole_map

pytestmark = [pytest.mark.real_clock, pytest.mark.shares_descriptors]


async def test_what_is_stale_looks_stale_and_recovers(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig)
        fan, accept = rig.house.services.fan, rig.house.services.fan.accept
        setattr(fan, "accept", lambda _: None)  # noqa: B010  # the daemon has fallen silent
        await wait_for(page, ".banner.warning", "the daemon is silent")
        assert "stale" in (await page.locator("main").get_attribute("class"))
        assert await page.get_by_role("button", name="Hold to arm").get_attribute("aria-disabled") == "true"
        assert await page.locator(".stop").get_attribute("aria-disabled") is None
        setattr(fan, "accept", accept)  # noqa: B010  # it is back
        await page.locator(".banner.warning").wait_for(state="detached", timeout=20_000)
        for connection in tuple(rig.house.connections):
            connection.finish("the proxy cuts")
        await until(lambda: rig.house.connections)  # it is back by itself
        await wait_for(page, ".age", "live")
        await page.locator(".banner.warning").wait_for(state="detached", timeout=20_000)


async def test_an_armed_base_without_odometry_is_named(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig)
        rig.control.armed = True
        rig.control.events.publish(Odometry(now_ns(), Pose2(0.0, 0.0, 0.0), Twist2(0.0, 0.0)))
        await wait_for(page, ".banner.warning", "the base is silent")


async def test_a_gateway_that_is_killed_and_one_that_takes_its_place(tmp_path: Path, serving: Serving) -> None:
    async with serving() as control, telling(control), chromium() as browser:
        page = await new_page(await browser.new_context())
        async with real_gateway(tmp_path, tmp_path) as gateway:
            await page.goto(f"{gateway.address}#{gateway.secret}")
            await wait_for(page, ".age", "live")
            gateway.process.send_signal(signal.SIGSTOP)
            await wait_for(page, ".banner.warning", "the gateway is silent")
            gateway.process.send_signal(signal.SIGKILL)
            await wait_for(page, ".banner.warning", "this page has lost the gateway")
            await page.keyboard.press("Escape")
            await wait_for(page, ".banner.danger", "STOP NOT CONFIRMED")
            await page.wait_for_timeout(3000)  # for so long it is said again, and a gateway that comes meanwhile obeys
        assert control.calls == []
        async with program_of(*GATEWAY, str(tmp_path / "robotd-gateway.toml")):
            await wait_for(page, ".age", "live")
            await page.locator(".banner.warning").wait_for(state="detached", timeout=20_000)
            assert control.calls == [], "a stop of then is not said now"
            await page.keyboard.press("Escape")
            await wait_for(page, ".stop", "STOPPED in")


async def test_a_daemon_that_is_gone_and_another_one(tmp_path: Path, serving: Serving) -> None:
    async with chromium() as browser, contextlib.AsyncExitStack() as stack:
        page = await new_page(await browser.new_context())
        async with serving() as control, telling(control):
            control.map_in_use = whole_map(generation=0, map_id="office-3")
            gateway = await stack.enter_async_context(real_gateway(tmp_path, tmp_path))
            await page.goto(f"{gateway.address}#{gateway.secret}")
            await wait_for(page, ".age", "live")
            await until_so(page, "robotd.grid.placement !== null")
        await wait_for(page, ".banner.warning", "the daemon is silent")
        assert await page.evaluate("robotd.grid.placement") is not None, "it is grey, and there"
        async with serving() as control, telling(control):
            await wait_for(page, ".banner", "The daemon was started again")
            await wait_for(page, ".age", "live")
            await until_so(page, "robotd.grid.placement === null")
            await page.get_by_role("button", name="Understood").click()
            await page.locator(".banner").wait_for(state="detached")
