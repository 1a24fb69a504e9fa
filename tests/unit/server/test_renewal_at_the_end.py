"""A renewal that arrives between a mission's last step and the word of it is answered with the end."""

import asyncio
from typing import Any, cast

import pytest

from robotd.contract.answers import Renewed
from robotd.contract.events import Event, MissionPhase, MissionProgress
from robotd.contract.requests import Renew
from robotd.core.broadcast import Broadcast
from robotd.core.errors import MissionError
from robotd.server.handlers import Handlers
from robotd.server.outcomes import Outcomes

END = MissionProgress(7, 4, "localize", MissionPhase.DONE, 1, 1, "localized")


class JustEnded:
    """No mission is under way any more; that it ended is told a few turns later, if at all."""

    def __init__(self, events: Broadcast[Event], *, tells: bool) -> None:
        self.events = events
        self._tells = tells

    async def perform(self, request: object) -> object:
        if self._tells:
            asyncio.get_running_loop().call_soon(self.events.publish, END)
        raise MissionError("mission 4 is not under way any more")


@pytest.mark.parametrize("tells", [True, False])
async def test_the_end_is_told_in_place_of_a_refusal(tells: bool) -> None:
    events: Broadcast[Event] = Broadcast()
    outcomes = Outcomes()
    follower = asyncio.create_task(outcomes.follow(events))
    await asyncio.sleep(0)
    handlers = Handlers(cast("Any", JustEnded(events, tells=tells)), outcomes, session="s", lease_s=0.5)
    try:
        if tells:
            assert await handlers.carry_out(Renew(4)) == Renewed(END)
        else:
            with pytest.raises(MissionError, match="not under way"):
                await handlers.carry_out(Renew(4))
    finally:
        follower.cancel()
        await asyncio.gather(follower, return_exceptions=True)
