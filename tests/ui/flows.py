"""The console in a real browser: what a person does, and what becomes of it. Run by ``make ui-test``."""

import asyncio
import json
from pathlib import Path
from typing import Any

import pytest

from robotd.contract.estimate import PoseState
from robotd.contract.missions import DriveTo
from robotd.core.clock import now_ns
from robotd.core.errors import ServerError
from robotd.core.pose import Odometry, Pose2, Twist2
from tests.support.console_page import until
from tests.ui.browser import DESK, NARROW, PHONE, axe_source, chromium, hold, open_page
from tests.unit.gateway.rig import Opening
from tests.unit.gateway.test_maps import PGM, YAML
from tests.unit.server.conftest import an_estimate, whole_map

pytestmark = [pytest.mark.real_clock, pytest.mark.shares_descriptors]
PAGES = ("drive", "maps", "recordings", "health", "log", "settings")
THEMES = ("dark", "light", "contrast")


async def text_of(page: Any, selector: str) -> str:
    found: str = await page.locator(selector).inner_text()
    return found


async def wait_for(page: Any, selector: str, text: str) -> None:
    await page.locator(selector).filter(has_text=text).first.wait_for(timeout=20_000)


async def test_sign_in_by_address_by_hand_and_not_by_a_wrong_token(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig)
        assert rig.secrets["operator"] not in page.url, "the token is no longer in the address"
        assert await text_of(page, ".robot") == "dusty"
        await wait_for(page, ".where", "no map")
        await wait_for(page, ".age", "live")
        other = await (await browser.new_context()).new_page()
        await other.goto(str(rig.address))
        await other.get_by_label("Token").fill("x" * 43)
        await other.get_by_role("button", name="Sign in").click()
        await wait_for(other, ".notice", "no such token")
        await other.get_by_label("Token").fill(rig.secrets["viewer"])
        await other.get_by_role("button", name="Sign in").click()
        await wait_for(other, ".mode", "disarmed")
        assert page.complaints == []


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
            await page.evaluate(f"location.hash = '#/{name}'")
            await page.locator(f".page-{name}").wait_for()
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
        await wait_for(page, ".age", "live")
        assert await page.locator(".banner.warning").count() == 0, "it is back before anybody has to be told"


async def test_a_viewer_may_look_and_is_told_why_not_more(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig, "viewer")
        await wait_for(page, "#arm-why", "You may look and stop. An operator may do more.")
        assert await page.locator(".acts").count() == 0


@pytest.mark.parametrize("size", [PHONE, NARROW])
async def test_on_a_phone_stop_is_a_bar_and_nothing_is_cut_off(opening: Opening, size: tuple[int, int]) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig, "admin", size, has_touch=True)
        for name in PAGES:
            await page.evaluate(f"location.hash = '#/{name}'")
            await page.locator(f".page-{name}").wait_for()
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
                await page.evaluate(f"location.hash = '#/{name}'")
                await page.locator(f".page-{name}").wait_for()
                await page.wait_for_timeout(500)
                await page.evaluate(f"{source}; 0")
                told = await page.evaluate("axe.run(document, {resultTypes: ['violations']})")
                for violation in told["violations"]:
                    places = [node["target"] for node in violation["nodes"]][:3]
                    found[f"{theme} {name} {violation['id']}"] = places
        assert page.complaints == []
    assert found == {}, json.dumps(found, indent=1)


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


async def _tell_odometry(control: Any) -> None:
    """Tell it as a base does, for an armed one that is silent lets nobody drive."""
    while True:
        control.events.publish(Odometry(now_ns(), Pose2(0.0, 0.0, 0.0), Twist2(0.0, 0.0)))
        await asyncio.sleep(0.2)


async def test_going_localizing_and_exploring_are_prepared_and_started_by_a_second_press(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        control = rig.control
        control.map_in_use = whole_map(generation=0, map_id="office-3")
        control.events.publish(control.map_in_use)
        control.events.publish(an_estimate(PoseState.LOCALIZED))
        page = await open_page(browser, rig)
        await wait_for(page, ".where", "localized")
        driving = asyncio.create_task(_tell_odometry(control))
        await hold(page, "Hold to arm", 1400)
        await until(lambda: control.armed)
        await wait_for(page, ".mode", "armed, idle")
        canvas = page.locator("canvas")

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
            await page.evaluate(f"location.hash = '#/{name}'")
            await page.locator(f".page-{name}").wait_for()
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


async def test_without_a_script_there_is_one_button(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig, "viewer")
        state = await page.context.storage_state()
        bare = await (await browser.new_context(java_script_enabled=False, storage_state=state)).new_page()
        await bare.goto(f"{rig.address}stop")
        await bare.get_by_role("button", name="STOP").click()
        await wait_for(bare, "[role=status]", "STOPPED in")
        assert rig.control.calls == ["stop: STOP by some viewer"]


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
    pictures = Path(__file__).parents[2] / "docs" / "pictures" / "console"
    assert {"drive-desk-dark.png", "drive-phone-dark.png"} <= {file.name for file in pictures.glob("*.png")}
