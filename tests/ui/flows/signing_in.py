"""Who comes in, from where, and what for."""

import asyncio

import pytest

from tests.ui.browser import chromium, open_page, text_of, wait_for
from tests.unit.gateway.rig import Opening

pytestmark = [pytest.mark.real_clock, pytest.mark.shares_descriptors]


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


async def test_a_viewer_may_look_and_is_told_why_not_more(opening: Opening) -> None:
    async with opening() as rig, chromium() as browser:
        page = await open_page(browser, rig, "viewer")
        await wait_for(page, "#arm-why", "You may look and stop. An operator may do more.")
        assert await page.locator(".acts").count() == 0


async def test_a_page_of_another_origin_or_name_gets_nothing(opening: Opening) -> None:
    async with opening() as rig, chromium("--host-resolver-rules=MAP evil.example 127.0.0.1") as browser:
        page = await open_page(browser, rig, "admin")
        strange = await page.context.new_page()  # of the same browser, which has the cookie
        answer = await strange.goto(f"http://evil.example:{rig.address.port}/")
        assert (answer.status, (await answer.json())["code"]) == (421, "wrong_host")
        elsewhere = await asyncio.start_server(_nobodys_page, "127.0.0.1", 0)
        async with elsewhere:
            await strange.goto(f"http://127.0.0.1:{elsewhere.sockets[0].getsockname()[1]}/")
            tried = await strange.evaluate(_FORGED, str(rig.address))
        assert tried == {"posted": "refused", "socket": "closed"}
        assert rig.control.calls == []


_FORGED = """async (address) => {
  const post = (mode) => fetch(address + 'api/command/arm', {method: 'POST', mode, credentials: 'include', body: '{}'});
  const posted = await post('cors').then((answer) => answer.status, () => 'refused');
  await post('no-cors').catch(() => {});  // which a form could do: nobody may read the answer, and nothing may happen
  const socket = await new Promise((done) => {
    const one = new WebSocket(address.replace('http', 'ws') + 'api/ws', 'robotd.console.v1');
    one.onopen = () => done('open');
    one.onclose = () => done('closed');
  });
  return {posted, socket};
}"""


async def _nobodys_page(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    await reader.readuntil(b"\r\n\r\n")
    writer.write(b"HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nContent-Length: 2\r\nConnection: close\r\n\r\nhi")
    await writer.drain()
    writer.close()
