"""A browser's connection: its outbox, its page's life, and what it says, carried out side by side."""

import asyncio
import contextlib
import secrets
from collections.abc import Coroutine
from dataclasses import dataclass
from typing import Any

from robotd.contract.missions import MissionRequest
from robotd.contract.plain import to_plain
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import RobotdError, ServerError
from robotd.gateway.access.roles import Role
from robotd.gateway.access.visitor_limits import Rate
from robotd.gateway.browser import console_protocol as protocol
from robotd.gateway.browser.asked_by_page import request_of
from robotd.gateway.browser.liveness import Liveness
from robotd.gateway.browser.services import Services
from robotd.gateway.command.arbiter import Driver
from robotd.gateway.feed.heard_frames import HeardFrame
from robotd.gateway.feed.page_outbox import Full, PageOutbox

_AT_ONCE = 8
"""Requests of one browser under way at a time; stops are not counted."""


@dataclass(frozen=True, slots=True)
class Person:
    """Who looks, and what they may."""

    name: str
    role: Role
    whence: str
    session: str


class PageConnection:
    """One page of one browser."""

    def __init__(self, person: Person, services: Services) -> None:
        self.person = person
        self.driver = Driver(secrets.token_hex(8), person.name)
        self.liveness = Liveness(_now_s())
        self.outbox = PageOutbox(lambda: services.fan.snapshot.map.frames)
        self.woken = asyncio.Event()
        """Set when something waits in the outbox."""
        self.ended: str | None = None
        """Why this connection has to end; None while it need not."""
        self._services = services
        self._rate = Rate(protocol.TEXTS_PER_S, _now_s())
        self._tasks: set[asyncio.Task[None]] = set()
        self._under_way = 0

    def hear(self, heard: HeardFrame) -> None:
        """Let a message of the daemon wait to be sent."""
        self._wait_with(lambda: self.outbox.put(heard))

    def lost(self, topic: str, count: int) -> None:
        """Let the page know of messages that did not even reach the gateway."""
        self._wait_with(lambda: self.outbox.note_lost(topic, count))

    def say(self, text: str) -> None:
        """Let a text wait to be sent."""
        self._wait_with(lambda: self.outbox.say(text))

    def ask(self) -> None:
        """Ask the page whether it lives."""
        silent_s = self._services.fan.snapshot.silent_s(now_ns())
        text = protocol.question(self.liveness.ask(), silent_s, now_ns())
        self._wait_with(lambda: self.outbox.ask(text))

    def silent_s(self) -> float:
        """Return for how long the page has answered nothing."""
        return self.liveness.silent_s(_now_s())

    def take(self, text: str) -> None:
        """Take what the page says; must not wait.

        Raises:
            ServerError: it says too much; the connection ends.
        """
        try:
            said = protocol.said(text)
        except ServerError as error:
            self._count()
            self.say(protocol.problem(None, error))
            return
        if isinstance(said, protocol.StopNow):
            # Not counted against the page: no limit stands before a stop.
            self._begin(self._stop(said))
            return
        self._count()
        match said:
            case protocol.Answer():
                self.liveness.answer(said.n, _now_s())
            case protocol.ShowLayers():
                self._services.fan.show_rank(self, show=said.rank)
            case protocol.Command():
                self._begin(self._answered(said.id, self._command(said)))
            case protocol.StartMission():
                self._begin(self._answered(said.id, self._mission(said)))
            case protocol.TakeOver() | protocol.HandOver():
                self._begin(self._answered(said.id, self._pass_on(said)))

    async def end(self) -> None:
        """End what is under way: answers that nobody waits for. A stop goes on."""
        # Those of a stop are among them, and what they wait for is shielded: the line of STOP goes on.
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    def finish(self, why: str) -> None:
        """Let the connection end as soon as it can."""
        self.ended = self.ended or why
        self.woken.set()

    def _wait_with(self, put: Any) -> None:
        try:
            put()
        except Full:
            self.finish("it reads too slowly")
        self.woken.set()

    def _count(self) -> None:
        if not self._rate.take(_now_s()):
            raise ServerError("too_many", f"more than {protocol.TEXTS_PER_S:g} messages a second")

    async def _stop(self, said: protocol.StopNow) -> None:
        try:
            took_s = await self._services.stop(self.person.name, self.person.whence)
        except ServerError as error:
            self.say(protocol.problem(said.id, error))
        else:
            self.say(protocol.stopped(said.id, took_s))

    async def _answered(self, request_id: int, work: Coroutine[Any, Any, object]) -> None:
        if self._under_way >= _AT_ONCE:
            # Else Python complains of a coroutine that nobody ever awaited.
            work.close()
            self.say(
                protocol.problem(request_id, ServerError("busy", f"{_AT_ONCE} requests of this page are under way"))
            )
            return
        self._under_way += 1
        try:
            self.say(protocol.result(request_id, await work))
        except ServerError as error:
            self.say(protocol.problem(request_id, error))
        # The page waits for one answer to each request: without this one it would wait for ever.
        except RobotdError as error:
            self.say(protocol.problem(request_id, ServerError("internal", str(error))))
        finally:
            self._under_way -= 1

    async def _command(self, said: protocol.Command) -> object:
        with self._services.noted(self.person.name, self.person.whence, said.cmd):
            request = request_of(said.cmd, said.args, self.person.role)
            return await self._services.commands.carry_out(request, self.person.name)

    async def _mission(self, said: protocol.StartMission) -> object:
        with self._services.noted(self.person.name, self.person.whence, said.cmd):
            mission = request_of(said.cmd, said.args, self.person.role)
            if not isinstance(mission, MissionRequest):
                raise ServerError("refused", f"{said.cmd} is no mission")
            if not said.attended and not self._services.allows_unattended:
                raise ServerError(
                    "refused", "unattended missions are off: watching.unattended of the gateway allows them"
                )
            started = await self._services.missions.start(self.driver, mission, attended=said.attended)
            return to_plain(started)

    async def _pass_on(self, said: protocol.TakeOver | protocol.HandOver) -> object:
        what = "take over" if isinstance(said, protocol.TakeOver) else "hand over" if said.give else "keep"
        with self._services.noted(self.person.name, self.person.whence, what):
            if not self.person.role.may(Role.OPERATOR):
                raise ServerError("not_allowed", f"to drive needs the role {Role.OPERATOR}")
            if isinstance(said, protocol.TakeOver):
                self._services.arbiter.ask_for(self.driver, _now_s())
            else:
                self._services.arbiter.give(self.driver.browser, give=said.give)
            self._services.tell_commander()
        return {}

    def _begin(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._ended)

    def _ended(self, task: asyncio.Task[None]) -> None:
        self._tasks.discard(task)
        with contextlib.suppress(asyncio.CancelledError):
            task.result()


def _now_s() -> float:
    return now_ns() / NS_PER_S
