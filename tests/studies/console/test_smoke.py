"""A few browsers of what ``make load`` sends, and a page that is cut off as in ``make safety ONLY=gateway``."""

import asyncio

import pytest

from tests.studies.console.crowd import crowd
from tests.support.console_page import PATIENCE_S, page_of, until
from tests.support.real_gateway import Relay
from tests.unit.gateway.rig import Opening

pytestmark = pytest.mark.real_clock


async def test_those_that_read_do_not_notice_who_stalls_and_who_is_hostile(opening: Opening) -> None:
    async with opening() as rig:
        seen = await crowd(rig.address, rig.secrets["viewer"], pages=6, stalled=2, hostile=1, seconds=1.0)
        assert seen.hung_up == 0
        assert seen.received_bytes > 0
        await until(lambda: not rig.house.connections)


async def test_a_page_that_is_cut_off_ends_its_mission(opening: Opening) -> None:
    async with opening(patience_s=0.5) as rig:
        relay = Relay(rig.address.port or 0)
        async with relay.serving() as address, rig.browser(address=address) as session, page_of(session) as page:
            await page.ask("command", cmd="arm")
            rig.control.release.clear()
            await page.ask("mission", cmd="localize")
            relay.cut()
            await asyncio.wait_for(rig.control.halted.wait(), PATIENCE_S)
            relay.hang_up()
        assert "the page of some operator, who drove, has not answered for" in rig.control.calls[-1]
